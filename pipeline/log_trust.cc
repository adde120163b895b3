#include "pipeline/log_trust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json_value.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "pipeline/log_faults/aliased_motion.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsAtATime = 4096;

constexpr double kRowsOfASwing = 10;  ///< that leave a balance an error of some per cent

void DescribeAliasing(const AliasedMotion& motion, SamplingRate& rate) {
  rate.fast_enough = false;
  rate.needed_rate_hz = kRowsOfASwing * motion.frequency_hz;
  rate.needed_period = 1 / rate.needed_rate_hz;
  rate.why = Tell("sampled too slowly", "zu langsam abgetastet");
  rate.sentence = Tell(
      "sampled too slowly for this: {} and {} swing at {:.3g} Hz by their sizes, and from row to row, {:.3g} ms apart, they do not "
      "belong together; record {:.3g} rows a second or more",
      "zu langsam abgetastet dafür: {} und {} schwingen ihrer Größe nach mit {:.3g} Hz, und von Zeile zu Zeile, alle {:.3g} ms, "
      "passen sie nicht zusammen; {:.3g} Zeilen je Sekunde oder mehr aufzeichnen",
      motion.rate, motion.level, motion.frequency_hz, 1e3 * rate.period, rate.needed_rate_hz);
}

/// Strokes that tell what noise and rows of a log are like.
constexpr int kStrokesJudged = 40;

}  // namespace

FirstStrokes::FirstStrokes(const Machine& machine)
    : strokes_(machine, KeepSamples::kYes), tap_(strokes_.Tap()), sink_(strokes_.Sink()) {}

void FirstStrokes::AddStretch(const Stretch& stretch, const SpanEquations& equations) {
  if (!complete()) tap_(stretch, equations);
}

void FirstStrokes::AddStroke(const StrokeRecord& record) {
  if (taken_++ < kStrokesJudged) sink_(StrokeRecord(record));
}

bool FirstStrokes::complete() const { return taken_ >= kStrokesJudged; }

Result<LogTrust> JudgeRows(LogReader& reader, const Machine& machine) {
  if (InEpisodes(KindOf(machine))) return LogTrust{};  // which are not filtered
  return JudgeStrokes(TRY(FirstStrokesOf(reader, machine)));
}

Result<LogStrokes> FirstStrokesOf(LogReader& reader, const Machine& machine) {
  FirstStrokes first(machine);
  const auto pipeline = TRY(Pipeline::Create(machine, reader.SamplePeriod(),
                                             [&](StrokeRecord&& record) { first.AddStroke(record); }));
  pipeline->set_tap(
      [&](const Stretch& stretch, const SpanEquations& equations) { first.AddStretch(stretch, equations); });
  SampleBlock block;
  while (!first.complete() && TRY(reader.Read(block, kRowsAtATime)) > 0) pipeline->Process(block);
  pipeline->Finish();
  return first.Finish(*pipeline);
}

std::vector<Told> LogTrust::Warnings() const {
  std::vector<Told> warnings;
  if (!rate.fast_enough) warnings.push_back(rate.sentence);
  for (const Told& sentence : floor.sentences)
    warnings.push_back(floor.believable ? sentence
                                        : Tell("{}; the noise floor is not believed",
                                               "{}; der Rauschboden wird nicht geglaubt", sentence));
  return warnings;
}

LogTrust JudgeLog(const LogStrokes& log, const Eigen::VectorXd& theta, double noise_floor) {
  LogTrust trust;
  // A machine with states leaves no stretches.
  if (std::ranges::all_of(log.stretches, [](const auto& s) { return s.empty(); })) return trust;
  trust.floor = JudgeFloor(*log.model, log.stretches, log.window, theta, log.machine);
  trust.rate = JudgeSamplingRate(*log.model, log.stretches, log.window, theta, trust.floor, noise_floor);
  if (trust.rate.fast_enough)
    if (const auto motion = FindAliasedMotion(log.machine, *log.model, log.stretches, log.window.period))
      DescribeAliasing(*motion, trust.rate);
  return trust;
}

LogTrust JudgeStrokes(const LogStrokes& log) {
  std::vector<StrokeGram> grams = log.Grams();
  grams.resize(std::min(grams.size(), log.stretches.size()));
  const auto fit = FitBaseModel(*log.model, grams, log.window);
  return fit ? JudgeLog(log, fit->theta, fit->noise_floor) : LogTrust{};
}

nlohmann::json NoiseJson(const FloorTrust& floor) {
  const auto number = [](double x) { return JsonNumber(x); };
  nlohmann::json signals = nlohmann::json::array();
  for (const SignalNoise& s : floor.signals)
    signals.push_back({{"signal", s.name},
                       {"kind", NoiseKindName(s.kind)},
                       {"unit", s.unit},
                       {"std", s.std},
                       {"stated", number(s.stated)},
                       {"ratio", number(s.ratio)},
                       {"ratio_interval95", {number(s.ratio_low), number(s.ratio_high)}},
                       {"share", s.share}});
  return {{"believable", floor.believable}, {"noise_scale", number(floor.noise_scale)}, {"signals", signals}};
}

nlohmann::json SamplingJson(const SamplingRate& rate, const ModelStructure* model) {
  const DisplayUnit unit = OutputUnit(model);
  return {{"fast_enough", rate.fast_enough},
          {"period_s", rate.period},
          {"needed_period_s", rate.needed_period},
          {"error", rate.error * unit.factor},
          {"allowed", rate.allowed * unit.factor}};
}

std::string WarningsText(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += fmt::format("WARNING: {}\n", warning);
  return text;
}

}  // namespace hydroscope
