#include "estimation/closed_loop/loop_episodes.h"

#include <algorithm>

#include "core/constants.h"
#include "estimation/closed_loop/causality.h"
#include "estimation/closed_loop/input_limit.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// s; lower frequencies than those of shorter segments carry the gain of a plant that integrates.
constexpr double kShortestSegmentFollowed = 0.5;
/// Poles and dampings lie no further than that beyond the starts that they are sought from.
constexpr double kReachBeyondStarts = 10;
/// Ratios beyond which slopes at the basis no longer lead on. They are proportional to the gain: at twice that of the basis every
/// step of a pole is twice too long and does not converge. Slopes by poles turn more slowly, and estimates of them scatter more.
constexpr double kFarGain = 1.25, kFarPole = 1.5;

std::vector<double> ColumnOf(const Episode& episode, int signal) {
  std::vector<double> values(static_cast<std::size_t>(episode.rows()));
  for (int row = 0; row < episode.rows(); ++row) values[row] = episode.signal(row, signal);
  return values;
}

bool Near(const LoopParameter& parameter, double basis, double at) {
  if (parameter.kind == LoopParameter::Kind::kDelay) return true;
  const double far = parameter.kind == LoopParameter::Kind::kGain ? kFarGain : kFarPole;
  const double ratio = at / basis;
  return ratio < far && ratio > 1 / far;
}

std::vector<double> Numbers(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

/// What is kept of an episode: its averaged spectra.
class LoopRecord : public ReadEpisode {
 public:
  LoopRecord(const TransferModel& model, const std::vector<double>& known, LoopSpectra spectra,
             std::vector<std::size_t> used)
      : model_(model), known_(known), spectra_(std::move(spectra)), used_(std::move(used)) {}

  std::optional<FirstFit> Fit() const override {
    const auto fit = FitTransfer(spectra_, used_, model_);
    if (!fit || !CheckCausality(*model_.plant, *fit, spectra_.sample_period)) return std::nullopt;
    const LoopEstimate meant = NearestWay(*model_.plant, *fit, known_);
    const auto count = static_cast<Eigen::Index>(meant.parameters.size());
    FirstFit first;
    first.parameters = Eigen::Map<const Eigen::VectorXd>(meant.parameters.data(), count);
    first.size = first.parameters.cwiseAbs();
    for (Eigen::Index p = 0; p < count; ++p)
      first.size[p] = std::max(first.size[p], model_.plant->parameters[p].scale);
    first.shown_noise = RemainderOfTransfer(spectra_, used_, model_, meant.parameters);
    first.basis = first.parameters;
    for (Eigen::Index p = 0; p < count; ++p) {
      const auto at = static_cast<std::size_t>(p);
      if (model_.plant->parameters[at].kind == LoopParameter::Kind::kPositive && known_[at] > 0)
        first.basis[p] = known_[at];
    }
    if (!(first.size.minCoeff() > 0) || !(first.shown_noise > 0)) return std::nullopt;
    return first;
  }

  /// With errors where the parameters are and slopes at the basis, which stays while it leads on (BasisAt). With slopes that
  /// move, what is known of poles that can hardly be told apart turns with them, and a filter that adds it up knows more than
  /// the records say.
  std::optional<LinearisedEpisode> Linearise(const Eigen::VectorXd& at,
                                             const Eigen::VectorXd& basis) const override {
    return LineariseTransfer(spectra_, used_, model_, Numbers(at), Numbers(basis));
  }

 private:
  const TransferModel& model_;
  const std::vector<double>& known_;
  LoopSpectra spectra_;
  std::vector<std::size_t> used_;
};

class LoopEpisodes : public EpisodeModel {
 public:
  LoopEpisodes(const Machine& machine, double sample_period)
      : machine_(machine),
        sample_period_(sample_period),
        model_(TransferModelOf(machine, sample_period)),
        known_(ReferencesOf(machine)),
        signals_(SignalsOfLoop(machine)) {
    for (const LoopParameter& p : model_.plant->parameters) {
      FollowedParameter followed{.name = std::string(p.name),
                                 .unit = std::string(FindParameter(KindOf(machine), p.name)->si),
                                 .scale = p.scale};
      if (p.kind == LoopParameter::Kind::kPositive) {
        followed.min = *std::ranges::min_element(p.starts) / kReachBeyondStarts;
        followed.max = *std::ranges::max_element(p.starts) * kReachBeyondStarts;
      }
      parameters_.push_back(std::move(followed));
    }
  }
  const Machine& machine() const override { return machine_; }
  const std::vector<FollowedParameter>& parameters() const override { return parameters_; }
  int basis_size() const override { return static_cast<int>(parameters_.size()); }
  bool told_by_one() const override { return true; }
  Eigen::VectorXd BasisAt(const Eigen::VectorXd& at, const Eigen::VectorXd& basis) const override {
    Eigen::VectorXd next = basis;
    for (Eigen::Index p = 0; p < basis.size(); ++p)
      if (!Near(model_.plant->parameters[static_cast<std::size_t>(p)], basis[p], at[p])) next[p] = at[p];
    return next;
  }

  std::unique_ptr<ReadEpisode> Read(const Episode& episode) const override {
    auto spectra = AverageLoopSpectra(RecordOf(episode), {});
    if (!spectra || static_cast<double>(spectra->segment_length) * sample_period_ < kShortestSegmentFollowed)
      return nullptr;
    std::vector<std::size_t> used = BinsOfSetPoint(*spectra);
    if (used.size() < kFewestBinsOfSetPoint) return nullptr;
    return std::make_unique<LoopRecord>(model_, known_, std::move(*spectra), std::move(used));
  }

  std::vector<Told> DoubtsOf(const Episode& episode) const override {
    const FrequencyRecord record = RecordOf(episode);
    const auto spectra = AverageLoopSpectra(record, {});
    if (!spectra) return {};
    return InputDoubtsOf(*model_.plant, FindInputRange(record, {}, *spectra, BinsOfSetPoint(*spectra)));
  }

 private:
  FrequencyRecord RecordOf(const Episode& episode) const {
    return {sample_period_,
            {{episode.time.front(), ColumnOf(episode, signals_[1]), ColumnOf(episode, signals_[2]),
              ColumnOf(episode, signals_[0])}}};
  }

  Machine machine_;
  double sample_period_;
  TransferModel model_;
  std::vector<double> known_;
  std::vector<int> signals_;  ///< set point, input, output
  std::vector<FollowedParameter> parameters_;
};

}  // namespace

TransferModel TransferModelOf(const Machine& machine, double sample_period) {
  const MachineKind& kind = KindOf(machine);
  TransferModel model{ClosedLoopOf(machine), {}, machine.log.hold == InputHold::kZero ? sample_period : 0};
  for (const MachineInput& known : kind.geometry) {
    const auto value = machine.Geometry(std::string(known.name));
    model.geometry.push_back(value ? value->value : known.otherwise.value_or(0));
  }
  return model;
}

std::vector<double> ReferencesOf(const Machine& machine) {
  std::vector<double> references;
  for (const LoopParameter& parameter : ClosedLoopOf(machine)->parameters) {
    const auto monitor = std::ranges::find_if(
        machine.monitors, [&](const MonitorSpec& m) { return m.parameter == parameter.name; });
    references.push_back(monitor == machine.monitors.end() ? kNaN : monitor->reference.value_or(kNaN));
  }
  return references;
}

std::shared_ptr<const EpisodeModel> EpisodesOfLoop(const Machine& machine, double sample_period) {
  return std::make_shared<LoopEpisodes>(machine, sample_period);
}

}  // namespace hydroscope
