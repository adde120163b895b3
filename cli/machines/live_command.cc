#include "cli/machines/live_command.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include "cli/machines/press_settings.h"
#include "core/contains.h"
#include "core/finite_number.h"

namespace hydroscope {
namespace {

constexpr double kLongestJump = 1e9;  // s, 32 years: times in ns stay whole numbers

/// "name=value" words behind the first ones.
using Options = std::map<std::string, double>;

Result<Options> ReadOptions(const std::vector<std::string>& words, std::size_t first,
                            const std::vector<std::string>& known) {
  Options options;
  for (std::size_t k = first; k < words.size(); ++k) {
    const auto equals = words[k].find('=');
    const std::string name = words[k].substr(0, equals);
    const auto value = equals == std::string::npos ? std::nullopt : FiniteNumber(words[k].substr(equals + 1));
    if (!value || !Contains(known, name))
      return UsageError("'{}' is not understood; expected {}=NUMBER", words[k],
                        fmt::join(known, "=NUMBER or "));
    options[name] = *value;
  }
  return options;
}

Result<int> AxisOf(const Options& options) {
  const auto found = options.find("axis");
  if (found == options.end()) return -1;
  if (found->second != std::floor(found->second) || found->second < 1 || found->second > 64)
    return UsageError("axis={}; expected a whole number from 1 on", found->second);
  return static_cast<int>(found->second) - 1;
}

Result<LiveCommand> EffectLine(const std::vector<std::string>& words) {
  auto effect = TRY(ParseEffect(words[1]));
  const auto options = TRY(ReadOptions(words, 2, {"axis", "ramp"}));
  const auto axis = TRY(AxisOf(options));
  const double ramp = options.contains("ramp") ? options.at("ramp") : 0;
  return ChangeEffectCommand{std::move(effect), axis, ramp};
}

Result<LiveCommand> FaultLine(const std::vector<std::string>& words) {
  auto fault = TRY(ParseFault(words[1]));
  const auto options = TRY(ReadOptions(words, 2, {"axis"}));
  const auto axis = TRY(AxisOf(options));
  return AddFaultCommand{std::move(fault), axis};
}

Result<LiveCommand> ModbusLine(const std::string& word) {
  if (word == "on") return ModbusFaultCommand{ModbusFault::kNone, 0};
  if (word == "hang") return ModbusFaultCommand{ModbusFault::kHang, 0};
  if (word == "garbage") return ModbusFaultCommand{ModbusFault::kGarbage, 0};
  if (word.starts_with("late="))
    if (const auto delay = FiniteNumber(word.substr(5)); delay && *delay >= 0 && *delay <= 60)
      return ModbusFaultCommand{ModbusFault::kLate, *delay};
  return UsageError("modbus {}: expected modbus hang, garbage, late=SECONDS (0 to 60) or on", word);
}

}  // namespace

Result<LiveCommand> ParseLiveCommand(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  if (words.empty()) return UsageError("an empty line; expected one of\n{}", LiveCommandHelp());
  const std::string& what = words[0];
  if (words.size() == 1) {
    if (what == "pause" || what == "run") return PauseCommand{what == "pause"};
    if (what == "freeze" || what == "thaw") return FreezeCommand{what == "freeze"};
    if (what == "quit") return QuitCommand{};
  } else if (what == "effect") {
    return EffectLine(words);
  } else if (what == "fault") {
    return FaultLine(words);
  } else if (words.size() == 2 && what == "modbus") {
    return ModbusLine(words[1]);
  } else if (words.size() == 2 && what == "dds") {
    if (words[1] == "mute" || words[1] == "on") return MuteCommand{words[1] == "mute"};
  } else if (words.size() == 2 && what == "clock") {
    if (const auto jump = FiniteNumber(words[1]); jump && std::abs(*jump) < kLongestJump)
      return ClockCommand{*jump};
  }
  return UsageError("'{}' is not understood; expected one of\n{}", line, LiveCommandHelp());
}

std::string LiveCommandHelp() {
  return "  effect ID[=SIZE][,NAME=VALUE...] [axis=N] [ramp=S]   an effect, in full after S seconds\n"
         "  fault KIND:CHANNEL:IN:DURATION[:SIZE] [axis=N]       a sensor fault, in IN seconds\n"
         "  pause | run                                          rest at the top, or go on working\n"
         "  freeze | thaw                                        no new samples, or again\n"
         "  dds mute | dds on                                    stop publishing, or go on\n"
         "  modbus hang | garbage | late=S | on                  no answers, "
         "nonsense, late answers, or sound ones\n"
         "  clock S                                              the clock of the press jumps by S seconds\n"
         "  quit";
}

}  // namespace hydroscope
