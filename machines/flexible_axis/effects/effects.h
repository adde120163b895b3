#pragma once

#include <memory>
#include <vector>

#include "models/effect.h"
#include "models/machine.h"

namespace hydroscope {

/// Effects of the flexible axis: one law, one file. To add one, write its file and a line here.
#define HYDROSCOPE_FLEXIBLE_AXIS_EFFECTS(_) \
  _(SupplyDrop)                             \
  _(SpoolZero)                              \
  _(SpoolOverlap)                           \
  _(WornEdges)                              \
  _(FreeAir)                                \
  _(SpringLoss)                             \
  _(LoadMass)                               \
  _(LoadFriction)                           \
  _(RetractionFriction)                     \
  _(LoadPositionZero)                       \
  _(PressureZero)                           \
  _(AccelerationZero)

namespace flexible_axis {
#define HYDROSCOPE_DECLARE_EFFECT(Name) Effect Name();
HYDROSCOPE_FLEXIBLE_AXIS_EFFECTS(HYDROSCOPE_DECLARE_EFFECT)
#undef HYDROSCOPE_DECLARE_EFFECT
}  // namespace flexible_axis

std::vector<std::shared_ptr<const Effect>> FlexibleAxisEffects(const Machine&);

}  // namespace hydroscope
