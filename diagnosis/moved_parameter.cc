#include "diagnosis/moved_parameter.h"

#include <cmath>

#include "core/constants.h"
#include "core/relative_change.h"
#include "core/unit_told.h"
#include "models/parameter_unit.h"

namespace hydroscope {

std::optional<MovedParameter> FindMovedParameter(const ModelStructure& model, const ExtendedFit& as_is,
                                                 const ExtendedFit& with, double least) {
  const int count = model.base_count;
  const Eigen::MatrixXd covariance = as_is.covariance.topLeftCorner(count, count);
  const std::vector<DerivedParameter> after = model.derive(with.theta.head(count));
  std::optional<MovedParameter> moved;
  std::size_t at = 0;
  for (const DerivedParameter& before : model.derive(as_is.theta.head(count))) {
    const double change = after[at++].value - before.value;
    if (!(std::abs(change) > least * before.useful_std())) continue;
    const double std = std::sqrt(before.gradient.dot(covariance * before.gradient));
    const auto share = RelativeChange(before.value, std, change);
    const bool leaves = std::abs(change) > kNormal95 * std;
    if (share && (!moved || (leaves && !moved->leaves_interval)))
      moved = MovedParameter{before.name, *share, leaves, change, before.unit};
  }
  return moved;
}

Told ChangeTold(const MachineKind& kind, const MovedParameter& moved) {
  if (ToldInPercent(kind, moved.name, moved.unit))
    return TellNumber(fmt::format("{:+.0f} %", 100 * moved.share));
  const DisplayUnit unit = ParameterUnit(kind, moved.name, moved.unit);
  const Told number = TellNumber(fmt::format("{:+.2g}", moved.change * unit.factor));
  return unit.name == "-" ? number : Tell("{} {}", "{} {}", number, UnitTold(unit.name));
}

}  // namespace hydroscope
