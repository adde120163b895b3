#pragma once

#include "models/machine_kind.h"

// How kinds of machines write their signals, known values and parameters; what is special is a MachineInput with its fields by name.
namespace hydroscope {

/// A signal without which nothing can be identified; `columns`: what logs call it (MachineInput::columns).
constexpr MachineInput Measured(std::string_view name, std::string_view si, Wording meaning,
                                std::string_view columns, std::optional<PlausibleSize> size = {}) {
  return {.name = name, .si = si, .required = true, .meaning = meaning, .size = size, .columns = columns};
}
constexpr MachineInput Measured(std::string_view name, std::string_view si, Wording meaning,
                                std::optional<PlausibleSize> size = {}) {
  return Measured(name, si, meaning, "", size);
}

/// A signal that some effects need, or that makes the rest surer.
constexpr MachineInput MayBeMeasured(std::string_view name, std::string_view si, Wording meaning,
                                     std::string_view columns, std::optional<PlausibleSize> size = {}) {
  MachineInput input = Measured(name, si, meaning, columns, size);
  input.required = false;
  return input;
}
constexpr MachineInput MayBeMeasured(std::string_view name, std::string_view si, Wording meaning,
                                     std::optional<PlausibleSize> size = {}) {
  return MayBeMeasured(name, si, meaning, "", size);
}

/// A positive value that the machine file must state, SI between `lowest` and `highest`; `unit` for messages, "" = `si`.
constexpr MachineInput Known(std::string_view name, std::string_view si, Wording meaning, double lowest,
                             double highest, std::string_view unit = "") {
  return {.name = name,
          .si = si,
          .required = true,
          .meaning = meaning,
          .positive = true,
          .lowest = lowest,
          .highest = highest,
          .unit = unit.empty() ? si : unit};
}

/// A positive value, SI, that the machine file may state otherwise.
constexpr MachineInput Assumed(std::string_view name, std::string_view si, Wording meaning,
                               double otherwise) {
  return {.name = name,
          .si = si,
          .required = false,
          .meaning = meaning,
          .positive = true,
          .otherwise = otherwise};
}

/// A parameter that is identified; `symbol` for plots, "" = the name. Plots show it in `shown` = SI * `factor` where the usual
/// unit of `si` does not do.
constexpr MachineParameter Identified(std::string_view name, std::string_view si, Wording meaning,
                                      Wording sentence, std::string_view symbol = "",
                                      std::string_view shown = "", double factor = 1) {
  return {.name = name,
          .si = si,
          .meaning = meaning,
          .symbol = symbol,
          .sentence = sentence,
          .shown = shown,
          .factor = factor};
}

/// A parameter that depends on the oil in this way.
constexpr MachineParameter OverOil(OilLaw law, MachineParameter parameter) {
  parameter.over_oil = law;
  return parameter;
}

/// What the data sheet of its part states, known value `stated_as` of the machine.
constexpr MachineParameter StatedAs(std::string_view stated_as, MachineParameter parameter) {
  parameter.stated_as = stated_as;
  return parameter;
}

/// Beside the atmosphere, which it is taken for where the machine file does not state it.
constexpr MachineInput TankPressure() {
  return {.name = "p_t",
          .si = "Pa",
          .required = false,
          .meaning = {"tank pressure", "Tankdruck"},
          .lowest = -1e5,
          .highest = 50e5,
          .unit = "bar",
          .otherwise = 0.0};
}

}  // namespace hydroscope
