#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/told.h"
#include "diagnosis/drift/cumulative_sum.h"

namespace hydroscope::drift {

/// What a rule asks of a quantity.
enum class Movement { kUp, kDown, kAny };

/// Size of a change in the rules file: a share of the healthy value, or absolute.
struct ChangeSpec {
  double value = 0;  ///< SI, or share
  bool relative = true;
};

struct WatchSpec {
  std::string quantity;  ///< parameter of the model, id of an effect, or figure of a valve check
  ChangeSpec smallest{0.05, true};
  ChangeSpec alarm{0.2, true};
  bool only_upwards = false;

  /// Absolute sizes for a healthy value of `typical`, SI.
  DriftSize Sizes(double typical) const;
};

enum class RuleSeverity { kAdvisory, kWarning, kAlarm };

/// A pattern of movements, what it is called and what to do about it. The name says what was measured; a
/// cause is told by comparing strokes alone (AlarmCause).
struct Rule {
  std::string id;                        ///< "entrained_air"
  Told name;                             ///< "Oil column softer"
  Told guidance;                         ///< for the person at the machine
  std::map<std::string, Movement> when;  ///< all of these have moved so ...
  std::vector<std::string> may;          ///< ... these may have moved, others not
  RuleSeverity severity = RuleSeverity::kWarning;
  int axes = 1;     ///< axes of the machine that moved so at the same time
  int within = 50;  ///< strokes that count as the same time

  /// Whether the movements (+1, -1) fit.
  bool Matches(const std::map<std::string, int>& moved) const;
};

struct RuleBook {
  std::string file;                      ///< that it was read from; "" = built in
  int commissioning = 1500;              ///< strokes the reference is learned from
  bool automatic = true;                 ///< freeze the reference by itself after `commissioning` strokes
  double minimum_temperature = 298.15;   ///< K, oil colder is not judged
  int warn_delay = 5, clear_delay = 30;  ///< strokes
  double deadband = 2;                   ///< standard deviations
  std::vector<WatchSpec> watches;
  std::vector<Rule> rules;

  const WatchSpec* Find(const std::string& quantity) const;
  /// The rule with most conditions that matches movements on `axes` axes; nullptr if none does.
  const Rule* Match(const std::map<std::string, int>& moved, int axes = 1) const;
};

/// One section of a rules file with the keys it may hold; docs/drift.md describes every one (a test compares).
struct RuleSection {
  std::string name;
  std::vector<std::string> keys;
};
const std::vector<RuleSection>& RuleFileSections();

/// Reads a rules file. Errors name file, line, key, value and what was expected; an unknown key suggests the nearest.
Result<RuleBook> LoadRules(const std::string& path);
Result<RuleBook> ParseRules(const std::string& text, const std::string& origin);
/// The rules of machines/die_cushion_rules.toml as they were when the program was built.
const RuleBook& DefaultRules();

}  // namespace hydroscope::drift
