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
  const auto parts = ChosenMachines(database, path, {strokes.machine});
  if (!parts) return tl::unexpected(parts.error());
  HistoryPart part = parts->front();
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
  auto database = Database::OpenReadOnly(path);
  if (!database) return tl::unexpected(database.error());
  const auto part = StoredPart(*database, path, request.strokes);
  if (!part) return tl::unexpected(part.error());
  const auto machine = StoredMachine(*database, path, *part);
  if (!machine) return tl::unexpected(machine.error());
  const auto rules = RulesFor(machine_file, *machine);
  if (!rules) return tl::unexpected(rules.error());
  std::string note;  // that a journal was set aside stands in the new one
  auto journal = OpenJournalOf(path, WallSeconds(), note);
  if (!journal) return tl::unexpected(journal.error());
  const auto candidate = LookBeforeLearning(*database, path, *machine, *part, *journal);
  if (!candidate) return tl::unexpected(candidate.error());
  nlohmann::json out = {{"first", part->first},
                        {"last", part->last - 1},
                        {"doubts", DoubtsJson(candidate->doubts)},
                        {"refused", candidate->Refused()},
                        {"learned", nullptr}};
  if (request.only_look || (candidate->Refused() && !request.insist)) return out;
  auto learned = LearnReference(*database, path, *candidate, *rules, *journal,
                                {request.user, request.comment}, WallSeconds());
  if (!learned) return tl::unexpected(learned.error());
  out["learned"] = std::move(*learned);
  return out;
}

}  // namespace

Learning::Learning(const WatchOptions& options, JobQueue& jobs)
    : database_(options.database), machine_file_(options.machine_file), jobs_(jobs) {}

Result<std::int64_t> Learning::Start(const LearnRequest& request) {
  const std::string& machine = request.strokes.machine;
  return jobs_.Add("learn", machine + (request.only_look ? " look" : ""),
                   [found = found_, path = database_, machine_file = machine_file_, request]() -> Status {
                     auto done = LookAndLearn(path, machine_file, request);
                     if (!done) return tl::unexpected(done.error());
                     const std::lock_guard lock(found->mutex);
                     found->last[request.strokes.machine] = std::move(*done);
                     return {};
                   });
}

nlohmann::json Learning::Last(const std::string& machine) const {
  const std::lock_guard lock(found_->mutex);
  const auto last = found_->last.find(machine);
  return last == found_->last.end() ? nlohmann::json() : last->second;
}

}  // namespace hydroscope
