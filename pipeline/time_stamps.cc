#include "pipeline/time_stamps.h"

#include <algorithm>
#include <bit>

#include "core/records/quality.h"
#include "replay/time_check.h"

namespace hydroscope {

Told CoarseTimeStamps(const LogCounters& read, std::size_t signals) {
  constexpr int kBit = std::countr_zero(static_cast<unsigned>(quality::kDuplicate));
  const double values = static_cast<double>(read.rows) * static_cast<double>(signals);
  const double share = static_cast<double>(read.flagged[kBit]) / std::max(1.0, values);
  if (share < kCoarseShare) return {};
  return Tell(
      "{:.0f} % of the rows repeat the time stamp of the row before: the stamps are coarser than the rows, or tell when a row was "
      "stored and not when it was sampled. Record the controller's own times, with more digits, or give the log a column of its "
      "own with the true times",
      "{:.0f} % der Zeilen wiederholen den Zeitstempel der Zeile davor: die Stempel sind gröber als die Zeilen, oder sie sagen, wann "
      "eine Zeile gespeichert und nicht wann sie abgetastet wurde. Die Zeiten der Steuerung aufzeichnen, mit mehr Stellen, oder "
      "der Aufzeichnung eine Spalte mit den wahren Zeiten geben",
      100 * share);
}

}  // namespace hydroscope
