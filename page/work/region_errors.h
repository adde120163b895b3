#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/units.h"
#include "workbench/compare_log.h"
#include "workbench/explain/explain_log.h"
#include "workbench/region_errors.h"
#include "workbench/states/states_log.h"

namespace hydroscope {

/// What a model errs window by window, and what it would err with each of the best effects, all fitted to all strokes: for
/// questions about a part of the operating space.
class RegionErrors {
 public:
  static constexpr std::size_t kMostEffects = 12;

  /// The model as it is.
  void Take(const CompareResult& compared);
  /// ... of a machine with states: the output that errs most.
  void Take(const StatesFit& compared);
  /// With one more effect, of the best kMostEffects that could be fitted.
  void Take(const ExplainResult& explained);

  /// `windows`, `rms`, `noise`, `unit`; `strokes` (`stroke`, `windows`, `rms`, `noise`), those with windows in the region;
  /// `effects` (`effect`, `rms`), least error first, [] until they were taken. Null: nothing was taken yet. Error: the region
  /// names a signal that is not looked at.
  Result<nlohmann::json> In(const Region& region) const;
  /// What the model would give of a stroke with this effect, as shown, per window; null: it is none of those taken, or a signal
  /// it needs was bad.
  nlohmann::json ModelledWith(const std::string& effect, std::int64_t stroke) const;

 private:
  void ShowIn(const DisplayUnit& unit) { factor_ = unit.factor, unit_ = unit.name; }

  std::vector<std::int64_t> strokes_;  ///< of each of `residuals_`; pieces of an episode follow one another
  Residuals residuals_;
  double factor_ = 1;  ///< from SI to `unit_`
  std::string unit_;
  std::vector<ModelledWithEffect> effects_;
};

}  // namespace hydroscope
