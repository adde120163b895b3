#include <algorithm>

#include "models/effects/effects.h"

namespace hydroscope {

EffectShape PlainShape(int column, std::vector<double> nonlinear) {
  return {{column}, [](const ShapeContext&) { return std::vector<double>{1.0}; }, std::move(nonlinear)};
}

std::vector<std::shared_ptr<const Effect>> DieCushionEffects(const CushionGeometry& geometry) {
  using namespace effects;
  std::vector<std::shared_ptr<const Effect>> library;
  for (auto make : {InternalLeakage, ExternalLeakage, OrificeLeakage, EntrainedAir, Accumulator, ReliefValve,
                    TankBackPressure, ValveFlowCurvature, ValveFlowAsymmetry, SpoolOverlap, SpoolHysteresis,
                    OilViscosity, PressureOffset, SpoolSignalDelay, PressureSignalDelay, PositionSignalDelay,
                    PositionDependentLeakage, LineInertance})
    library.push_back(std::make_shared<const Effect>(make(geometry)));
  return library;
}

void AddLibrary(std::vector<std::shared_ptr<const Effect>> effects, ModelStructure& model) {
  for (auto& effect : effects) {
    const bool measured = std::all_of(effect->channels.begin(), effect->channels.end(),
                                      [&](int channel) { return model.channel_source[channel] >= 0; });
    if (!measured) continue;
    model.effect_first_column.push_back(model.column_count());
    model.columns.insert(model.columns.end(), effect->columns.begin(), effect->columns.end());
    model.effects.push_back(std::move(effect));
  }
}

}  // namespace hydroscope
