#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace hydroscope {

/// A trend database to look at.
struct WatchOptions {
  std::string database;      ///< "" = none
  std::string machine_file;  ///< beside which the rules file lies; "" = built-in rules
  std::string user;          ///< whose page it is, who may say who acts on alarms; "": who is logged in
  /// What the service that writes the database tells of itself (StatusJson); null: none runs.
  std::function<nlohmann::json()> service = [] { return nlohmann::json(); };
};

}  // namespace hydroscope
