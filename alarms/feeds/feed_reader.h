#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alarms/alarm_machine.h"
#include "alarms/health_board.h"
#include "core/records/alarm_records.h"
#include "core/result.h"
#include "storage/alarm_journal.h"
#include "storage/database.h"

namespace hydroscope {

/// An axis as the outside sees it now; or the press itself, which has alarms but no strokes of its own.
struct AxisPicture {
  std::string machine;             ///< "press/cushion_1"
  std::string name;                ///< "cushion_1"
  Health health;                   ///< the answer of HealthBoard, the same in every feed
  std::vector<AlarmState> alarms;  ///< in order of id
  std::int64_t strokes = 0;        ///< stored so far
  /// Of the newest stroke, one per parameter, as they are stated (EstimateStatement); none before the first.
  std::vector<TrendPoint> estimates;
};

/// The journal and the trend database as one feed reads them, through handles of its own. What is not there
/// yet is tried again with the next call; after an error the files are opened anew.
class FeedReader {
 public:
  /// `machines`: the axes, in their order; `press`: their press, "" if there is only one axis. `board`: what
  /// the service knows of their health; without it health is what the journal tells.
  FeedReader(std::vector<std::string> machines, std::string press, std::string database,
             std::shared_ptr<const HealthBoard> board = nullptr)
      : machines_(std::move(machines)),
        press_(std::move(press)),
        database_path_(std::move(database)),
        board_(std::move(board)) {}

  Result<std::vector<std::pair<std::string, std::string>>> AlarmsByAppearance();
  Result<std::int64_t> LastSequence();
  /// Rows of all machines with sequence > `after`, at most `limit`, in order.
  Result<std::vector<JournalRow>> Rows(std::int64_t after, std::int64_t limit);
  /// All axes; behind them the press, as soon as the journal has an alarm of all axes together. Where journal
  /// or trends cannot be read an axis stands as it was seen last, its health as it is now. Error: the journal
  /// cannot be read, and nobody else tells health.
  Result<std::vector<AxisPicture>> Axes();
  /// Of the service; kJudgedGood without a service.
  ServiceTrouble trouble() const { return board_ ? board_->trouble() : ServiceTrouble{}; }
  /// False: there was nothing to acknowledge. `wall` in s since 1970.
  Result<bool> Acknowledge(const std::string& machine, const std::string& alarm, const AlarmUser& user,
                           double wall);

  const std::vector<std::string>& machines() const { return machines_; }
  /// Number of an axis from 1, the press is behind the last; 0 if the machine is none of ours.
  int AxisNumber(const std::string& machine) const;

 private:
  template <typename Use>
  auto WithJournal(Use&& use) -> decltype(use(std::declval<AlarmJournal&>()));
  Result<AxisPicture> ReadAxis(const std::string& machine);
  Result<std::optional<AxisPicture>> ReadPress();
  Status ReadTrends(AxisPicture& axis);

  std::vector<std::string> machines_;
  std::string press_, database_path_;
  std::shared_ptr<const HealthBoard> board_;
  std::map<std::string, AxisPicture> seen_;  ///< as last read, by machine
  std::optional<AlarmJournal> journal_;
  std::optional<Database> database_;
};

}  // namespace hydroscope
