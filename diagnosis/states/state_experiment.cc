#include "diagnosis/states/state_experiment.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/contains.h"
#include "diagnosis/experiment/rival_separation.h"
#include "diagnosis/states/tangent.h"
#include "estimation/column_products.h"
#include "estimation/decompositions.h"
#include "estimation/states/unseen_ripple.h"

namespace hydroscope {
namespace {

/// A model in question.
struct Rival {
  const StateCandidate* candidate = nullptr;
  StateFit at;  ///< parameters, noise and the initial states of a new record alone

  const StateFit& fit() const { return candidate->fit; }
};

class ExperimentSearch {
 public:
  ExperimentSearch(const StatesExplanation& x, std::span<const Episode> episodes,
                   const StateExperimentOptions& options)
      : fitted_(x.runs.empty() ? episodes : std::span<const Episode>(x.runs)),
        recorded_(episodes.front()),
        options_(options) {
    std::vector<const StateCandidate*> candidates = {&x.final};
    if (x.verdict == Verdict::kAmbiguous)
      for (const StateCandidate& rival : x.rivals) candidates.push_back(&rival);
    candidates.resize(std::min(candidates.size(), static_cast<std::size_t>(options.most_rivals)));
    // Weights that make a reading count as often as it is independent.
    const double evidence = std::sqrt(std::max(EvidenceOf(x.final), 1e-300));
    for (const StateCandidate* candidate : candidates) {
      Rival rival{candidate, {}};
      rival.at.model = candidate->fit.model;
      rival.at.parameters = candidate->fit.parameters;
      rival.at.at_limit = candidate->fit.at_limit;
      rival.at.noise = x.base.fit.noise * evidence;
      rival.at.initial = {candidate->fit.initial.front()};
      rivals_.push_back(std::move(rival));
    }
    if (rivals_.size() > 1)
      for (const Rival& rival : rivals_) out_.rivals.push_back(rival.candidate->added);
    std::set<std::string> unseen;
    for (const UnseenDirection& direction : x.final.fit.unseen)
      if (!OnlyRippleShows(*x.final.fit.model, direction))
        for (const auto& [name, share] : direction.parts) unseen.insert(name);
    if (rivals_.size() == 1) out_.unseen.assign(unseen.begin(), unseen.end());
  }

  StateExperiment Run() {
    if (rivals_.size() < 2 && out_.unseen.empty()) return out_;
    TakeRecorded();
    Judge(known_, out_.now);
    const StateModel& model = *rivals_.front().fit().model;
    for (const RecordMove& move : RecordMoves(model, recorded_)) Try(move);
    Sort();
    const std::size_t best = std::min(out_.tried.size(), static_cast<std::size_t>(options_.sped_up));
    std::vector<RecordMove> again;
    for (std::size_t k = 0; k < best; ++k)
      if (!out_.tried[k].move.course) again.push_back(out_.tried[k].move);
    for (RecordMove& move : again)
      for (const double speed : RecordSpeeds()) {
        move.speed = speed;
        Try(move);
      }
    Sort();
    LeaveRefuted();
    return std::move(out_);
  }

 private:
  /// Of each rival: its parameters, and the others less it.
  Eigen::MatrixXd ProductsOf(std::size_t rival, const StateFit& fit, const Episode& episode,
                             std::size_t index, const std::vector<const RowMatrix*>& outputs) const {
    std::vector<RowMatrix> differences;
    for (std::size_t other = 0; other < outputs.size(); ++other)
      if (other != rival) differences.push_back(*outputs[other] - *outputs[rival]);
    std::vector<const RowMatrix*> errors;
    for (const RowMatrix& difference : differences) errors.push_back(&difference);
    return ColumnProducts(TangentColumns(fit, episode, index, {}, errors));
  }

  void TakeRecorded() {
    known_.clear();
    for (std::size_t r = 0; r < rivals_.size(); ++r) {
      StateFit fit = rivals_[r].at;
      fit.initial = rivals_[r].fit().initial;
      Eigen::MatrixXd sum;
      for (std::size_t e = 0; e < fitted_.size(); ++e) {
        std::vector<const RowMatrix*> outputs;
        for (const Rival& rival : rivals_) outputs.push_back(&rival.fit().runs[e].outputs);
        const Eigen::MatrixXd products = ProductsOf(r, fit, fitted_[e], e, outputs);
        sum = e == 0 ? products : Eigen::MatrixXd(sum + products);
      }
      known_.push_back(std::move(sum));
    }
  }

  void Try(const RecordMove& move) {
    TriedRecord tried;
    tried.move = move;
    const StateModel& model = *rivals_.front().fit().model;
    tried.record = MovedRecord(move, model, recorded_, options_.most_rows);
    if (tried.record.rows() < 2 || !KeepsSpeeds(model, tried.record)) return;
    tried.seconds = tried.record.time.back() - tried.record.time.front();
    std::vector<StateRun> runs(rivals_.size());
    std::vector<const RowMatrix*> outputs;
    for (std::size_t r = 0; r < rivals_.size(); ++r) {
      StateSimulator simulator(rivals_[r].at.model);
      simulator.SetParameters(rivals_[r].at.parameters);
      simulator.Run(tried.record, 0, tried.record.rows() - 1,
                    simulator.Initial(tried.record, rivals_[r].at.initial.front()), nullptr, runs[r]);
      if (runs[r].diverged || !runs[r].outputs.allFinite()) return;
      outputs.push_back(&runs[r].outputs);
    }
    std::vector<Eigen::MatrixXd> all;
    for (std::size_t r = 0; r < rivals_.size(); ++r) {
      all.push_back(known_[r] + ProductsOf(r, rivals_[r].at, tried.record, 0, outputs));
      if (!all.back().allFinite()) return;  // a root at zero, say
    }
    Judge(all, tried);
    out_.tried.push_back(std::move(tried));
  }

  /// Information on the parameters, with what their ranges say of them.
  static Eigen::MatrixXd Information(const StateFit& fit, const Eigen::MatrixXd& products) {
    const int count = fit.model->parameter_count();
    Eigen::MatrixXd information = products.topLeftCorner(count, count);
    for (int p = 0; p < count; ++p) {
      const ParameterSpec& spec = fit.model->parameters[static_cast<std::size_t>(p)].spec;
      const double range =
          std::isfinite(spec.max - spec.min) ? spec.max - spec.min : std::abs(fit.parameters[p]) + 1;
      information(p, p) += 1 / (range * range);
    }
    return information;
  }

  void Judge(const std::vector<Eigen::MatrixXd>& products, TriedRecord& tried) const {
    if (rivals_.size() < 2) {
      tried.standard_error = UnseenError(products.front());
      return;
    }
    tried.separation = INFINITY;
    for (std::size_t r = 0; r < rivals_.size(); ++r) {
      const int count = rivals_[r].at.model->parameter_count();
      const Eigen::MatrixXd information = Information(rivals_[r].at, products[r]);
      const Eigen::VectorXd size = information.diagonal().cwiseSqrt().cwiseInverse();
      const SymmetricFactor factor(size.asDiagonal() * information * size.asDiagonal());
      for (Eigen::Index c = count; c < products[r].cols(); ++c) {
        const Eigen::VectorXd gradient = size.cwiseProduct(products[r].col(c).head(count));
        tried.separation =
            std::min(tried.separation, products[r](c, c) - gradient.dot(factor.Solve(gradient)));
      }
    }
    tried.separation = std::max(tried.separation, 0.0);
  }

  /// Covariance of the parameters' relative changes.
  static Eigen::MatrixXd RelativeCovariance(const StateFit& fit, const Eigen::MatrixXd& products) {
    const Eigen::MatrixXd information = Information(fit, products);
    const Eigen::VectorXd size = information.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd inverse = SymmetricFactor(size.asDiagonal() * information * size.asDiagonal())
                                        .SolveColumns(Eigen::MatrixXd::Identity(size.size(), size.size()));
    const Eigen::VectorXd relative = size.cwiseQuotient(fit.parameters.cwiseAbs().cwiseMax(1e-300));
    return relative.asDiagonal() * inverse * relative.asDiagonal();
  }

  /// Parameter with the largest standard error of those not seen; below 0: there is none.
  int LeastSeen(const Eigen::MatrixXd& covariance) const {
    const StateModel& model = *rivals_.front().at.model;
    int worst = -1;
    for (int p = 0; p < model.parameter_count(); ++p)
      if (Contains(out_.unseen, model.parameters[static_cast<std::size_t>(p)].name) &&
          (worst < 0 || covariance(p, p) > covariance(worst, worst)))
        worst = p;
    return worst;
  }

  double UnseenError(const Eigen::MatrixXd& products) const {
    const Eigen::MatrixXd covariance = RelativeCovariance(rivals_.front().at, products);
    const int worst = LeastSeen(covariance);
    return worst < 0 ? 0 : std::sqrt(std::max(0.0, covariance(worst, worst)));
  }

  /// The best record is simulated with the parameters moved along what was recorded does not see: where the file leaves the scale
  /// of a state free, rounding of sensitivities passes for information on it. Records that this refutes say nothing more than
  /// what was recorded does.
  void LeaveRefuted() {
    if (rivals_.size() > 1) return;
    while (out_.proposed() && !ShowsWhatItPromises(out_.tried.front())) {
      out_.tried.front().standard_error = out_.now.standard_error;
      Sort();
    }
  }

  bool ShowsWhatItPromises(const TriedRecord& tried) const {
    const StateFit& fit = rivals_.front().at;
    const Eigen::MatrixXd covariance = RelativeCovariance(fit, known_.front());
    const int worst = LeastSeen(covariance);
    Eigen::VectorXd moved = fit.parameters;
    for (int p = 0; p < moved.size(); ++p)
      if (!fit.at_limit[static_cast<std::size_t>(p)])
        moved[p] *= std::exp(options_.moved * covariance(p, worst) / covariance(worst, worst));
    StateSimulator simulator(fit.model);
    simulator.SetParameters(fit.parameters);
    StateRun run;
    Episode record = tried.record;
    simulator.Run(record, 0, record.rows() - 1, simulator.Initial(record, fit.initial.front()), nullptr, run);
    for (int j = 0; j < fit.model->output.rows; ++j)
      record.signal.col(fit.model->outputs[static_cast<std::size_t>(j)]) = run.outputs.col(j);
    const StateFit followed = FollowStates(fit.model, std::span(&record, 1), moved, fit.noise);
    if (!followed.solved()) return true;  // nothing speaks against it
    double energy = 0;
    for (int j = 0; j < fit.model->output.rows; ++j)
      for (Eigen::Index row = 0; row < followed.residuals.front().rows(); ++row)
        if (const double error = followed.residuals.front()(row, j) / fit.noise[j]; std::isfinite(error))
          energy += error * error;
    const double promised = options_.moved / std::max(tried.standard_error, 1e-6);
    return energy > options_.least_promised * promised * promised;
  }

  void Sort() {
    std::stable_sort(out_.tried.begin(), out_.tried.end(), [&](const TriedRecord& a, const TriedRecord& b) {
      return rivals_.size() < 2 ? a.standard_error < b.standard_error : a.separation > b.separation;
    });
  }

  std::span<const Episode> fitted_;
  const Episode& recorded_;
  const StateExperimentOptions& options_;
  std::vector<Rival> rivals_;
  std::vector<Eigen::MatrixXd> known_;  ///< of each rival, from what was recorded
  StateExperiment out_;
};

}  // namespace

bool StateExperiment::proposed() const {
  if (tried.empty()) return false;
  if (!rivals.empty()) return tried.front().separation >= kExperiment.worthwhile;
  return tried.front().standard_error < StateExperimentOptions{}.seen &&
         2 * tried.front().standard_error < now.standard_error;
}

bool StateExperiment::settles() const {
  if (!proposed()) return false;
  return rivals.empty() ? tried.front().standard_error <= StateExperimentOptions{}.clearly_seen
                        : tried.front().separation >= kExperiment.settled;
}

StateExperiment ProposeStateExperiment(const StatesExplanation& explanation,
                                       std::span<const Episode> episodes,
                                       const StateExperimentOptions& options) {
  return ExperimentSearch(explanation, episodes, options).Run();
}

}  // namespace hydroscope
