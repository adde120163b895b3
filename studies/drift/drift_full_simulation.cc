#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iostream>
#include <limits>
#include <vector>

#include "core/constants.h"
#include "core/quantile.h"
#include "diagnosis/drift/drift_monitor.h"
#include "host/output.h"
#include "studies/drift/drift_benchmarks.h"
#include "studies/drift/drift_press.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

using drift::DriftMonitor;
using drift::FindingState;
using drift::StrokeEvidence;

constexpr double kSecondsPerStroke = 7.0;  ///< about, over products and random speeds
constexpr int kLeastPart = 50;             ///< strokes recorded of one product in a row
constexpr double kViscosity = 0.006;       ///< 1/K, change of the flow with the oil temperature

struct FullFault {
  const char* name;
  const char* rule;
  int limit;  ///< strokes, median
  std::function<void(PressOptions&)> apply;
};

const std::array<FullFault, 5> kFullFaults = {{
    {"K' -10 %", "entrained_air", 30, [](PressOptions& o) { o.machine.K *= 0.9; }},
    {"leakage 1 l/min at 200 bar", "internal_leakage", 50,
     [](PressOptions& o) {
       o.effects.push_back({"internal_leakage", kOneLitre, {}});
     }},
    {"Q_vn -3 %", "clogged_valve", 50, [](PressOptions& o) { o.machine.Q_vn *= 0.97; }},
    {"Q_vn +3 %", "worn_metering_edge", 50, [](PressOptions& o) { o.machine.Q_vn *= 1.03; }},
    {"y_0 +0.4 %", "null_shift", 50, [](PressOptions& o) { o.machine.y_0 += 0.004; }},
}};

/// One simulated axis: its healthy options and how it is driven.
struct Axis {
  PressOptions healthy;
  bool products = false;
};

Axis AxisOf(int index, std::uint64_t seed) {
  Axis axis{RandomMachine(seed), index % 2 == 1};
  axis.healthy.effects = {{"oil_viscosity", kViscosity, {}}};
  return axis;
}

/// About `strokes` strokes with the oil going from `cold` to `warm` (degC), numbered from `sequence` on;
/// every part of the log is of the next product, or driven at random.
Result<std::vector<StrokeEvidence>> Record(const Axis& axis, const drift::WatchedModel* model, int strokes,
                                           double cold, double warm, std::uint64_t seed,
                                           std::int64_t& sequence,
                                           std::shared_ptr<const ModelStructure>* structure,
                                           const std::function<void(PressOptions&)>& fault = {}) {
  std::vector<StrokeEvidence> evidence;
  const int parts = std::max(1, strokes / kLeastPart);
  for (int part = 0; part < parts; ++part) {
    PressOptions o = axis.healthy;
    if (axis.products) {
      const PressMotion product = ProductOptions(part % StrokePress::kProducts, 1).motion;
      const double fastest = axis.healthy.motion.speed_max;
      o.motion.speed_min = std::min(product.speed_min, 0.97 * fastest);
      o.motion.speed_max = std::min(product.speed_max, fastest);
      o.motion.set_point_min = product.set_point_min;
      o.motion.set_point_max = product.set_point_max;
    }
    o.seed = StreamSeed(seed, "part") + part;
    o.seconds = kSecondsPerStroke * strokes / parts;
    o.oil_start = kZeroCelsius + cold + (warm - cold) * part / parts;
    o.oil_end = kZeroCelsius + cold + (warm - cold) * (part + 1) / parts;
    if (fault) fault(o);
    const auto log = TRY(StrokesOf(SimulatePress(o), MachineFor(o)));
    if (structure != nullptr) *structure = log.model;
    for (const StrokeRecord& record : log.strokes)
      if (model != nullptr) evidence.push_back(model->Evidence(record, sequence++));
  }
  return evidence;
}

struct FullFaultTally {
  int cases = 0, found = 0, right = 0, wrong = 0, undecided = 0, near = 0;
  std::vector<double> named;
};

struct Campaign {
  std::array<FullFaultTally, kFullFaults.size()> faults;
  std::int64_t strokes = 0, judged = 0;
  int false_alarms = 0;
  int untold = 0;  ///< machines whose strokes did not tell the parameters
};

void FollowFault(DriftMonitor monitor, const std::vector<StrokeEvidence>& strokes, const FullFault& fault,
                 bool details, FullFaultTally& tally) {
  ++tally.cases;
  const std::int64_t begin = strokes.front().sequence;
  for (const StrokeEvidence& stroke : strokes) {
    monitor.Add(stroke);
    for (const drift::DriftFinding& f : monitor.findings()) {
      if (!WasTold(f)) continue;
      ++tally.found;
      tally.named.push_back(static_cast<double>(stroke.sequence - begin + 1));
      tally.near += std::abs(f.since.last_before + 1 - begin) <= 10;
      if (f.state == FindingState::kUndecided)
        ++tally.undecided;
      else
        ++(f.rule == fault.rule ? tally.right : tally.wrong);
      if (details) fmt::print("    {:<28} {}\n", fault.name, drift::FindingText(f));
      return;
    }
  }
  tally.named.push_back(std::numeric_limits<double>::infinity());
  if (details) fmt::print("    {:<28} not found\n", fault.name);
}

Status RunAxis(int index, const DriftFullSimulationOptions& o, Campaign& campaign) {
  const std::uint64_t seed = StreamSeed(o.seed, "machine") + index;
  const Axis axis = AxisOf(index, seed);
  std::shared_ptr<const ModelStructure> structure;
  std::int64_t sequence = 0;
  TRY(Record(axis, nullptr, 1, 40, 40, seed, sequence, &structure));
  const auto model = TRY(drift::WatchedModel::Create(structure, {"internal_leakage"}));
  const auto first =
      TRY(Record(axis, &model, o.commissioning, 24, o.learned_to, seed + 1000, sequence, nullptr));
  auto reference = drift::Reference::Learn(model, first, 1);
  if (!reference) {
    ++campaign.untold;
    return {};
  }
  const drift::RuleBook rules = drift::DefaultRules();
  DriftMonitor monitor(model, rules, std::move(*reference));
  const auto healthy = TRY(Record(axis, &model, o.healthy, 25, 62, seed + 2000, sequence, nullptr));
  if (o.details)
    fmt::print("  machine {} ({}), {} classes\n", index + 1, axis.products ? "three products" : "random",
               monitor.reference().classes().count());
  std::int64_t told = 0;
  for (const StrokeEvidence& stroke : healthy) {
    campaign.judged += monitor.Add(stroke).reason == drift::JudgementReason::kJudged;
    ++campaign.strokes;
    for (const drift::DriftFinding& f : monitor.findings()) {
      if (!WasTold(f) || f.number <= told) continue;
      told = f.number;
      ++campaign.false_alarms;
      fmt::print("  false alarm, machine {} stroke {} oil {:.1f} degC: {}\n", index + 1, stroke.sequence,
                 f.oil_temperature - kZeroCelsius, drift::FindingText(f));
    }
  }
  if (!monitor.findings().empty()) return {};  // a fault beside a false alarm is another question
  for (std::size_t f = 0; f < kFullFaults.size(); ++f) {
    std::int64_t number = sequence;
    const auto faulty =
        TRY(Record(axis, &model, o.faulty, 40, 45, seed + 3000 + f, number, nullptr, kFullFaults[f].apply));
    FollowFault(monitor, faulty, kFullFaults[f], o.details, campaign.faults[f]);
  }
  return {};
}

bool Print(const Campaign& c, const DriftFullSimulationOptions& o) {
  fmt::print("\n{:<28} {:>6} {:>7} {:>10} {:>12} {:>7} {:>7} {:>10}\n", "fault", "cases", "found", "named",
             "change ±10", "right", "wrong", "undecided");
  bool reached = true;
  for (std::size_t f = 0; f < kFullFaults.size(); ++f) {
    const FullFaultTally& t = c.faults[f];
    const double n = std::max(1, t.cases);
    const double median = Median(t.named, kNever);
    fmt::print("{:<28} {:>6} {:>5.1f} % {:>10} {:>10.1f} % {:>5.1f} % {:>5.1f} % {:>8.1f} %\n",
               kFullFaults[f].name, t.cases, 100 * t.found / n, median, 100 * t.near / n, 100 * t.right / n,
               100 * t.wrong / n, 100 * t.undecided / n);
    reached = reached && t.cases > 0 && median <= kFullFaults[f].limit && t.right >= 0.95 * t.cases &&
              t.wrong <= 0.01 * t.cases && t.near >= 0.95 * t.cases;
  }
  fmt::print(
      "named: median strokes after the fault\n"
      "healthy: {} strokes of {} machines, {:.1f} % judged, {} false alarms (required: none in a day of each "
      "machine); {} machines whose commissioning strokes do not tell the parameters apart\n",
      c.strokes, o.machines,
      100.0 * static_cast<double>(c.judged) / static_cast<double>(std::max<std::int64_t>(1, c.strokes)),
      c.false_alarms, c.untold);
  return reached && c.false_alarms == 0;
}

}  // namespace

int RunDriftFullSimulation(const DriftFullSimulationOptions& o) {
  Campaign campaign;
  ProgressBar progress("machines", "machines");
  for (int index = 0; index < o.machines; ++index) {
    if (const Status done = RunAxis(index, o, campaign); !done) return ReportError(done.error());
    progress.Update((index + 1.0) / o.machines, index + 1);
  }
  const bool reached = Print(campaign, o);
  std::cout << (reached ? "\nreached what was required\n" : "\nNOT reached what was required\n");
  return reached ? 0 : 1;
}

}  // namespace hydroscope
