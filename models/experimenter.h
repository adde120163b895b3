#pragma once

#include <Eigen/Dense>
#include <compare>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/machine.h"
#include "models/model_structure.h"
#include "models/stretch.h"

namespace hydroscope {

/// Something that strokes of a kind of machine can be asked to run at: the ram speed.
struct StrokeSetting {
  std::string_view key;  ///< of [experiment] of the machine file: "ram_speed"
  std::string_view si;
  /// Its limits are from ... to. Else [experiment] gives one number, the most that it may change by from stroke to stroke.
  bool range = true;
  std::string_view levels;  ///< of a plan in JSON: its levels, one number unless it has a range; "speeds"
  std::string_view unit_key = {};  ///< of a plan in JSON: their unit, "speed_unit"; "" = not told
};

/// Levels (SI) that the strokes of a series take, for each setting of the kind; none: as recorded.
using StrokeSeries = std::vector<std::vector<double>>;

/// One stroke that nobody has recorded yet.
struct UnrecordedStroke {
  StrokeSeries levels;  ///< that it runs at, or through
  double begin = 0;     ///< s, on the time of the strokes recorded

  auto operator<=>(const UnrecordedStroke&) const = default;
};

/// How samples of a stroke are laid out.
struct StrokeSampling {
  double period = 0;     ///< s
  int span_samples = 0;  ///< samples of one stretch
};

enum class PlayedNoise { kNone, kAsRecorded };

/// What one machine may be asked to do, and how it does it: within [experiment] of its machine file, else within
/// what was recorded.
class Experimenter {
 public:
  virtual ~Experimenter() = default;
  /// Every series of strokes worth weighing.
  virtual std::vector<StrokeSeries> Candidates() const = 0;
  /// The strokes that stand for a series which begins at `begin`, s, and has at least `fewest` strokes, all alike often.
  virtual std::vector<UnrecordedStroke> StrokesOf(const StrokeSeries& series, double begin,
                                                  int fewest) const = 0;
  /// A stroke played through by the base balance of `model` with parameters `theta`, without sensor noise or with white noise
  /// as recorded.
  virtual StrokeStretches Play(const ModelStructure& model, const Eigen::VectorXd& theta,
                               const UnrecordedStroke& stroke, const StrokeSampling& sampling,
                               PlayedNoise noise) const = 0;
  /// s that so many strokes of a series take inside the gate.
  virtual double Seconds(const StrokeSeries& series, int strokes) const = 0;
  /// s that a series costs which takes `seconds` inside the gate: waiting and setting up between strokes count too.
  virtual double Price(const StrokeSeries& series, double seconds) const = 0;
};

/// A course of one input that shows of a machine with states what ordinary records hide.
struct InputCourse {
  Told name;                   ///< "staircase"
  std::string signal;          ///< the input
  std::vector<double> levels;  ///< SI, held in turn ...
  double seconds = 0;          ///< ... for so long each
};

/// What a kind of machine says of experiments.
struct ExperimentRules {
  std::span<const StrokeSetting> settings = {};
  /// For strokes recorded on one machine. nullptr: no strokes of the kind are proposed.
  std::unique_ptr<Experimenter> (*on)(const Machine& machine,
                                      std::span<const StrokeStretches> recorded) = nullptr;
  /// "Record 40 strokes at 20 mm/s ... (200 s of drawing)" for the person at the machine.
  Told (*text)(const StrokeSeries& series, int strokes, double seconds) = nullptr;
  /// Of a machine with states; nullptr: what was recorded is varied only.
  std::vector<InputCourse> (*courses)(const Machine& machine) = nullptr;
};

}  // namespace hydroscope
