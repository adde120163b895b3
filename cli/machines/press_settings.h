#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/result.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope {

/// "relief_valve=2e-11,crack=170e5": id, size and further numbers; the size may be left out for a typical one.
Result<EffectSetting> ParseEffect(const std::string& text);

/// "coloured_noise=0.1,phi=0.8,on=p_A": kind, size, further numbers and channel; the size may be left out for
/// a typical one.
Result<ImperfectionSetting> ParseImperfection(const std::string& text);

/// "kind:channel:start:duration[:size]", kind nan, stuck, spike, dropout, offset_drift or clock_jump;
/// seconds, size in SI.
Result<SensorFault> ParseFault(const std::string& text);

/// "26:52" or "40": oil temperature in degC at start and end, into K.
Status ParseOil(const std::string& text, PressOptions& options);

/// Takes A_A, dp_nom, p_t and, where given, K, V0, Q_vn, y_0 from a machine file.
Status TakeMachine(const std::string& path, PressOptions& options);

/// Steps of converters of `bits` bits over usual sensor ranges.
SensorQuantum QuantumOfBits(int bits);

/// True parameters, effects, imperfections and strokes, SI.
nlohmann::json TruthJson(const PressTruth& truth);

/// Table of the effects with unit, typical size, law and further numbers.
std::string EffectTable();

/// Table of the imperfections with unit, typical size, law, further numbers and channel.
std::string ImperfectionTable();

}  // namespace hydroscope
