#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include "acquisition/quality_monitor.h"
#include "core/constants.h"
#include "estimation/decompositions.h"
#include "estimation/recursive/information_filter.h"
#include "estimation/recursive/recursive_least_squares.h"
#include "host/output.h"
#include "simulator/random.h"
#include "studies/benchmarks.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

using Rls = RecursiveLeastSquares;

constexpr double kLambda = 0.999, kMaxCovariance = 1e6, kSigmas = 5;
/// Variance at which a direction rests that is excited alone by u = (1, 1, -1, 0.5): (1 - lambda) / u'u.
constexpr double kAloneVariance = (1 - kLambda) / 3.25;
constexpr double kBlock = 0.02;  ///< s per equation
constexpr std::size_t kRows = 5000;
const Eigen::Vector4d kTruth(-2, 0.5, 1, 3);

/// The equation-by-equation form under test.
class FactoredForm {
 public:
  explicit FactoredForm(Forgetting form) : rls_(std::vector<double>(4, 1.0), Options(form)) {}
  void Learn(const Eigen::Vector4d& u, double y) { rls_.Update(std::span<const double>(u.data(), 4), y); }
  Eigen::VectorXd Theta() const { return rls_.theta(); }
  Eigen::MatrixXd Covariance() const { return rls_.Covariance(); }

 private:
  static Rls::Options Options(Forgetting form) {
    Rls::Options options;
    options.forgetting = form;
    options.forgetting_factor = form == Forgetting::kNone ? 1.0 : kLambda;
    options.max_covariance = kMaxCovariance;
    return options;
  }
  Rls rls_;
};

/// The default form under test: equations are gathered, and a batch of them forgets what it excites.
class InformationForm {
 public:
  explicit InformationForm(Forgetting form)
      : form_(form), filter_(InformationFilter::Vector::Ones(4), 500, kMaxCovariance) {}
  void Learn(const Eigen::Vector4d& u, double y) {
    gram_ += u * u.transpose();
    cross_ += y * u;
    if (++count_ < kBatch) return;
    if (form_ != Forgetting::kNone) filter_.Forget(Excited(), std::pow(kLambda, count_));
    filter_.Add(gram_, cross_, 0.0);
    gram_.setZero();
    cross_.setZero();
    count_ = 0;
  }
  Eigen::VectorXd Theta() const { return filter_.Theta(); }
  Eigen::MatrixXd Covariance() const { return filter_.Covariance(); }

 private:
  static constexpr int kBatch = 100;  ///< equations, as many as a stroke of 2 s has

  InformationFilter::Matrix Excited() const {
    if (form_ == Forgetting::kExponential) return InformationFilter::Matrix::Identity(4, 4);
    const SymmetricEigen eigen = EigenOf(gram_);
    const auto resting = (eigen.values.array() < 1e-9 * count_).count();
    return eigen.vectors.rightCols(4 - resting);
  }

  Forgetting form_;
  InformationFilter filter_;
  Eigen::Matrix4d gram_ = Eigen::Matrix4d::Zero();
  Eigen::Vector4d cross_ = Eigen::Vector4d::Zero();
  int count_ = 0;
};

/// A form with its source of equations.
template <typename Form>
class LongRun {
 public:
  LongRun(Forgetting forgetting, std::uint64_t seed) : form_(forgetting), random_(seed) {}

  void Excite(std::int64_t updates) {
    for (std::int64_t k = 0; k < updates; ++k) {
      const double common = random_.Normal();
      Learn({random_.Normal() + common, random_.Normal() + common, random_.Normal(), common});
    }
  }
  void StandStill(std::int64_t updates) {
    for (std::int64_t k = 0; k < updates; ++k) Learn(Eigen::Vector4d::Zero());
    for (std::int64_t k = 0; k < updates; ++k) Learn({1, 1, -1, 0.5});
  }
  /// Largest error in standard deviations; infinite if anything is not sound.
  double Error() const {
    const Eigen::VectorXd theta = form_.Theta();
    const Eigen::MatrixXd p = form_.Covariance();
    const bool sound = p.allFinite() && theta.allFinite() && (p - p.transpose()).norm() == 0 &&
                       p.diagonal().maxCoeff() <= 1.01 * kMaxCovariance &&
                       SymmetricFactor(p).LeastPivot() > 0;
    if (!sound) return std::numeric_limits<double>::infinity();
    return ((theta - kTruth).array().abs() / p.diagonal().array().sqrt()).maxCoeff();
  }
  double largest_variance() const { return form_.Covariance().diagonal().maxCoeff(); }

 private:
  void Learn(const Eigen::Vector4d& u) { form_.Learn(u, u.dot(kTruth) + random_.Normal()); }

  Form form_;
  RandomStream random_;
};

template <typename Form>
bool RunForm(const char* name, Forgetting form, const EnduranceOptions& o) {
  const auto start = std::chrono::steady_clock::now();
  LongRun<Form> run(form, o.seed);
  run.Excite(o.updates / 2);
  const double before = run.Error(), variance_before = run.largest_variance();
  const auto standstill = static_cast<std::int64_t>(o.standstill_hours * 3600 / kBlock);
  run.StandStill(standstill);
  const double still = run.Error(), variance_still = run.largest_variance();
  run.Excite(o.updates - o.updates / 2);
  const double after = run.Error();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const bool held = before < kSigmas && still < kSigmas && after < kSigmas &&
                    (form == Forgetting::kExponential || variance_still <= variance_before + kAloneVariance);
  fmt::print("{:<24} {:>9.2f} {:>9.2f} {:>9.2f} {:>12.3g} {:>12.3g} {:>8.0f} ns  {}\n", name, before, still,
             after, variance_before, variance_still,
             1e9 * seconds / static_cast<double>(o.updates + 2 * standstill), held ? "sound" : "FAILED");
  return held;
}

/// The machine at rest: cushion up, valve at its null, sensor noise as on the rig.
class Standstill {
 public:
  Standstill(const PressOptions& press, const Machine& machine) : press_(press), random_(press.seed) {
    rows_.Resize(machine.signals.size(), kRows);
  }
  /// The next rows from time `begin` on.
  SampleBlock& Rows(double begin) {
    const SensorNoise& n = press_.noise;
    const std::array<double, 7> mean = {
        25e5, press_.machine.p_rod, press_.machine.p_supply, press_.motion.z_top, press_.machine.y_0,
        0.08, press_.oil_start};
    const std::array<double, 7> std = {n.p_A, n.p_B, n.p_0, n.z, n.y_v, 0.001, n.T_oil};
    rows_.Resize(rows_.signal.size(), kRows);
    for (std::size_t r = 0; r < kRows; ++r)
      rows_.time[r] = begin + press_.sample_period * static_cast<double>(r);
    for (std::size_t s = 0; s < rows_.signal.size(); ++s) {
      for (double& x : rows_.signal[s]) x = mean[s] + std[s] * random_.Normal();
      for (Quality& q : rows_.quality[s]) q = quality::kGood;
    }
    return rows_;
  }

 private:
  const PressOptions& press_;
  RandomStream random_;
  SampleBlock rows_;
};

void Feed(SampleBlock& rows, QualityMonitor& monitor, Pipeline& pipeline) {
  monitor.Inspect(rows);
  pipeline.Process(rows);
}

/// Log, standstill, log through one pipeline.
bool RunPipeline(const EnduranceOptions& o) {
  PressOptions press;
  press.seconds = 60;
  press.seed = o.seed;
  const Machine machine = MachineFor(press);
  std::vector<StrokeRecord> strokes;
  auto pipeline = Pipeline::Create(machine, press.sample_period,
                                   [&](StrokeRecord&& record) { strokes.push_back(std::move(record)); });
  if (!pipeline) {
    ReportError(pipeline.error());
    return false;
  }
  QualityMonitor monitor(machine, press.sample_period);
  SampleBlock rows = RowsOf(SimulatePress(press), machine);
  Feed(rows, monitor, **pipeline);
  Standstill standstill(press, machine);
  double time = press.seconds;
  const double block_time = kRows * press.sample_period;
  Feed(standstill.Rows(time), monitor, **pipeline);  // ends the stroke under way
  const std::size_t strokes_before = strokes.size();
  const auto state = (*pipeline)->SaveState();
  const auto start = std::chrono::steady_clock::now();
  const auto blocks = static_cast<std::int64_t>(o.standstill_hours * 3600 / block_time);
  ProgressBar progress("standstill", "rows");
  for (std::int64_t b = 0; b < blocks; ++b) {
    time += block_time;
    Feed(standstill.Rows(time), monitor, **pipeline);
    progress.Update((b + 1.0) / static_cast<double>(blocks), (b + 1) * static_cast<std::int64_t>(kRows));
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const bool unchanged = (*pipeline)->SaveState() == state && strokes.size() == strokes_before;
  const double last_excited = strokes.back().estimates.front().last_excited;
  press.seed = o.seed + 1;
  rows = RowsOf(SimulatePress(press), machine);
  for (double& t : rows.time) t += time + block_time;
  Feed(rows, monitor, **pipeline);
  monitor.Flush(rows);
  (*pipeline)->Process(rows);
  (*pipeline)->Finish();
  fmt::print("\npipeline: {} strokes, {:.3g} h standstill ({} rows, {:.2f} million/s), then {} strokes\n",
             strokes_before, o.standstill_hours, blocks * static_cast<std::int64_t>(kRows),
             static_cast<double>(blocks * static_cast<std::int64_t>(kRows)) / seconds / 1e6,
             strokes.size() - strokes_before);
  fmt::print("state after the standstill {}; K' was last excited at {:.0f} s, and at {:.0f} s in the end\n",
             unchanged ? "unchanged bit for bit" : "CHANGED", last_excited,
             strokes.back().estimates.front().last_excited);
  bool right = true;
  const std::array<double, 4> truth = {press.machine.K, press.machine.V0, press.machine.Q_vn,
                                       press.machine.y_0};
  for (int i = 0; i < 4; ++i) {
    const Estimate& e = strokes.back().estimates[i];
    const double z = (e.value - truth[i]) / e.std;
    right = right && std::abs(z) < 3;
    fmt::print("  {:<5} {:.5g} ± {:.2g} {}, truth {:.5g}, {:+.1f} standard deviations\n", e.parameter,
               e.value, kNormal95 * e.std, e.unit, truth[i], z);
  }
  return unchanged && right && strokes.size() > strokes_before;
}

}  // namespace

int RunEndurance(const EnduranceOptions& o) {
  fmt::print(
      "recursive least squares, lambda {}: {:.1e} updates, in the middle {:.3g} h of zero and as much of "
      "constant regressors\n\n{:<24} {:>9} {:>9} {:>9} {:>12} {:>12} {:>11}\n",
      kLambda, static_cast<double>(o.updates), o.standstill_hours, "error / std", "before", "still", "after",
      "P before", "P still", "per update");
  bool held = RunForm<FactoredForm>("factored, none", Forgetting::kNone, o);
  held = RunForm<FactoredForm>("factored, exponential", Forgetting::kExponential, o) && held;
  held = RunForm<FactoredForm>("factored, directional", Forgetting::kDirectional, o) && held;
  held = RunForm<InformationForm>("information, none", Forgetting::kNone, o) && held;
  held = RunForm<InformationForm>("information, exponential", Forgetting::kExponential, o) && held;
  held = RunForm<InformationForm>("information, directional", Forgetting::kDirectional, o) && held;
  held = RunPipeline(o) && held;
  std::cout << (held ? "reached" : "NOT reached")
            << ": errors within 5 (pipeline: 3) standard deviations, nothing drifts\n";
  return held ? 0 : 1;
}

}  // namespace hydroscope
