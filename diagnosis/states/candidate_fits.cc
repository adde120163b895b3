#include "diagnosis/states/candidate_fits.h"

#include <algorithm>

#include "diagnosis/states/law_terms.h"
#include "estimation/states/same_end.h"

namespace hydroscope {
namespace {

Eigen::VectorXd FileStart(const StateModel& model) {
  Eigen::VectorXd start(model.parameter_count());
  for (int p = 0; p < start.size(); ++p) start[p] = model.parameters[static_cast<std::size_t>(p)].spec.start;
  return start;
}

/// What a fit found, for a model with fewer effects.
StateStart StartFrom(const StateFit& fit, const StateModel& model) {
  StateStart start{Eigen::VectorXd(model.parameter_count()), fit.initial};
  for (int p = 0; p < model.parameter_count(); ++p) {
    const auto& known = fit.model->parameters;
    const auto at = std::find_if(known.begin(), known.end(), [&](const StateParameter& other) {
      return other.name == model.parameters[static_cast<std::size_t>(p)].name;
    });
    start.parameters[p] = fit.parameters[at - known.begin()];
  }
  return start;
}

/// Whether one leads where the other does.
bool Alike(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  constexpr double kApart = 0.01;
  return ((a - b).array().abs() <= kApart * a.array().abs().max(b.array().abs())).all();
}

StateCandidate NotFitted(const std::vector<std::string>& added) {
  StateCandidate none;
  none.added = added;
  return none;
}

}  // namespace

std::vector<std::string> CandidateFits::WithAdded(const std::vector<std::string>& added) const {
  std::vector<std::string> effects = machine_.added_effects;
  effects.insert(effects.end(), added.begin(), added.end());
  return effects;
}

Result<StateContender> CandidateFits::Screened(const std::vector<std::string>& added,
                                               const StateCandidate& near) const {
  const auto model = TRY(BuildStateModel(machine_, WithAdded(added)));
  ScreenedEffect screened = ScreenEffect(near.fit, *model, episodes_, options_.screening);
  return StateContender{added, model, std::move(screened.starts), screened.seen,
                        near.held_out * (1 - screened.explained.value_or(1))};
}

std::optional<StateStart> CandidateFits::BestOf(const std::shared_ptr<const StateModel>& model,
                                                std::span<const StateStart> starts) const {
  std::vector<StateStart> on_few;
  for (const StateStart& start : starts) {
    on_few.push_back({start.parameters, {}});
    if (start.initial.size() < episodes_.size())
      continue;  // short segments know those of the first rows only
    for (const std::size_t e : starts_on_) on_few.back().initial.push_back(start.initial[e]);
  }
  StateFitOptions rough = options_.fit;
  rough.iterations = rough.start_iterations = options_.screen_iterations;
  rough.tolerance = rough.start_tolerance = options_.screen_tolerance;
  const StateFit fit = RefitStates(model, few_, on_few, noise_, rough);
  if (!fit.solved()) return std::nullopt;
  return StateStart{fit.parameters, {}};
}

StateCandidate CandidateFits::Fit(const std::vector<std::string>& added,
                                  std::shared_ptr<const StateModel> model,
                                  std::span<const StateStart> starts) const {
  StateFitOptions quick = options_.fit;
  quick.iterations = options_.candidate_iterations;
  quick.tolerance = options_.candidate_tolerance;
  quick.start_iterations = options_.screen_iterations;
  quick.start_tolerance = options_.screen_tolerance;
  std::optional<StateStart> best;
  if (TriesOnFew() && starts.size() > 1) {
    best = BestOf(model, starts);
    if (!best) return NotFitted(added);
    starts = std::span(&*best, 1);
  }
  StateCandidate candidate;
  candidate.added = added;
  candidate.fit = RefitStates(std::move(model), episodes_, starts, noise_, quick);
  if (!candidate.fitted()) return candidate;
  candidate.held_out = candidate.fit.HeldOutEnergy();
  std::tie(candidate.gain, candidate.t) =
      PairedGain(base_.fit.HeldOutEnergies(), candidate.fit.HeldOutEnergies());
  return candidate;
}

StateCandidate CandidateFits::Fitted(const StateContender& contender) const {
  return Fit(contender.added, contender.model, contender.starts);
}

StateCandidate CandidateFits::FittedFromSegments(const StateContender& contender,
                                                 const StateCandidate* known) const {
  // Episodes that are no longer than segments need none; one run from the machine file's start is another way to the minimum.
  if (std::all_of(episodes_.begin(), episodes_.end(), [&](const Episode& episode) {
        return episode.rows() - 1 <= options_.fit.segment_rows * episode.mean_rows;
      })) {
    const StateStart start{FileStart(*contender.model), {}};
    return Fit(contender.added, contender.model, std::span(&start, 1));
  }
  std::vector<StateStart> starts;
  for (const Eigen::VectorXd& from : {contender.starts.front().parameters, FileStart(*contender.model)})
    if (auto shot = ShootStart(contender.model, episodes_, from, options_.fit);
        shot && (starts.empty() || !Alike(starts.front().parameters, shot->parameters)) &&
        !(known != nullptr && IsWhereItEnded(known->fit, episodes_, *shot, options_.fit.same_minimum)))
      starts.push_back(std::move(*shot));
  if (!starts.empty()) return Fit(contender.added, contender.model, starts);
  return NotFitted(contender.added);
}

StateCandidate CandidateFits::FittedNear(const StateContender& contender, const StateCandidate& other,
                                         double apart) const {
  const auto nearest = NearestLawTo(base_.fit, other, *contender.model, episodes_);
  if (!nearest || nearest->apart > apart) return NotFitted(contender.added);
  const StateStart start{nearest->parameters, other.fit.initial};
  return Fit(contender.added, contender.model, std::span(&start, 1));
}

StateCandidate CandidateFits::FittedFromAfar(const StateCandidate& fitted) const {
  StateFitOptions rough = options_.fit;  // its best minimum is fitted on with the others' noise
  rough.polished = 1;
  rough.until_white = true;
  rough.until_agreed = kEnoughStarts;
  rough.ended = fitted.fit.parameters;
  rough.iterations = options_.screen_iterations;
  rough.tolerance = options_.screen_tolerance;
  const StateFit afar = FitStates(fitted.fit.model, few_, rough);
  if (!afar.solved()) return NotFitted(fitted.added);
  const StateStart start{afar.parameters, TriesOnFew() ? std::vector<Eigen::VectorXd>() : afar.initial};
  return Fit(fitted.added, fitted.fit.model, std::span(&start, 1));
}

StateCandidate CandidateFits::Without(const StateCandidate& fitted,
                                      const std::vector<std::string>& rest) const {
  const auto model = BuildStateModel(machine_, WithAdded(rest));
  if (!model) return NotFitted(rest);
  const StateStart start = StartFrom(fitted.fit, **model);
  return Fit(rest, *model, std::span(&start, 1));
}

StateCandidate CandidateFits::Foreseen(const StateContender& contender) const {
  StateCandidate out;
  out.added = contender.added;
  out.held_out = contender.foreseen;
  out.gain = base_.held_out - contender.foreseen;
  return out;
}

}  // namespace hydroscope
