#include "diagnosis/states/other_causes/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/parallel/in_parallel.h"
#include "core/short_number.h"
#include "diagnosis/states/other_causes/missing_dynamics.h"
#include "diagnosis/states/remainder.h"
#include "diagnosis/states/set_comparison.h"
#include "diagnosis/states/tangent.h"
#include "estimation/column_products.h"
#include "estimation/decompositions.h"
#include "estimation/states/fit_task.h"

namespace hydroscope {
namespace {

/// A fit with another sampling, and the energy of its error over the noise of the one before; of no model if it diverges.
struct SampledFit {
  StateFit fit;
  double energy = INFINITY;

  bool solved() const { return fit.model != nullptr && fit.solved(); }
};

/// What a row's outputs change by in a second, as simulated: differences of order 4, NaN at the ends.
RowMatrix OutputRates(const StateRun& run, const Episode& episode) {
  RowMatrix rates = RowMatrix::Constant(run.outputs.rows(), run.outputs.cols(), NAN);
  for (Eigen::Index row = 2; row + 2 < rates.rows(); ++row) {
    const auto at = static_cast<std::size_t>(row);
    const double period = (episode.time[at + 2] - episode.time[at - 2]) / 4;
    rates.row(row) = (8 * (run.outputs.row(row + 1) - run.outputs.row(row - 1)) -
                      (run.outputs.row(row + 2) - run.outputs.row(row - 2))) /
                     (12 * period);
  }
  return rates;
}

class OtherSamplings {
 public:
  OtherSamplings(const StateFit& fit, std::span<const Episode> episodes, LeftBySampling left,
                 const SamplingOptions& options)
      : fit_(fit), left_(left), options_(options), few_(shooting::FirstRows(episodes, options.rows)) {
    for (const Episode& episode : few_) {
      for (std::size_t row = 1; row < episode.time.size(); ++row)
        period_ += episode.time[row] - episode.time[row - 1];
      intervals_ += std::max(episode.rows() - 1, 0);
    }
    if (intervals_ > 0) period_ /= intervals_;
  }

  std::optional<OtherSampling> Find() const {
    const LogFormat& stated = fit_.model->machine.log;
    const SampledFit as_stated = Fitted(stated.hold, stated.outputs_late, fit_);
    if (!as_stated.solved()) return std::nullopt;
    const bool looks_for_time = !stated.outputs_late && std::ranges::all_of(few_, [](const Episode& episode) {
      return episode.mean_rows == 1;
    });
    std::vector<Way> ways;
    TakeEach(ways, as_stated, [&](InputHold hold) {
      std::vector<Way> of_hold;
      SampledFit held = hold == stated.hold ? as_stated : Fitted(hold, stated.outputs_late, fit_);
      if (!held.solved()) return of_hold;
      if (looks_for_time) of_hold.push_back(OlderWith(hold, 0, held));
      of_hold.push_back({{hold, stated.outputs_late.value_or(0)}, std::move(held)});
      return of_hold;
    });
    if (looks_for_time && ways.front().clear) TakeLikeBest(ways, as_stated);
    return Plainest(ways);
  }

 private:
  struct Way {
    OtherSampling sampling;
    SampledFit fit;
    bool clear = false;  ///< it leaves clearly less than what the file says
  };

  /// The ways that `of_hold` gives for each hold.
  template <class OfHold>
  void TakeEach(std::vector<Way>& ways, const SampledFit& as_stated, const OfHold& of_hold) const {
    constexpr std::array kHolds = {InputHold::kZero, InputHold::kLinear, InputHold::kSmooth};
    for (std::vector<Way>& some :
         InParallel(options_.threads, kHolds.size(), [&](std::size_t k) { return of_hold(kHolds[k]); }))
      for (Way& way : some) Take(ways, std::move(way), as_stated);
  }

  /// Into the list, best first.
  void Take(std::vector<Way>& ways, Way way, const SampledFit& as_stated) const {
    const LogFormat& stated = fit_.model->machine.log;
    OtherSampling& sampling = way.sampling;
    sampling.holds_otherwise = sampling.hold != stated.hold;
    sampling.is_late = sampling.late != stated.outputs_late.value_or(0);
    sampling.late_rows = sampling.late / period_;
    sampling.error = std::sqrt(way.fit.energy / as_stated.energy);
    if (!way.fit.solved()) return;
    way.clear = LeavesClearlyLess(way, as_stated);
    const auto at = std::ranges::upper_bound(ways, sampling.error, {},
                                             [](const Way& other) { return other.sampling.error; });
    ways.insert(at, std::move(way));
  }

  bool LeavesClearlyLess(const Way& way, const SampledFit& as_stated) const {
    const bool in_doubt = left_ == LeftBySampling::kDoubt;
    if (in_doubt && way.sampling.error <= options_.less_error) return true;
    if (way.fit.energy > (1 - options_.least_share) * as_stated.energy) return false;
    const ExplainStatesOptions options;
    const auto candidate = [](const StateFit& fit) { return StateCandidate{{}, fit, fit.HeldOutEnergy()}; };
    return SetComparison(options).Better(candidate(as_stated.fit), {}, candidate(way.fit.fit)) &&
           (!in_doubt || LeavesNoise(way.fit.fit));
  }

  bool LeavesNoise(const StateFit& fit) const {
    const StateRemainder left = RemainderOf(fit, few_);
    return !left.structured && !left.doubtful && !FindMissingDynamics(fit, left, few_);
  }

  /// The other holds from where the best way ended: far from there a fit finds no way back. Inputs that are held are half a row older
  /// on the mean than on lines between rows.
  void TakeLikeBest(std::vector<Way>& ways, const SampledFit& as_stated) const {
    constexpr double kNone = 0.05;  // rows
    const Way best = ways.front();
    const auto held = [](InputHold hold) { return hold == InputHold::kZero ? 0.5 : 0.0; };
    TakeEach(ways, as_stated, [&](InputHold hold) {
      std::vector<Way> of_hold;
      Way way = best;
      if (hold != best.sampling.hold) {
        const double late = best.sampling.late + (held(best.sampling.hold) - held(hold)) * period_;
        way = OlderWith(hold, late, Fitted(hold, late, best.fit.fit));
        of_hold.push_back(way);
      }
      if (way.fit.solved() && way.sampling.late != 0 && std::abs(way.sampling.late) <= kNone * period_)
        of_hold.push_back({{hold, 0}, Fitted(hold, std::nullopt, way.fit.fit)});
      return of_hold;
    });
  }

  /// Begins where `from` ended.
  SampledFit Fitted(InputHold hold, std::optional<double> late, const StateFit& from) const {
    Machine machine = fit_.model->machine;
    machine.log.hold = hold;
    machine.log.outputs_late = late;
    const auto model = BuildStateModel(machine, fit_.model->effects);
    if (!model) return {};
    StateStart start{from.parameters, from.initial};
    start.initial.resize(few_.size());
    StateFitOptions short_fit;
    short_fit.iterations =
        left_ == LeftBySampling::kNoise ? options_.iterations_in_noise : options_.iterations;
    SampledFit out{RefitStates(*model, few_, std::span(&start, 1), fit_.noise, short_fit)};
    if (out.solved()) out.energy = out.fit.noise.cwiseQuotient(fit_.noise).squaredNorm();
    return out;
  }

  /// s by which outputs seem to be older than a fit has them, by linearisation: what is left of them then has the shape of their
  /// rates. Parameters and initial states make up for what they can. 0: that leaves more than a share `most` of the energy.
  double OlderBy(const StateFit& fit, double most) const {
    std::vector<RowMatrix> rates;
    for (std::size_t e = 0; e < few_.size(); ++e) rates.push_back(OutputRates(fit.runs[e], few_[e]));
    Eigen::MatrixXd products;
    for (std::size_t e = 0; e < few_.size(); ++e) {
      const RowMatrix columns = TangentColumns(fit, few_[e], e, {}, {&rates[e], &fit.residuals[e]});
      if (e == 0) products = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
      products += ColumnProducts(columns);
    }
    const Eigen::Index last = products.rows() - 1;
    std::vector<Eigen::Index> others;
    for (Eigen::Index c = 0; c <= last; ++c)
      if (c != last - 1) others.push_back(c);
    if (EnergyLeft(products) > most * EnergyLeft(products(others, others))) return 0;
    Eigen::MatrixXd own = products.topLeftCorner(last, last);
    own.diagonal().array() *= 1 + 1e-9;
    const Eigen::VectorXd cross = products.col(last).head(last);
    return -SymmetricFactor(own).Solve(cross)[last - 1];
  }

  /// With the age of outputs that leaves least with one hold; `from`: fitted with that hold and the age `late`.
  Way OlderWith(InputHold hold, double late, SampledFit from) const {
    Way best{{hold, late}, std::move(from)};
    for (int step = 0; best.fit.solved() && step < options_.late_steps; ++step) {
      const double by = OlderBy(best.fit.fit, step == 0 ? options_.foreseen : 1),
                   most = options_.late_rows * period_;
      if (std::abs(by) < options_.late_settled * period_) break;
      const double next = std::clamp(best.sampling.late + by, -most, most);
      SampledFit moved = Fitted(hold, next, best.fit.fit);
      if (!moved.solved() || moved.energy >= best.fit.energy) break;
      best = {{hold, next}, std::move(moved)};
    }
    return best;
  }

  /// The best way; of those that leave hardly more the one that differs from the file in least, and by the least age.
  std::optional<OtherSampling> Plainest(const std::vector<Way>& ways) const {
    if (!ways.front().clear) return std::nullopt;
    const double best = ways.front().sampling.error;
    const auto changes = [](const OtherSampling& way) {
      return std::pair(int{way.holds_otherwise} + int{way.is_late}, std::abs(way.late_rows));
    };
    OtherSampling plainest = ways.front().sampling;
    for (const auto& [way, fit, clear] : ways)
      if (clear && way.error <= options_.plainer * best && changes(way) < changes(plainest)) plainest = way;
    return plainest;
  }

  const StateFit& fit_;
  const LeftBySampling left_;
  const SamplingOptions& options_;
  const std::vector<Episode> few_;
  double period_ = 0;  ///< s from row to row on the mean
  int intervals_ = 0;
};

/// "hold = "zero" and outputs_late = 0.0003 in [log]", of what differs from the file.
Told Keys(const OtherSampling& other) {
  const std::string_view name = kInputHoldNames[static_cast<std::size_t>(other.hold)];
  const std::string late = ShortNumber(other.late, 3);
  if (!other.is_late) return Tell("hold = \"{}\" in [log]", "hold = \"{}\" in [log]", name);
  if (!other.holds_otherwise) return Tell("outputs_late = {} in [log]", "outputs_late = {} in [log]", late);
  return Tell("hold = \"{}\" and outputs_late = {} in [log]", "hold = \"{}\" und outputs_late = {} in [log]",
              name, late);
}

/// What that means.
Told Meaning(const OtherSampling& other) {
  if (!other.is_late)
    return Tell("the inputs seem to move so between rows",
                "die Eingänge scheinen sich zwischen den Zeilen so zu bewegen");
  return other.late > 0
             ? Tell(
                   "the outputs of a row seem to be {:.2f} rows older than its inputs (skew of the logger, a filter or an "
                   "amplifier that lags, a dead time)",
                   "die Ausgänge einer Zeile scheinen {:.2f} Zeilen älter als ihre Eingänge zu sein (Versatz des Loggers, ein "
                   "Filter oder Verstärker, der nachläuft, eine Totzeit)",
                   other.late_rows)
             : Tell(
                   "the outputs of a row seem to be {:.2f} rows newer than its inputs (skew of the logger, a filter of the inputs)",
                   "die Ausgänge einer Zeile scheinen {:.2f} Zeilen neuer als ihre Eingänge zu sein (Versatz des Loggers, ein "
                   "Filter der Eingänge)",
                   -other.late_rows);
}

}  // namespace

std::optional<OtherSampling> FindOtherSampling(const StateFit& fit, std::span<const Episode> episodes,
                                               LeftBySampling left, const SamplingOptions& options) {
  if (fit.model->inputs.empty()) return std::nullopt;
  return OtherSamplings(fit, episodes, left, options).Find();
}

Told OtherSamplingText(const OtherSampling& other) {
  return Tell(
      "with {} the error is {:.0f} % of this: {}; if that may be, write it into the machine file first",
      "mit {} beträgt der Fehler {:.0f} % von diesem: {}; wenn das sein kann, es zuerst in die Maschinendatei schreiben",
      Keys(other), 100 * other.error, Meaning(other));
}

Told TakenSamplingText(const OtherSampling& taken) {
  return Tell(
      "{} leaves {:.0f} % of the error without it, and is taken: {}; write it into the machine file",
      "{} lässt {:.0f} % des Fehlers ohne dies übrig und wird genommen: {}; es in die Maschinendatei schreiben",
      Keys(taken), 100 * taken.error, Meaning(taken));
}

}  // namespace hydroscope
