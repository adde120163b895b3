#include "live/valve_checks.h"

#include <chrono>
#include <cmath>
#include <limits>

#include "acquisition/modbus/settings.h"
#include "core/constants.h"
#include "estimation/frequency_response/frequency_response.h"
#include "live/log.h"
#include "models/machine_kind.h"
#include "storage/valve_check_words.h"

namespace hydroscope {
namespace {

constexpr double kPoll = 0.05;       ///< s
constexpr double kTail = 0.6;        ///< s after the end until all rows are aligned
constexpr double kAnswerTime = 3.0;  ///< s until a request must be answered
constexpr std::size_t kMostRows = 1'000'000;

double Mean(const SampleBlock& rows, int signal) {
  if (signal < 0) return kNaN;
  double sum = 0;
  std::int64_t count = 0;
  for (std::size_t k = 0; k < rows.rows(); ++k) {
    if (rows.quality[static_cast<std::size_t>(signal)][k] != quality::kGood) continue;
    sum += rows.signal[static_cast<std::size_t>(signal)][k];
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : kNaN;
}

/// Command and response, cut where a value is not good.
FrequencyRecord RecordOf(const SampleBlock& rows, const Machine& machine) {
  FrequencyRecord record;
  record.sample_period = machine.live->grid_period;
  record.shares = machine.IsShare(machine.valve.output);
  const auto in = static_cast<std::size_t>(machine.SignalIndex(machine.valve.input));
  const auto out = static_cast<std::size_t>(machine.SignalIndex(machine.valve.output));
  constexpr Quality kBad = quality::kMissing | quality::kGap | quality::kClockJump | quality::kOutOfRange;
  bool running = false;
  for (std::size_t k = 0; k < rows.rows(); ++k) {
    const bool good = ((rows.quality[in][k] | rows.quality[out][k]) & kBad) == 0;
    if (good && !running) record.runs.push_back({rows.time[k], {}, {}});
    running = good;
    if (!good) continue;
    record.runs.back().input.push_back(rows.signal[in][k] / machine.valve.full_scale);
    record.runs.back().output.push_back(rows.signal[out][k]);
  }
  return record;
}

}  // namespace

ValveCheckRecord JudgeSweep(const SampleBlock& rows, const Machine& machine, SweepStatus end, double begin,
                            double amplitude) {
  ValveCheckRecord record;
  ValveCheck& measured = record.check;
  measured.time = begin;
  measured.amplitude = amplitude;
  const auto ended = [&](const char* outcome, std::string_view detail) {
    record.outcome = outcome;
    record.detail = detail;
    return record;
  };
  if (end == SweepStatus::kBusy) return ended("refused", valve_check::kBusy);
  if (end == SweepStatus::kRefused) return ended("refused", valve_check::kNotAllowed);
  if (end == SweepStatus::kBroken) return ended("broken", valve_check::kBrokenOff);
  if (end != SweepStatus::kDone) return ended("no_answer", valve_check::kNoAnswer);
  measured.supply_pressure = Mean(rows, machine.SignalIndex(KindOf(machine).supply));
  measured.oil_temperature = Mean(rows, machine.SignalIndex(KindOf(machine).temperature));
  const auto response = MeasureFrequencyResponse(RecordOf(rows, machine));
  if (!response)
    return ended("unusable",
                 fmt::format("{}: {}", valve_check::kTellsNothing.english, response.error().text));
  const auto check = MakeValveCheck(*response, begin, measured.supply_pressure, measured.oil_temperature);
  if (!check)
    return ended("unusable",
                 fmt::format("{}: {}", valve_check::kNoModel.english, response->model_reason.english));
  measured = *check;
  const double recorded = static_cast<double>(rows.rows()) * machine.live->grid_period,
               harmonics = check->worst_distortion > kNotableDistortion ? check->worst_distortion : 0;
  return ended("measured", valve_check::Measured(response->points.size(), recorded, harmonics).english);
}

ValveChecks::ValveChecks(LiveService& service, const ValveCheckOptions& options, Clock clock)
    : service_(service), machine_(service.machine()), options_(options), clock_(std::move(clock)) {
  next_.assign(static_cast<std::size_t>(AxisCount(machine_)),
               clock_().monotonic_ns + std::llround(options_.period * 1e9));
  if (options_.period > 0) state_ = Tell("every {:.3g} h", "alle {:.3g} h", options_.period / 3600);
  service_.set_tap([this](int axis, const SampleBlock& block) { Record(axis, block); });
}

void ValveChecks::Start() {
  thread_ = std::thread([this] { Run(); });
}

void ValveChecks::Stop() {
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Status ValveChecks::Request(const std::string& axis) {
  const auto* modbus = machine_.Source<ModbusSpec>();
  if (modbus == nullptr || !modbus->sweep)
    return BadInput("the machine file has no [live.modbus] sweep, so the controller cannot be asked");
  for (int a = 0; a < AxisCount(machine_); ++a) {
    const std::string name = AxisMachineName(machine_, a);
    if (name != axis && !name.ends_with("/" + axis) && !(axis.empty() && AxisCount(machine_) == 1)) continue;
    std::lock_guard lock(mutex_);
    if (!wanted_.empty())
      return BadInput("a valve check is waiting or running already; see `hydroscope status`");
    wanted_.push_back(a);
    changed_.notify_all();
    return {};
  }
  return BadInput("the machine has no axis '{}'", axis);
}

Told ValveChecks::state() const {
  std::lock_guard lock(mutex_);
  return state_;
}

void ValveChecks::Note(const Told& state) {
  std::lock_guard lock(mutex_);
  state_ = state;
}

/// False when the checks are to end.
bool ValveChecks::Sleep(double seconds) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return stop_; });
}

std::optional<int> ValveChecks::NextAxis() {
  std::lock_guard lock(mutex_);
  if (!wanted_.empty()) return wanted_.front();
  if (options_.period <= 0) return std::nullopt;
  const std::int64_t now = clock_().monotonic_ns;
  for (std::size_t a = 0; a < next_.size(); ++a)
    if (now >= next_[a]) return static_cast<int>(a);
  return std::nullopt;
}

void ValveChecks::Run() {
  while (Sleep(0.2))
    if (const auto axis = NextAxis()) Check(*axis);
}

void ValveChecks::Check(int axis) {
  const std::string name = AxisMachineName(machine_, axis);
  double begin = static_cast<double>(clock_().wall_ns) * 1e-9;
  Note(Tell("{}: asked", "{}: angefragt", name));
  const SweepStatus end = Ask(axis, begin);
  Sleep(kTail);
  SampleBlock rows;
  {
    std::lock_guard lock(mutex_);
    recording_ = -1;
    rows = std::exchange(rows_, {});
  }
  ValveCheckRecord record = JudgeSweep(rows, machine_, end, begin, options_.amplitude);
  if (record.outcome == "no_answer" && !problem_.empty()) record.detail += ": " + problem_;
  LogInfo("valve_check", {{"axis", name}, {"outcome", record.outcome}, {"detail", record.detail}});
  Note(Tell("{}: {}", "{}: {}", name, valve_check::ToldOf(record.detail)));
  service_.AddValveCheck(axis, std::move(record));
  std::lock_guard lock(mutex_);
  const double pause = end == SweepStatus::kBusy ? options_.busy_retry : options_.period;
  next_[static_cast<std::size_t>(axis)] = clock_().monotonic_ns + std::llround(pause * 1e9);
  if (!wanted_.empty() && wanted_.front() == axis) wanted_.pop_front();
}

/// Asks and follows the controller's word until it is final; kUndecided: it gave none.
SweepStatus ValveChecks::Ask(int axis, double& begin) {
  problem_ = "the machine file has no [live.modbus] sweep";
  const auto* modbus = machine_.Source<ModbusSpec>();
  if (modbus == nullptr || !modbus->sweep) return SweepStatus::kUndecided;
  ValveRequest request(*modbus);
  {
    std::lock_guard lock(mutex_);
    recording_ = axis;
    rows_.Resize(machine_.signals.size(), 0);
  }
  begin = static_cast<double>(clock_().wall_ns) * 1e-9;
  if (const Status asked = request.Ask(axis, options_.amplitude); !asked) {
    problem_ = asked.error().text;
    return SweepStatus::kUndecided;
  }
  problem_ = "its status register did not change";
  bool decided = false;
  for (double waited = 0; waited < options_.patience && Sleep(kPoll); waited += kPoll) {
    const auto status = request.Poll();
    if (!status) {
      problem_ = status.error().text;
      continue;
    }
    if (IsFinal(*status)) return *status;
    if (*status != SweepStatus::kUndecided && !decided) {
      decided = true;
      problem_ = "it began the sweep and never told its end";
      Note(Tell("{}: sweep running", "{}: Sweep läuft", AxisMachineName(machine_, axis)));
    }
    if (!decided && waited > kAnswerTime) break;
  }
  return SweepStatus::kUndecided;
}

int ValveChecks::checking() const {
  std::lock_guard lock(mutex_);
  return recording_;
}

void ValveChecks::Record(int axis, const SampleBlock& block) {
  std::lock_guard lock(mutex_);
  if (axis != recording_ || rows_.rows() + block.rows() > kMostRows) return;
  const std::size_t from = rows_.rows();
  rows_.Resize(block.signal.size(), from + block.rows());
  const auto at = static_cast<std::ptrdiff_t>(from);
  std::copy(block.time.begin(), block.time.end(), rows_.time.begin() + at);
  for (std::size_t s = 0; s < block.signal.size(); ++s) {
    std::copy(block.signal[s].begin(), block.signal[s].end(), rows_.signal[s].begin() + at);
    std::copy(block.quality[s].begin(), block.quality[s].end(), rows_.quality[s].begin() + at);
  }
}

}  // namespace hydroscope
