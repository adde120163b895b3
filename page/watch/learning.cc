#include "page/watch/learning.h"

#include <algorithm>

#include "core/told_error.h"
#include "host/real_clock.h"
#include "monitor/learning.h"
#include "monitor/rules_for.h"

namespace hydroscope {
namespace {

/// The strokes asked for, as far as they are stored.
Result<HistoryPart> StoredPart(Database& database, const std::string& path, const StrokeStretch& strokes) {
  const auto parts = TRY(ChosenMachines(database, path, {strokes.machine}));
  HistoryPart part = parts.front();
  part.first = std::max(part.first, strokes.first);
  part.last = std::min(part.last, strokes.last + 1);
  if (part.strokes() <= 0)
    return BadInput(Tell("{} has no strokes {} to {}", "{} hat keine Hübe {} bis {}", strokes.machine,
                         strokes.first, strokes.last));
  return part;
}

/// What Learning::Last tells of it.
Result<nlohmann::json> LookAndLearn(const std::string& path, const std::string& machine_file,
                                    const LearnRequest& request) {
  auto database = TRY(Database::OpenReadOnly(path));
  const auto part = TRY(StoredPart(database, path, request.strokes));
  const auto machine = TRY(StoredMachine(database, path, part));
  const auto rules = TRY(RulesFor(machine_file, machine));
  std::string note;  // that a journal was set aside stands in the new one
  auto journal = TRY(OpenJournalOf(path, WallSeconds(), note));
  const auto candidate = TRY(LookBeforeLearning(database, path, machine, part, journal));
  nlohmann::json out = {{"first", part.first},
                        {"last", part.last - 1},
                        {"doubts", DoubtsJson(candidate.doubts)},
                        {"refused", candidate.Refused()},
                        {"learned", nullptr}};
  if (request.only_look || (candidate.Refused() && !request.insist)) return out;
  auto learned = TRY(LearnReference(database, path, candidate, rules, journal,
                                    {request.user, request.comment}, WallSeconds()));
  out["learned"] = std::move(learned);
  return out;
}

}  // namespace

Learning::Learning(const WatchOptions& options, JobQueue& jobs)
    : database_(options.database), machine_file_(options.machine_file), jobs_(jobs) {}

Result<std::int64_t> Learning::Start(const LearnRequest& request) {
  const std::string& machine = request.strokes.machine;
  return jobs_.Add("learn", machine + (request.only_look ? " look" : ""),
                   [found = found_, path = database_, machine_file = machine_file_, request]() -> Status {
                     auto done = TRY(LookAndLearn(path, machine_file, request));
                     const std::lock_guard lock(found->mutex);
                     found->last[request.strokes.machine] = std::move(done);
                     return {};
                   });
}

nlohmann::json Learning::Last(const std::string& machine) const {
  const std::lock_guard lock(found_->mutex);
  const auto last = found_->last.find(machine);
  return last == found_->last.end() ? nlohmann::json() : last->second;
}

}  // namespace hydroscope
