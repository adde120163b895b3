#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "models/machine.h"

namespace hydroscope {

/// Lowest and highest value in each of equal stretches of a row of numbers whose length nobody knows beforehand: whenever
/// the stretches run out, each two become one. Spikes stay visible at any size.
class Envelope {
 public:
  /// `most`: stretches at most, an even number.
  explicit Envelope(std::size_t most) : most_(most) {}
  /// The next value; NaN counts as a row without a value.
  void Add(double value);

  std::size_t rows_per_stretch() const { return width_; }
  const std::vector<double>& low() const { return low_; }  ///< NaN where no row had a value
  const std::vector<double>& high() const { return high_; }

 private:
  void Halve();

  std::size_t most_, width_ = 1, rows_in_last_ = 0;
  std::vector<double> low_, high_;
};

/// Points in time of a picture.
inline constexpr std::size_t kPicturePoints = 1600;

/// A whole log at the size of a screen: `time` (`from`, `step`, s), `signals` (`name`, `unit`, `low`, `high` in the unit
/// shown), `strokes` (`begin`, `end`, s: what the gate lets through; null: the machine has none), `discarded` (too short), `no_strokes` (why the gate
/// says nothing, or null), `gate` (what each bound looks at, GateCourse::Json). Errors: as OpenRecording.
Result<nlohmann::json> LogPictureJson(const std::string& log, const Machine& machine);

/// `low`, `high` of the values of one column, `points` of them.
nlohmann::json ThumbnailJson(const std::vector<double>& values, std::size_t points);

}  // namespace hydroscope
