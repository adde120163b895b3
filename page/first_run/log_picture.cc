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
#include "page/first_run/gate_course.h"
#include "page/http/json_reply.h"
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

}  // namespace

Result<nlohmann::json> LogPictureJson(const std::string& log, const Machine& machine) {
  auto reader = TRY(OpenRecording(log, machine));
  nlohmann::json strokes = nlohmann::json::array(), no_strokes;
  auto pipeline = Pipeline::Create(machine, reader->SamplePeriod(), [&](StrokeRecord&& stroke) {
    strokes.push_back({{"begin", stroke.summary.begin}, {"end", stroke.summary.end}});
  });
  if (MeasuredByResponse(KindOf(machine)))
    strokes = nullptr;
  else if (!pipeline)
    no_strokes = ErrorJson(ToldOf(pipeline.error()));
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
    if (block.rows() == 0) return;
    if (rows == 0) first = block.time.front();
    last = block.time.back();
    rows += static_cast<std::int64_t>(block.rows());
  };
  const auto pass = TRY(PassLog(*reader, machine, pipeline ? pipeline->get() : nullptr, "picture", hooks));
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
                        {"strokes", strokes},
                        {"gate", std::move(courses)},
                        {"discarded", pass.summary.discarded_strokes},
                        {"no_strokes", no_strokes}};
}

nlohmann::json ThumbnailJson(const std::vector<double>& values, std::size_t points) {
  Envelope envelope(points);
  for (const double value : values) envelope.Add(value);
  return {{"low", ShownJson(envelope.low(), {})}, {"high", ShownJson(envelope.high(), {})}};
}

}  // namespace hydroscope
