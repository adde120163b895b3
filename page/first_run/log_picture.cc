#include "page/first_run/log_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/told_error.h"
#include "core/units.h"
#include "estimation/stroke_segmenter.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/state_model.h"
#include "page/first_run/gate_course.h"
#include "page/http/json_reply.h"
#include "pipeline/episode_cutter.h"
#include "pipeline/log_pass.h"
#include "pipeline/pipeline.h"
#include "pipeline/raw_log.h"

namespace hydroscope {

void Envelope::Add(double value) {
  if (rows_in_last_ == 0) {
    if (low_.size() == most_) Halve();
    if (rows_in_last_ == 0) {
      low_.push_back(kNaN);
      high_.push_back(kNaN);
    }
  }
  low_.back() = std::fmin(low_.back(), value);  // of a number and NaN the number
  high_.back() = std::fmax(high_.back(), value);
  rows_in_last_ = (rows_in_last_ + 1) % width_;
}

void Envelope::Halve() {
  for (std::size_t k = 0; k + 1 < low_.size(); k += 2) {
    low_[k / 2] = std::fmin(low_[k], low_[k + 1]);
    high_[k / 2] = std::fmax(high_[k], high_[k + 1]);
  }
  low_.resize(low_.size() / 2);
  high_.resize(high_.size() / 2);
  width_ *= 2;
}

namespace {

nlohmann::json ShownJson(const std::vector<double>& values, const DisplayUnit& unit) {
  nlohmann::json out = nlohmann::json::array();
  for (const double value : values)
    out.push_back(value * unit.factor + unit.offset);  // NaN is written as null
  return out;
}

std::string SiOf(const SignalSpec& signal) {
  const auto unit = FindUnit(signal.unit);
  return std::string(unit ? unit->si : "1");
}

std::vector<GateCourse> GateCoursesOf(const Machine& machine, double period) {
  const WindowSamples window = WindowSamples::From(machine.window, period);
  std::vector<GateCourse> courses;
  for (const GateBound& bound : machine.gate.bounds)
    if (const int signal = machine.SignalIndex(bound.signal); signal >= 0)
      courses.emplace_back(bound, signal, window.block, StrokeSegmenter::GateReach(window), period);
  return courses;
}

/// Notes where strokes lie in what passes through it. Of a machine with states it cuts episodes and fits none of them.
class StrokeFinder {
 public:
  StrokeFinder(const Machine& machine, double period) {
    if (!KindOf(machine).has_states) {
      auto made = Pipeline::Create(
          machine, period, [this](StrokeRecord&& stroke) { Note(stroke.summary.begin, stroke.summary.end); });
      Take(made, pipeline_);
      return;
    }
    auto model = BuildStateModel(machine, machine.added_effects);
    Take(model, model_);
    if (!model_) return;
    if (const Status cuts = EpisodeCutter::Check(model_->machine); !cuts) {
      none_ = ErrorJson(ToldOf(cuts.error()));
      return;
    }
    cutter_ = std::make_unique<EpisodeCutter>(
        model_->machine, EpisodeSignals{model_->inputs, model_->outputs},
        EpisodeCutter::Options{.period = period}, [this](const Episode& episode, const StrokeCounters&) {
          Note(episode.time.front(), episode.time.back());
        });
  }

  /// For PassLog; null: rows go to Process.
  Pipeline* pipeline() const { return pipeline_.get(); }
  void Process(const SampleBlock& block) {
    if (cutter_) cutter_->Process(block);
  }
  void Finish() {
    if (cutter_) cutter_->Finish();
  }
  const nlohmann::json& strokes() const { return strokes_; }
  std::int64_t discarded() const {
    return cutter_ ? cutter_->discarded() : pipeline_ ? pipeline_->discarded_strokes() : 0;
  }
  /// Why no stroke can be found; null: they can.
  const nlohmann::json& none() const { return none_; }

 private:
  template <class T, class To>
  void Take(Result<T>& made, To& to) {
    if (made)
      to = std::move(*made);
    else
      none_ = ErrorJson(ToldOf(made.error()));
  }
  void Note(double begin, double end) { strokes_.push_back({{"begin", begin}, {"end", end}}); }

  std::unique_ptr<Pipeline> pipeline_;
  std::shared_ptr<const StateModel> model_;
  std::unique_ptr<EpisodeCutter> cutter_;
  nlohmann::json strokes_ = nlohmann::json::array(), none_;
};

}  // namespace

Result<nlohmann::json> LogPictureJson(const std::string& log, const Machine& machine) {
  auto reader = TRY(OpenRecording(log, machine));
  StrokeFinder finder(machine, reader->SamplePeriod());
  const bool without = MeasuredByResponse(KindOf(machine));
  std::vector<Envelope> signals(machine.signals.size(), Envelope(kPicturePoints));
  std::vector<GateCourse> gate = GateCoursesOf(machine, reader->SamplePeriod());
  double first = kNaN, last = kNaN;
  std::int64_t rows = 0;
  LogPassHooks hooks;
  hooks.observe = [&](const SampleBlock& block) {
    for (std::size_t s = 0; s < signals.size(); ++s)
      for (const double value : block.signal[s]) signals[s].Add(value);
    for (GateCourse& course : gate)
      for (const double value : block.signal[static_cast<std::size_t>(course.signal())]) course.Add(value);
    finder.Process(block);
    if (block.rows() == 0) return;
    if (rows == 0) first = block.time.front();
    last = block.time.back();
    rows += static_cast<std::int64_t>(block.rows());
  };
  TRY(PassLog(*reader, machine, finder.pipeline(), "picture", hooks));
  finder.Finish();
  nlohmann::json shown = nlohmann::json::array();
  for (std::size_t s = 0; s < signals.size(); ++s) {
    const DisplayUnit unit = ShownUnit(machine, machine.signals[s].name);
    shown.push_back({{"name", machine.signals[s].name},
                     {"unit", unit.name},
                     {"low", ShownJson(signals[s].low(), unit)},
                     {"high", ShownJson(signals[s].high(), unit)}});
  }
  nlohmann::json courses = nlohmann::json::array();
  for (const GateCourse& course : gate)
    courses.push_back(course.Json(SiOf(machine.signals[static_cast<std::size_t>(course.signal())])));
  const double period = rows > 1 ? (last - first) / static_cast<double>(rows - 1) : 0;
  const double width = signals.empty() ? 1 : static_cast<double>(signals.front().rows_per_stretch());
  return nlohmann::json{{"from", first},
                        {"step", period * width},
                        {"duration_s", last - first},
                        {"rows", rows},
                        {"signals", shown},
                        {"strokes", without ? nlohmann::json() : finder.strokes()},
                        {"gate", std::move(courses)},
                        {"discarded", finder.discarded()},
                        {"no_strokes", without ? nlohmann::json() : finder.none()}};
}

nlohmann::json ThumbnailJson(const std::vector<double>& values, std::size_t points) {
  Envelope envelope(points);
  for (const double value : values) envelope.Add(value);
  return {{"low", ShownJson(envelope.low(), {})}, {"high", ShownJson(envelope.high(), {})}};
}

}  // namespace hydroscope
