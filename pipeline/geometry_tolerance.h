#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/records/estimate_statement.h"
#include "models/machine.h"
#include "models/model_structure.h"

namespace hydroscope {

/// Standard uncertainty of an area whose tolerance the machine file does not state, as a share of it: bores
/// and rods of cylinders are made to H8/f7 and wear; 0.1 mm on a diameter of 100 mm is 0.2 % of the area, two
/// such diameters and their rounding in a data sheet 0.5 %.
inline constexpr double kAreaTolerance = 0.005;

/// A tolerance that was assumed for want of a stated one.
struct AssumedTolerance {
  std::string name;            ///< of [geometry]
  std::string_view shared_by;  ///< MachineInput::shared_by
  double std = 0;              ///< SI
};

/// Gives areas of the model without `std` (or with 0, which no area has) the standard uncertainty
/// kAreaTolerance and says which. For what is stated of a parameter by itself, of a log or of a database. What all
/// strokes share is no change: whoever compares strokes with one another, the drift watch first, leaves it out.
std::vector<AssumedTolerance> AssumeTolerances(Machine& machine);

/// What the assumed tolerances add to the intervals of the parameters of `model`, that of `machine`: one for each parameter.
std::vector<EstimateStatement> ToleranceStatements(const Machine& machine, const ModelStructure& model);

/// "A_A has no tolerance in the machine file: 0.5 % assumed, which V0 and Q_vn share in proportion".
std::string AssumedText(const AssumedTolerance& assumed);

}  // namespace hydroscope
