#include "diagnosis/states/other_causes/initial_values.h"

#include <fmt/ranges.h>

#include <cmath>

#include "estimation/states/fit_task.h"

namespace hydroscope {
namespace {

/// States whose initial values the model gives.
std::vector<std::string> Given(const StateModel& model) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < model.estimated.size(); ++i)
    if (!model.estimated[i]) names.push_back(model.machine.states.states[i].name);
  return names;
}

/// The same model with every initial value estimated; nullptr: there is none.
std::shared_ptr<const StateModel> WithAllEstimated(const StateModel& model) {
  Machine machine = model.machine;
  for (std::size_t i = 0; i < model.estimated.size(); ++i)
    if (!model.estimated[i]) machine.states.states[i].initial = "estimate";
  const auto built = BuildStateModel(machine, model.effects);
  return built ? *built : nullptr;
}

/// Nothing where the error with them estimated is not clearly smaller. `rms`: per output.
std::optional<OtherBeginning> Judged(const StateModel& model, const Eigen::VectorXd& noise,
                                     const Eigen::VectorXd& given, const Eigen::VectorXd& estimated,
                                     double less_error) {
  const double error =
      std::sqrt(estimated.cwiseQuotient(noise).squaredNorm() / given.cwiseQuotient(noise).squaredNorm());
  if (!(error <= less_error)) return std::nullopt;
  return OtherBeginning{Given(model), error};
}

}  // namespace

std::optional<OtherBeginning> FindOtherBeginning(const StateFit& fit, std::span<const Episode> episodes,
                                                 const InitialValuesOptions& options) {
  if (Given(*fit.model).empty()) return std::nullopt;
  const auto free = WithAllEstimated(*fit.model);
  if (free == nullptr) return std::nullopt;
  const std::vector<Episode> few = shooting::FirstRows(episodes, options.rows);
  StateFitOptions short_fit;
  short_fit.iterations = options.iterations;
  StateStart start{fit.parameters, fit.initial};
  start.initial.resize(few.size());
  const StateFit given = RefitStates(fit.model, few, std::span(&start, 1), fit.noise, short_fit);
  const StateFit estimated = RefitStates(free, few, std::span(&start, 1), fit.noise, short_fit);
  if (!given.solved() || !estimated.solved()) return std::nullopt;
  return Judged(*fit.model, fit.noise, given.noise, estimated.noise, options.less_error);
}

std::optional<OtherBeginning> FindOtherBeginningHeldOut(const StateFit& fit,
                                                        std::span<const Episode> episodes,
                                                        const InitialValuesOptions& options) {
  if (Given(*fit.model).empty()) return std::nullopt;
  const auto free = WithAllEstimated(*fit.model);
  if (free == nullptr) return std::nullopt;
  const StateFit given = FollowStates(fit.model, episodes, fit.parameters, fit.noise);
  const StateFit estimated = FollowStates(free, episodes, fit.parameters, fit.noise);
  if (!given.solved() || !estimated.solved()) return std::nullopt;
  const int outputs = fit.model->output.rows;
  return Judged(*fit.model, fit.noise, RmsOf(given.residuals, outputs), RmsOf(estimated.residuals, outputs),
                options.less_error);
}

Told OtherBeginningText(const OtherBeginning& other, const Told& record) {
  return Tell(
      "{} does not seem to begin with the initial values that the model gives of {}: with these estimated its error is {:.0f} % of "
      "this; begin the record where they hold, or, in a machine file of your own, write initial = \"estimate\"",
      "{} scheint nicht mit den Anfangswerten zu beginnen, die das Modell für {} nennt: geschätzt beträgt der Fehler {:.0f} % von "
      "diesem; die Aufnahme dort beginnen, wo sie gelten, oder in einer eigenen Maschinendatei initial = \"estimate\" schreiben",
      record, fmt::to_string(fmt::join(other.states, ", ")), 100 * other.error);
}

}  // namespace hydroscope
