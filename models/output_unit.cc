#include "models/output_unit.h"

#include <string_view>

#include "models/machine_kind.h"

namespace hydroscope {

DisplayUnit OutputUnit(const ModelStructure* model) {
  DisplayUnit unit = DisplayUnitFor(model == nullptr ? std::string_view("m3/s") : model->output_unit);
  unit.offset = 0;  // errors are differences
  return unit;
}

DisplayUnit OutputUnit(const Machine& machine) {
  DisplayUnit unit = DisplayUnitFor(OutputSi(machine));
  unit.offset = 0;
  return unit;
}

}  // namespace hydroscope
