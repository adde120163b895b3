#include "workbench/frequency_response/frf_record.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/records/quality.h"
#include "core/told_error.h"
#include "host/output.h"
#include "models/machine_kind.h"
#include "pipeline/log_faults/declared_range.h"
#include "pipeline/raw_log.h"
#include "replay/log_reader.h"

namespace hydroscope {
namespace {

constexpr Quality kUnusable =
    quality::kMissing | quality::kOutOfRange | quality::kDuplicate | quality::kTimeBackwards;
constexpr Quality kNewRun = quality::kGap | quality::kClockJump;
constexpr std::size_t kRowsAtOnce = 4096;
/// Over which a reading must repeat before it stands, however short the machine file's time.
constexpr std::size_t kStuckRows = 20;

/// Mean of a slow signal over its good values.
class Mean {
 public:
  explicit Mean(int index) : index_(index) {}
  void Add(const SampleBlock& block) {
    if (index_ < 0) return;
    for (std::size_t n = 0; n < block.rows(); ++n) {
      if (block.quality[index_][n] & kUnusable) continue;
      sum_ += block.signal[index_][n];
      ++count_;
    }
  }
  double value() const { return count_ > 0 ? sum_ / count_ : std::numeric_limits<double>::quiet_NaN(); }

 private:
  int index_;
  double sum_ = 0;
  double count_ = 0;
};

/// Cuts rows into runs without a gap.
class RunBuilder {
 public:
  RunBuilder(const Machine& machine, const FrfSignals& signals, FrfRecord& result)
      : input_(machine.SignalIndex(signals.input)),
        output_(machine.SignalIndex(signals.output)),
        set_point_(machine.SignalIndex(signals.set_point)),
        unusable_(set_point_ < 0 ? kUnusable : kUnusable | quality::kStuck),
        full_scale_(signals.full_scale),
        result_(result) {}

  void Add(const SampleBlock& block) {
    for (std::size_t n = 0; n < block.rows(); ++n) {
      Quality flags = block.quality[input_][n] | block.quality[output_][n];
      if (set_point_ >= 0) flags |= block.quality[set_point_][n];
      if (flags & kNewRun) open_ = false;
      if (flags & unusable_) {
        Count(flags);
        // A row that came twice tears no hole; any other lost row does.
        if (!(flags & quality::kDuplicate)) open_ = false;
        continue;
      }
      if (!open_) result_.record.runs.push_back({block.time[n], {}, {}, {}});
      open_ = true;
      SignalRun& run = result_.record.runs.back();
      run.input.push_back(block.signal[input_][n] / full_scale_);
      run.output.push_back(block.signal[output_][n]);
      if (set_point_ >= 0) run.set_point.push_back(block.signal[set_point_][n]);
    }
    result_.rows += static_cast<std::int64_t>(block.rows());
  }

  /// Leaves out where the output of a closed loop stands for longer than `stuck_time` (s) while its set point moves. The monitor
  /// judges noisy sensors only, and a rod that is driven all the time moves without noise.
  void LeaveOutStanding(double stuck_time) {
    const auto least =
        std::max(kStuckRows, static_cast<std::size_t>(stuck_time / result_.record.sample_period));
    std::vector<SignalRun> runs;
    for (SignalRun& run : result_.record.runs) {
      std::size_t begin = 0;
      const auto keep = [&](std::size_t end) {
        if (end > begin) runs.push_back(Part(run, begin, end));
      };
      for (std::size_t from = 0, to = 0; from < run.output.size(); from = to) {
        for (to = from + 1; to < run.output.size() && run.output[to] == run.output[from];) ++to;
        const auto at = [&](std::size_t row) {
          return run.set_point.begin() + static_cast<std::ptrdiff_t>(row);
        };
        if (to - from <= least || std::all_of(at(from), at(to), [&](double r) { return r == *at(from); }))
          continue;
        keep(from);
        begin = to;
        result_.left_out += static_cast<std::int64_t>(to - from);
        for (std::size_t i = 0; i < quality::kFlagNames.size(); ++i)
          if (quality::kFlagNames[i].flag == quality::kStuck)
            counts_[i] += static_cast<std::int64_t>(to - from);
      }
      keep(run.output.size());
    }
    result_.record.runs = std::move(runs);
  }

  void Finish() {
    for (std::size_t i = 0; i < quality::kFlagNames.size(); ++i) {
      if (counts_[i] == 0) continue;
      if (!result_.left_out_why.empty()) result_.left_out_why += ", ";
      result_.left_out_why += fmt::format("{} {}", quality::kFlagNames[i].name, counts_[i]);
    }
  }

 private:
  SignalRun Part(const SignalRun& run, std::size_t begin, std::size_t end) const {
    const auto part = [&](const std::vector<double>& values) {
      return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(begin),
                                 values.begin() + static_cast<std::ptrdiff_t>(end));
    };
    return {run.start + static_cast<double>(begin) * result_.record.sample_period, part(run.input),
            part(run.output), part(run.set_point)};
  }

  void Count(Quality flags) {
    ++result_.left_out;
    for (std::size_t i = 0; i < quality::kFlagNames.size(); ++i) {
      if (flags & unusable_ & quality::kFlagNames[i].flag) ++counts_[i];
    }
  }

  int input_, output_, set_point_;  // set_point_ < 0: none
  Quality unusable_;                // of a closed loop also a sensor that stands
  double full_scale_;
  FrfRecord& result_;
  bool open_ = false;
  std::array<std::int64_t, quality::kFlagNames.size()> counts_{};
};

Status CheckValveSignals(const Machine& machine) {
  for (const std::string& name : {machine.valve.input, machine.valve.output}) {
    if (machine.SignalIndex(name) < 0) {
      return BadInput(Tell(
          "machine '{}': frf measures a valve, from its command to its spool, and there is no signal {} for it; "
          "[valve] input and output say which signals of [signals] the two are",
          "Maschine '{}': frf misst ein Ventil, von seinem Befehl zu seinem Schieber, und ein Signal {} dafür gibt es nicht; "
          "[valve] input und output sagen, welche Signale aus [signals] das sind",
          machine.name, name));
    }
  }
  if (machine.valve.full_scale == 0 || !std::isfinite(machine.valve.full_scale)) {
    return BadInput(Tell("machine '{}': [valve] full_scale is {}, the command at full stroke is needed",
                         "Maschine '{}': [valve] full_scale ist {}, nötig ist der Befehl bei vollem Hub",
                         machine.name, machine.valve.full_scale));
  }
  return {};
}

/// The machine reduced to what the check needs: other signals are optional, all but what a closed loop moves may stand still.
Machine ForFrequencyResponse(Machine machine, const FrfSignals& signals) {
  for (SignalSpec& signal : machine.signals) {
    signal.required =
        signal.name == signals.input || signal.name == signals.output || signal.name == signals.set_point;
    const bool moved = signal.name == signals.output && !signals.set_point.empty();
    if (signal.required && !moved) signal.stuck_time = 0;
  }
  return machine;
}

}  // namespace

Result<FrfRecord> ReadValveRecord(const std::string& path, const Machine& machine) {
  TRY(CheckValveSignals(machine));
  auto record =
      ReadFrfRecord(path, machine, {machine.valve.input, machine.valve.output, machine.valve.full_scale});
  if (record) record->record.shares = machine.IsShare(machine.valve.output);
  return record;
}

Result<FrfRecord> ReadFrfRecord(const std::string& path, const Machine& machine, const FrfSignals& signals) {
  auto reader = TRY(OpenRecording(path, ForFrequencyResponse(machine, signals)));
  FrfRecord result;
  result.record.sample_period = reader->SamplePeriod();
  RunBuilder runs(machine, signals, result);
  Mean pressure(machine.SignalIndex(KindOf(machine).supply)),
      oil(machine.SignalIndex(KindOf(machine).temperature));
  DeclaredRanges declared(machine);
  ProgressBar progress("reading", "rows");
  SampleBlock block;
  while (true) {
    const auto rows = TRY(reader->Read(block, kRowsAtOnce));
    if (rows == 0) break;
    runs.Add(block);
    pressure.Add(block);
    oil.Add(block);
    declared.Observe(block);
    progress.Update(reader->Progress(), result.rows);
  }
  if (const double stuck_time = machine.signals[machine.SignalIndex(signals.output)].stuck_time;
      !signals.set_point.empty() && stuck_time > 0)
    runs.LeaveOutStanding(stuck_time);
  runs.Finish();
  if (const std::int64_t rejected = reader->counters().rejected_rows; rejected > 0) {
    result.left_out += rejected;
    result.left_out_why += fmt::format("{}unreadable {}", result.left_out_why.empty() ? "" : ", ", rejected);
  }
  result.time_base = reader->counters().time_base;
  result.twins = reader->counters().twins;
  result.outside_declared = declared.Sentences();
  result.supply_pressure = pressure.value();
  result.oil_temperature = oil.value();
  return result;
}

Error NotMeasured(const std::string& what, const Error& why, const FrfRecord& record) {
  const Told left_out = record.left_out > 0 ? Tell("; {} of {} rows were left out ({})",
                                                   "; {} von {} Zeilen wurden ausgelassen ({})",
                                                   record.left_out, record.rows, record.left_out_why)
                                            : Told();
  const Told told = Tell("{}: {}{}", "{}: {}{}", what, ToldOf(why), left_out);
  return {why.kind, told.english, told.german};
}

}  // namespace hydroscope
