#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace hydroscope {

/// A trend database to look at.
struct WatchOptions {
  std::string database;      ///< "" = none
  std::string machine_file;  ///< beside which the rules file lies; "" = built-in rules
  std::string user;          ///< who acts on alarms where the page names nobody
  /// What the service that writes the database tells of itself (StatusJson); null: none runs.
  std::function<nlohmann::json()> service = [] { return nlohmann::json(); };
};

}  // namespace hydroscope
