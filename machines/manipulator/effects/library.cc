#include <algorithm>

#include "machines/manipulator/effects/effects.h"
#include "machines/manipulator/parameters.h"
#include "models/machine.h"

namespace hydroscope::manipulator {

std::vector<std::shared_ptr<const Effect>> Effects(const Machine& machine) {
  std::vector<std::shared_ptr<const Effect>> library;
  const auto add = [&](Effect effect) {
    library.push_back(std::make_shared<const Effect>(std::move(effect)));
  };
  const bool rigid_known = std::all_of(kRigid.begin(), kRigid.end(),
                                       [&](const char* name) { return machine.Geometry(name).has_value(); });
  if (rigid_known && machine.Geometry("a_2")) add(Payload());
  for (const int joint : {1, 2}) {
    add(StribeckFriction(joint));
    for (const char* edge : kEdges) add(WornEdge(edge, joint));
    add(JointPlay(joint));
  }
  return library;
}

}  // namespace hydroscope::manipulator
