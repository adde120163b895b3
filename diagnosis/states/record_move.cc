#include "diagnosis/states/record_move.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/short_number.h"
#include "core/units.h"
#include "estimation/states/row_course.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

struct InputRange {
  int signal = 0;
  double low = 0, high = 0;    ///< recorded
  double least = 0, most = 0;  ///< allowed
};

/// What [experiment] says of a signal or of its speed; nothing: it does not.
const GateBound* BoundOf(const StateModel& model, int signal, bool rate) {
  for (const GateBound& bound : model.machine.experiment.signals)
    if (bound.rate == rate && model.machine.SignalIndex(bound.signal) == signal) return &bound;
  return nullptr;
}

InputRange MayRunFrom(const StateModel& model, int signal, const Episode& recorded) {
  const auto values = recorded.signal.col(signal);
  InputRange range{signal, values.minCoeff(), values.maxCoeff(), 0, 0};
  range.least = range.low;
  range.most = range.high;
  if (const GateBound* bound = BoundOf(model, signal, false)) {
    range.least = bound->min.value_or(range.least);
    range.most = bound->max.value_or(range.most);
  }
  return range;
}

/// Inputs that may be moved: those of [experiment]; all if it names none.
std::vector<InputRange> RangesOf(const StateModel& model, const Episode& recorded) {
  const bool named = !model.machine.experiment.signals.empty();
  std::vector<InputRange> ranges;
  for (const int signal : model.inputs) {
    const InputRange range = MayRunFrom(model, signal, recorded);
    if (range.high > range.low && (!named || BoundOf(model, signal, false) != nullptr))
      ranges.push_back(range);
  }
  return ranges;
}

/// Levels worth trying, as (from, to): scaled about zero and about their middle, at either end of what is allowed, mirrored.
std::vector<std::pair<double, double>> LevelsOf(const InputRange& r) {
  constexpr double kSame = 0.02;  // of the recorded range
  const double middle = 0.5 * (r.low + r.high), half = 0.5 * (r.high - r.low),
               center = 0.5 * (r.least + r.most);
  std::vector<std::pair<double, double>> all = {
      {r.least, r.most}, {r.least, center}, {center, r.most}, {-r.low, -r.high}};
  for (const double scale : {0.25, 0.5, 2.0, 4.0}) {
    all.emplace_back(scale * r.low, scale * r.high);
    all.emplace_back(middle - scale * half, middle + scale * half);
  }
  std::vector<std::pair<double, double>> out;
  const auto same = [&](const std::pair<double, double>& a, const std::pair<double, double>& b) {
    return std::abs(a.first - b.first) + std::abs(a.second - b.second) < kSame * (r.high - r.low);
  };
  for (const auto& levels : all) {
    const auto [least, most] = std::minmax(levels.first, levels.second);
    const double margin = 1e-9 * (r.most - r.least);
    if (least < r.least - margin || most > r.most + margin || same(levels, {r.low, r.high}) ||
        std::any_of(out.begin(), out.end(), [&](const auto& other) { return same(levels, other); }))
      continue;
    out.push_back(levels);
  }
  return out;
}

/// With its levels made smaller about zero where they leave what is allowed.
InputCourse Within(const InputCourse& course, const GateBound* bound) {
  InputCourse out = course;
  if (bound == nullptr) return out;
  double scale = 1;
  for (const double level : course.levels) {
    if (bound->max && level > *bound->max) scale = std::min(scale, std::max(0.0, *bound->max / level));
    if (bound->min && level < *bound->min) scale = std::min(scale, std::max(0.0, *bound->min / level));
  }
  for (double& level : out.levels) level *= scale;
  return out;
}

/// Value of a recorded input some seconds after its beginning; after its end it begins again.
double Recorded(const Episode& recorded, int signal, double since, InputHold hold) {
  const double duration = recorded.time.back() - recorded.time.front();
  if (duration <= 0) return recorded.signal(0, signal);
  const double at = recorded.time.front() + std::fmod(since, duration);
  const auto after = std::upper_bound(recorded.time.begin(), recorded.time.end(), at);
  const auto row = static_cast<int>(std::max<std::ptrdiff_t>(0, after - recorded.time.begin() - 1));
  const auto next = static_cast<std::size_t>(std::min(row + 1, recorded.rows() - 1));
  const double begin = recorded.time[static_cast<std::size_t>(row)], period = recorded.time[next] - begin;
  return CourseOf(recorded, row, signal, hold).At(period > 0 ? (at - begin) / period : 0);
}

Told SpeedText(double speed) {
  return speed == 2     ? Tell("twice as fast", "doppelt so schnell")
         : speed == 0.5 ? Tell("half as fast", "halb so schnell")
                        : Tell("{:g} times as fast", "{:g}-mal so schnell", speed);
}

}  // namespace

Told MoveText(const RecordMove& move, const StateModel& model, const Episode& recorded) {
  const auto unit_of = [&](int signal) {
    const auto unit = FindUnit(model.machine.signals[static_cast<std::size_t>(signal)].unit);
    return DisplayUnitFor(unit ? unit->si : "1");
  };
  const auto name = [&](int signal) { return model.machine.signals[static_cast<std::size_t>(signal)].name; };
  if (move.course) {
    const int signal = model.machine.SignalIndex(move.course->signal);
    const DisplayUnit unit = unit_of(signal);
    std::vector<std::string> levels;
    for (const double level : move.course->levels) levels.push_back(ShortNumber(level * unit.factor));
    return Tell("{} as a {} of {} {}, {:g} s each", "{} als {} von {} {}, je {:g} s", name(signal),
                move.course->name, fmt::to_string(fmt::join(levels, ", ")), std::string(unit.name),
                move.course->seconds);
  }
  std::vector<Told> parts;
  for (const RecordMove::Levels& levels : move.inputs) {
    const DisplayUnit unit = unit_of(levels.signal);
    const auto values = recorded.signal.col(levels.signal);
    parts.push_back(Tell("{} from {:.3g} to {:.3g} {} in place of {:.3g} to {:.3g}",
                         "{} von {:.3g} bis {:.3g} {} statt {:.3g} bis {:.3g}", name(levels.signal),
                         levels.from * unit.factor, levels.to * unit.factor, std::string(unit.name),
                         values.minCoeff() * unit.factor, values.maxCoeff() * unit.factor));
  }
  if (move.speed != 1) parts.push_back(SpeedText(move.speed));
  return parts.empty() ? Tell("the same once more", "dasselbe noch einmal") : Joined(parts);
}

std::vector<RecordMove> RecordMoves(const StateModel& model, const Episode& recorded) {
  std::vector<RecordMove> moves = {{}};
  const std::vector<InputRange> ranges = RangesOf(model, recorded);
  for (const InputRange& range : ranges)
    for (const auto& [from, to] : LevelsOf(range)) moves.push_back({{{range.signal, from, to}}, 1, {}});
  if (ranges.size() > 1) {
    RecordMove all;
    for (const InputRange& range : ranges) all.inputs.push_back({range.signal, range.least, range.most});
    moves.push_back(std::move(all));
  }
  const auto courses = KindOf(model.machine).experiment.courses;
  if (courses == nullptr) return moves;
  for (const InputCourse& course : courses(model.machine))
    moves.push_back({{}, 1, Within(course, BoundOf(model, model.machine.SignalIndex(course.signal), false))});
  return moves;
}

std::vector<double> RecordSpeeds() { return {0.25, 0.5, 2, 4}; }

bool KeepsSpeeds(const StateModel& model, const Episode& moved) {
  constexpr double kRounding = 1 + 1e-9;
  for (const int signal : model.inputs) {
    const GateBound* bound = BoundOf(model, signal, true);
    if (bound == nullptr || !bound->max) continue;
    for (int row = 1; row < moved.rows(); ++row) {
      const double period =
          moved.time[static_cast<std::size_t>(row)] - moved.time[static_cast<std::size_t>(row) - 1];
      if (std::abs(moved.signal(row, signal) - moved.signal(row - 1, signal)) >
          kRounding * *bound->max * period)
        return false;
    }
  }
  return true;
}

Episode MovedRecord(const RecordMove& move, const StateModel& model, const Episode& recorded, int most_rows) {
  Episode out;
  out.log = recorded.log;
  const double period = (recorded.time.back() - recorded.time.front()) / std::max(1, recorded.rows() - 1);
  const double seconds =
      move.course ? move.course->seconds * static_cast<double>(move.course->levels.size()) : 0;
  const int rows = std::min(most_rows, move.course ? static_cast<int>(seconds / period) : recorded.rows());
  for (int row = 0; row < rows; ++row)
    out.time.push_back(move.course ? row * period
                                   : recorded.time[static_cast<std::size_t>(row)] - recorded.time.front());
  out.signal = recorded.signal.row(0).replicate(rows, 1);
  for (const int signal : model.inputs)
    for (int row = 0; row < rows; ++row)
      out.signal(row, signal) =
          move.course ? recorded.signal.col(signal).mean()
                      : Recorded(recorded, signal, move.speed * out.time[static_cast<std::size_t>(row)],
                                 model.machine.log.hold);
  for (const RecordMove::Levels& levels : move.inputs) {
    const double low = recorded.signal.col(levels.signal).minCoeff(),
                 high = recorded.signal.col(levels.signal).maxCoeff();
    for (int row = 0; row < rows; ++row)
      out.signal(row, levels.signal) =
          levels.from + (out.signal(row, levels.signal) - low) * (levels.to - levels.from) / (high - low);
  }
  if (move.course) {
    const int signal = model.machine.SignalIndex(move.course->signal);
    for (int row = 0; row < rows; ++row) {
      const auto level =
          static_cast<std::size_t>(out.time[static_cast<std::size_t>(row)] / move.course->seconds);
      out.signal(row, signal) = move.course->levels[std::min(level, move.course->levels.size() - 1)];
    }
  }
  return out;
}

}  // namespace hydroscope
