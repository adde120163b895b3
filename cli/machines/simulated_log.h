#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/finite_number.h"
#include "core/nearest_or_all.h"
#include "core/result.h"

namespace hydroscope {

/// Takes "NAME" (its typical size) or "NAME=SIZE" of an option --effect into the faults of a simulated machine. `all`: the table
/// of its faults, with `id`, `typical` and `size`, a pointer to the member of `Faults`.
template <typename Fault, typename Faults>
Status TakeFault(const std::string& text, const std::vector<Fault>& all, Faults& faults) {
  const auto equals = text.find('=');
  const std::string id = text.substr(0, equals);
  std::vector<std::string> known;
  for (const Fault& fault : all) {
    known.emplace_back(fault.id);
    if (id != fault.id) continue;
    const auto size =
        equals == std::string::npos ? std::optional(fault.typical) : FiniteNumber(text.substr(equals + 1));
    if (!size)
      return UsageError("--effect {}: expected NAME or NAME=NUMBER, e.g. {}={:g}", text, id, fault.typical);
    faults.*fault.size = *size;
    return {};
  }
  return UsageError("--effect {}: unknown effect '{}'; {}", text, id, NearestOrAll(id, known));
}

/// The lines of a help text: name, meaning.
template <typename Named>
std::string NameLines(const std::vector<Named>& all) {
  std::string text;
  for (const Named& one : all) text += fmt::format("  {:<22}{}\n", one.name, one.meaning);
  return text;
}

/// ... of faults, with the sizes --effect NAME gives them.
template <typename Fault>
std::string FaultLines(const std::vector<Fault>& all) {
  std::string text = "Effects, with sizes that are clearly visible:\n";
  for (const Fault& fault : all) {
    const std::string unit = std::string_view(fault.unit) == "1" ? "" : fmt::format(" {}", fault.unit);
    text += fmt::format("  {:<22}{} ({:g}{})\n", fault.id, fault.meaning, fault.typical, unit);
  }
  return text;
}

/// The faults set, as JSON.
template <typename Fault, typename Faults>
nlohmann::json FaultsJson(const std::vector<Fault>& all, const Faults& faults) {
  nlohmann::json set = nlohmann::json::array();
  for (const Fault& fault : all)
    if (faults.*fault.size != 0) set.push_back({{"id", fault.id}, {"size", faults.*fault.size}});
  return set;
}

/// Where the log of a simulated machine goes, and its truth.
struct SimulatedLogFiles {
  std::string out, truth;
};

/// --out and --truth.
void AddFiles(CLI::App& app, SimulatedLogFiles& files);

/// Errors: a file cannot be written.
Status WriteSimulated(const SimulatedLogFiles& files, std::string_view log, const nlohmann::json& truth);

}  // namespace hydroscope
