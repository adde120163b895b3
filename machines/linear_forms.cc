#include "machines/manipulator/equations.h"
#include "machines/manipulator/kind.h"

namespace hydroscope {

LinearForm LinearFormOf(const Machine& machine) {
  if (&KindOf(machine) == &kManipulator) return manipulator::Linear(machine);
  return {};
}

}  // namespace hydroscope
