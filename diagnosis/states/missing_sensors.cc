#include "diagnosis/states/missing_sensors.h"

#include <algorithm>
#include <cmath>

#include "estimation/decompositions.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Information of the parameters, initial states taken out, relative to their values; of white errors.
class RelativeInformation {
 public:
  explicit RelativeInformation(const StateFit& fit)
      : parameters_(fit.model->parameter_count()), size_(fit.parameters.cwiseAbs().cwiseMax(1e-300)) {
    sum_ = Eigen::MatrixXd::Zero(parameters_, parameters_);
  }
  /// Rows over their noise, parameters first.
  void Add(const Eigen::MatrixXd& rows) {
    const Eigen::MatrixXd products = rows.transpose() * rows;
    const Eigen::Index free = products.cols() - parameters_;
    Eigen::MatrixXd own = products.topLeftCorner(parameters_, parameters_);
    if (free > 0) {
      const Eigen::MatrixXd cross = products.topRightCorner(parameters_, free);
      own -= cross * PseudoInverse(products.bottomRightCorner(free, free)) * cross.transpose();
    }
    sum_ += size_.asDiagonal() * own * size_.asDiagonal();
  }
  Eigen::VectorXd Deviations() const {
    constexpr double kRounding = 1e-13;
    const Eigen::MatrixXd floor =
        kRounding * sum_.diagonal().maxCoeff() * Eigen::MatrixXd::Identity(parameters_, parameters_);
    return Inverse(sum_ + floor).diagonal().cwiseMax(0).cwiseSqrt();
  }
  /// Where all other parameters are known.
  Eigen::VectorXd AloneDeviations() const {
    return sum_.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  }

 private:
  int parameters_;
  Eigen::VectorXd size_;
  Eigen::MatrixXd sum_;
};

/// The machine with one more output of its kind measured.
Machine WithSensor(Machine machine, const std::string& signal) {
  SignalSpec spec;
  spec.name = spec.column = signal;
  for (const MachineInput& input : KindOf(machine).signals)
    if (input.name == signal) spec.unit = input.si;
  machine.signals.push_back(spec);
  machine.states.outputs = BuiltInStates(machine).outputs;
  return machine;
}

/// Sensitivities of the outputs at their readings, over their noise; of those that are not measured (an index above those of
/// the fit's episode) over `noise` of their variation.
Eigen::MatrixXd Sensitivities(const StateFit& fit, const std::shared_ptr<const StateModel>& model,
                              const Episode& episode, const Eigen::VectorXd& initial, double noise) {
  const int states = model->states(), outputs = model->output.rows, parameters = model->parameter_count();
  StateSimulator simulator(model);
  simulator.SetParameters(fit.parameters);
  std::vector<int> free;
  for (int i = 0; i < states; ++i)
    if (model->estimated[static_cast<std::size_t>(i)]) free.push_back(i);
  RowMatrix by_parameter;
  simulator.Initial(episode, initial, &by_parameter);
  RowMatrix start = RowMatrix::Zero(states, parameters + static_cast<int>(free.size()));
  start.leftCols(parameters) = by_parameter;
  for (std::size_t k = 0; k < free.size(); ++k)
    start(free[k], parameters + static_cast<int>(k)) = std::max(std::abs(initial[free[k]]), 1e-12);
  StateRun run;
  simulator.Run(episode, 0, episode.rows() - 1, initial, &start, run);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(run.slopes.rows(), run.slopes.cols());
  if (run.diverged) return rows;
  for (int j = 0, known = 0; j < outputs; ++j) {
    const int signal = model->outputs[static_cast<std::size_t>(j)];
    const bool measured = signal < episode.signal.cols();
    const auto column = run.outputs.col(j);
    const Eigen::VectorXd finite = column.array().isFinite().select(column, 0.0);
    const double count = static_cast<double>(column.array().isFinite().count()),
                 mean = finite.sum() / std::max(count, 1.0);
    const double variation =
        std::sqrt(std::max(finite.squaredNorm() / std::max(count, 1.0) - mean * mean, 1e-300));
    // A mean over some rows has less of the noise of each.
    const double of_mean = noise * variation / std::sqrt(static_cast<double>(episode.mean_rows));
    const double over = 1 / (measured ? fit.noise[known] : of_mean);
    known += measured;
    for (int row = 0; row < episode.rows(); ++row) {
      const bool reading = row % episode.mean_rows == 0 && std::isfinite(run.outputs(row, j)) &&
                           (!measured || std::isfinite(episode.signal(row, signal)));
      if (reading) rows.row(row * outputs + j) = over * run.slopes.row(row * outputs + j);
    }
  }
  return rows;
}

RelativeInformation InformationOf(const StateFit& fit, const std::shared_ptr<const StateModel>& model,
                                  std::span<const Episode> episodes, double noise) {
  RelativeInformation information(fit);
  for (std::size_t e = 0; e < episodes.size(); ++e)
    information.Add(Sensitivities(fit, model, episodes[e], fit.initial[e], noise));
  return information;
}

}  // namespace

ToldTogether FindToldTogether(const StateFit& fit, std::span<const Episode> episodes,
                              const MissingSensorOptions& options) {
  ToldTogether out;
  const Machine& machine = fit.model->machine;
  const MachineKind& kind = KindOf(machine);
  if (kind.states == nullptr || fit.parameters.size() == 0) return out;
  const RelativeInformation now = InformationOf(fit, fit.model, episodes, options.noise);
  const Eigen::VectorXd white = now.Deviations(), alone = now.AloneDeviations();
  std::vector<Eigen::Index> loose;
  for (Eigen::Index p = 0; p < fit.parameters.size(); ++p) {
    const double std =
        std::sqrt(std::max(fit.covariance(p, p), 0.0)) / std::max(std::abs(fit.parameters[p]), 1e-300);
    if (std < options.loose || white[p] < options.together * alone[p]) continue;
    loose.push_back(p);
    out.parameters.push_back(fit.model->parameters[static_cast<std::size_t>(p)].name);
    out.std.push_back(std);
  }
  if (loose.size() < 2) return {};
  for (const OutputSpec& output : kind.states(machine).outputs) {
    if (machine.SignalIndex(output.signal) >= 0) continue;
    const auto model = BuildStateModel(WithSensor(machine, output.signal), fit.model->effects);
    if (!model) continue;
    const Eigen::VectorXd with = InformationOf(fit, *model, episodes, options.noise).Deviations();
    MissingSensor sensor{output.signal, {}};
    // Errors are correlated as they were: what they are beyond white ones stays.
    for (std::size_t k = 0; k < loose.size(); ++k)
      sensor.std.push_back(out.std[k] * with[loose[k]] / white[loose[k]]);
    bool helps = false;
    for (std::size_t k = 0; k < loose.size(); ++k)
      helps = helps || sensor.std[k] * options.helps < out.std[k];
    if (helps) out.sensors.push_back(std::move(sensor));
  }
  if (out.sensors.empty()) return {};
  const auto largest = [](const MissingSensor& s) { return *std::max_element(s.std.begin(), s.std.end()); };
  std::sort(out.sensors.begin(), out.sensors.end(),
            [&](const auto& a, const auto& b) { return largest(a) < largest(b); });
  return out;
}

}  // namespace hydroscope
