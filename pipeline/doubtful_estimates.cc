#include "pipeline/doubtful_estimates.h"

#include <algorithm>

#include "estimation/closed_loop/loop_episodes.h"
#include "estimation/closed_loop/reversal.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"
#include "pipeline/log_faults/usual_modulus.h"
#include "pipeline/run_summary.h"

namespace hydroscope {

Told ReversedIn(const Machine& machine, std::span<const Estimate> parameters) {
  const ClosedLoopPlant* const loop = ClosedLoopOf(machine);
  if (loop == nullptr || parameters.size() != loop->parameters.size()) return {};
  std::vector<double> values;
  for (const Estimate& estimate : parameters) values.push_back(estimate.value);
  return ReversedSignal(*loop, values, ReferencesOf(machine));
}

std::vector<Told> DoubtsOf(const Machine& machine, std::span<const Estimate> parameters) {
  std::vector<Told> doubts = UnusualParameters(machine, parameters);
  if (Told reversed = ReversedIn(machine, parameters); !reversed.empty())
    doubts.push_back(std::move(reversed));
  return doubts;
}

std::vector<Told> DoubtsOfNewest(const Machine& machine, std::span<const Estimate> parameters,
                                 std::span<const RunInfo> runs) {
  std::vector<Told> doubts = DoubtsOf(machine, parameters), of_log;
  for (const RunInfo& run : runs) {
    if (run.strokes == 0) continue;
    of_log.clear();
    for (std::string& warning : ParseRunSummary(run.summary_json).warnings)
      of_log.emplace_back(std::move(warning));
  }
  AddDoubts(std::move(of_log), doubts);
  return doubts;
}

void AddDoubts(std::vector<Told> more, std::vector<Told>& doubts) {
  for (Told& doubt : more)
    if (std::ranges::find(doubts, doubt.english, &Told::english) == doubts.end())
      doubts.push_back(std::move(doubt));
}

}  // namespace hydroscope
