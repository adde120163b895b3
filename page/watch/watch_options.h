#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/result.h"
#include "core/told_error.h"

namespace hydroscope {

/// A trend database to look at.
struct WatchOptions {
  std::string database;      ///< "" = none
  std::string machine_file;  ///< beside which the rules file lies; "" = built-in rules
  std::string user;          ///< whose page it is, who may say who acts on alarms; "": who is logged in
  /// What the service that writes the database tells of itself (StatusJson); null: none runs.
  std::function<nlohmann::json()> service = [] { return nlohmann::json(); };
  /// Has that service ask the controller for a valve check of an axis, "press/cushion_1". Error: none runs, or it cannot.
  std::function<Status(const std::string& axis)> valve_check = [](const std::string&) -> Status {
    return BadInput(Told("no service runs that could ask the controller",
                         "es läuft kein Dienst, der die Steuerung fragen könnte"));
  };
};

}  // namespace hydroscope
