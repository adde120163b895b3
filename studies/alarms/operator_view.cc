#include "studies/alarms/operator_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "acquisition/modbus/link.h"
#include "alarms/feeds/modbus/register_map.h"

namespace hydroscope {
namespace {

constexpr double kBetweenLooks = 0.05;  // s
constexpr double kAcknowledged = 3;     // s until all are, at most
constexpr char kAxis[] = "cushion_1";
constexpr std::uint16_t kFailure = 4;  // health F, docs/register_map.md

std::string ReadFrom(const std::string& path, std::size_t from) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(from));
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

std::string Sighting::Text() const {
  std::string text;
  for (const auto& [place, seconds] : {std::pair("log", log),
                                       {"status", status},
                                       {"registers", registers},
                                       {"Sparkplug", sparkplug},
                                       {"DDS", dds}})
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", place,
                        seconds ? fmt::format("{:.1f} s", *seconds) : std::string("never"));
  return text;
}

std::string OperatorView::Feeds(const std::string& broker, int domain, int port) {
  return fmt::format(
      "\n[feeds.modbus]\nport = {}\n\n[feeds.sparkplug]\nbroker = \"{}\"\n\n"
      "[feeds.dds]\ndomain = {}\ntopic = \"{}\"\ntransport = \"udp\"\n",
      port, broker, domain, AlarmListener::kTopic);
}

void OperatorView::AcknowledgeAll() const {
  ModbusLink link("127.0.0.1", port_, 1, 0.5);
  const std::uint16_t alarms = Register(register_map::kAlarms).value_or(0);
  if (link.Connect() != LinkOutcome::kDone) return;
  for (std::uint16_t number = 1; number <= alarms; ++number)
    static_cast<void>(link.WriteRegister(register_map::kAcknowledge, number));
  for (const double end = Now() + kAcknowledged; Now() < end && Register(register_map::kUnacknowledged) != 0;)
    Sleep(kBetweenLooks);
}

void OperatorView::Mark() {
  AcknowledgeAll();
  begun_ = Now();
  logged_ = ReadFrom(rig_.File("serve.log"), 0).size();
  told_ = broker_.told().size();
  heard_ = dds_.rows().size();
  unacknowledged_ = Register(register_map::kUnacknowledged).value_or(0);
}

bool OperatorView::Logged(const std::string& words) const {
  return !words.empty() && ReadFrom(rig_.File("serve.log"), logged_).find(words) != std::string::npos;
}

std::optional<std::uint16_t> OperatorView::Register(int number) const {
  ModbusLink link("127.0.0.1", port_, 1, 0.5);
  std::array<std::uint16_t, 1> word{};
  if (link.Connect() != LinkOutcome::kDone || link.Read(number, word) != LinkOutcome::kDone)
    return std::nullopt;
  return word[0];
}

bool OperatorView::StatusTells(const FaultSign& sign) const {
  const auto status = rig_.Ask();
  if (!status) return false;
  for (const auto& axis : status->at("drift").at("axes")) {
    if (axis.at("health") == "F") return true;
    for (const auto& alarm : axis.at("alarms"))
      if (!sign.alarm.empty() && alarm.get<std::string>().ends_with(" " + sign.alarm)) return true;
  }
  return false;
}

bool OperatorView::RegistersTell() const {
  return Register(register_map::kFirstAxis + register_map::kHealth) == kFailure ||
         Register(register_map::kUnacknowledged).value_or(0) > unacknowledged_;
}

bool OperatorView::SparkplugTells(const FaultSign& sign) const {
  if (broker_.HealthOf(kAxis) == "F") return true;
  const auto rows = broker_.told();
  return std::any_of(rows.begin() + static_cast<std::ptrdiff_t>(std::min(told_, rows.size())), rows.end(),
                     [&](const auto& row) { return row.alarm == sign.alarm; });
}

bool OperatorView::DdsTells(const FaultSign& sign) const {
  if (dds_.HealthOf(fmt::format("press/{}", kAxis)) == 'F') return true;
  const auto rows = dds_.rows();
  return std::any_of(rows.begin() + static_cast<std::ptrdiff_t>(std::min(heard_, rows.size())), rows.end(),
                     [&](const auto& row) { return row.alarm == sign.alarm; });
}

Sighting OperatorView::Watch(const FaultSign& sign, double patience) const {
  Sighting seen;
  const auto look = [&](std::optional<double>& at, auto&& tells) {
    if (!at && tells()) at = Now() - begun_;
  };
  while (!seen.everywhere() && Now() - begun_ < patience) {
    look(seen.log, [&] { return Logged(sign.log); });
    look(seen.status, [&] { return StatusTells(sign); });
    look(seen.registers, [&] { return RegistersTell(); });
    look(seen.sparkplug, [&] { return SparkplugTells(sign); });
    look(seen.dds, [&] { return DdsTells(sign); });
    Sleep(kBetweenLooks);
  }
  return seen;
}

std::optional<double> OperatorView::WaitForHealth(double patience) const {
  const double begin = Now();
  const auto fails = [&] {
    const auto status = rig_.Ask();
    if (!status || broker_.HealthOf(kAxis) == "F" || dds_.HealthOf(fmt::format("press/{}", kAxis)) == 'F' ||
        Register(register_map::kFirstAxis + register_map::kHealth).value_or(kFailure) == kFailure)
      return true;
    const auto& axes = status->at("drift").at("axes");
    return std::ranges::any_of(axes, [](const auto& axis) { return axis.at("health") == "F"; });
  };
  while (Now() - begin < patience) {
    if (!fails()) return Now() - begin;
    Sleep(kBetweenLooks);
  }
  return std::nullopt;
}

}  // namespace hydroscope
