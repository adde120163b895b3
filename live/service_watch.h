#pragma once

#include <optional>
#include <string>

#include "alarms/health_board.h"
#include "core/told.h"
#include "live/writer.h"
#include "storage/alarm_journal.h"

namespace hydroscope {

/// What the state of the writer means for health; kJudgedGood while it writes.
ServiceTrouble TroubleOf(const WriterStatus& writer);
/// Strokes are stored but not judged, and why; "": they are.
ServiceTrouble NotWatched(const Told& why);

/// Tells what keeps the service itself from its work: at once to the board, from which every feed reads
/// health, and as alarms of the press (of its only axis, if it has one) in the journal, as soon as that can
/// be written. One object belongs to one thread.
///   not_stored: disk full, database locked, gone, or failing otherwise
///   not_judged: the drift of the machine is not watched
///   database_begun_anew: what was stored before is elsewhere, or lost
class ServiceWatch {
 public:
  /// `press`: machine of the journal that gets the alarms.
  ServiceWatch(std::string journal, std::string press, HealthBoard& board)
      : journal_path_(std::move(journal)), press_(std::move(press)), board_(board) {}

  /// `not_judged`: why nothing is judged, "" while strokes are. `wall`: s since 1970.
  void Look(const WriterStatus& writer, const Told& not_judged, double wall);
  /// Database or journal were lost and begun anew, and why: an alarm that has gone again, but stands until
  /// somebody acknowledges it.
  void BegunAnew(const Told& why, double wall);

 private:
  Status Observe(const std::string& alarm, const ServiceTrouble& trouble, double wall);

  std::string journal_path_, press_;
  HealthBoard& board_;
  std::optional<AlarmJournal> journal_;
};

}  // namespace hydroscope
