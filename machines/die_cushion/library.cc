#include "machines/die_cushion/library.h"

#include "machines/die_cushion/effects/effects.h"

namespace hydroscope {

CushionGeometry CushionGeometryOf(const Machine& machine) {
  CushionGeometry geometry;
  geometry.piston_area = machine.Geometry("A_A").value_or(KnownValue{}).value;
  geometry.tank_pressure = machine.Geometry("p_t").value_or(KnownValue{}).value;
  geometry.stroke = machine.Geometry("stroke").value_or(KnownValue{geometry.stroke, 0}).value;
  return geometry;
}

std::vector<std::shared_ptr<const Effect>> DieCushionEffects(const CushionGeometry& geometry) {
  using namespace effects;
  std::vector<std::shared_ptr<const Effect>> library;
#define HYDROSCOPE_LIST_EFFECT(Name) Name,
  for (const auto make : {HYDROSCOPE_STORED_EFFECTS(HYDROSCOPE_LIST_EFFECT)})
    library.push_back(std::make_shared<const Effect>(make(geometry)));
  for (const auto make : {HYDROSCOPE_SAMPLE_EFFECTS(HYDROSCOPE_LIST_EFFECT)}) {
    Effect effect = make(geometry);
    effect.needs_samples = true;
    library.push_back(std::make_shared<const Effect>(std::move(effect)));
  }
#undef HYDROSCOPE_LIST_EFFECT
  return library;
}

}  // namespace hydroscope
