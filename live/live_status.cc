#include "live/live_status.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/counted_words.h"
#include "core/json_value.h"
#include "core/printable.h"
#include "core/time_text.h"
#include "core/units.h"
#include "models/machine_kind.h"
#include "models/parameter_unit.h"
#include "monitor/statement_json.h"

namespace hydroscope {
namespace {

using nlohmann::json;

json CountersJson(const AlignerCounters& c) {
  return {{"rows", c.rows},
          {"missing_rows", c.missing_rows},
          {"late_rows", c.late_rows},
          {"duplicate_rows", c.duplicate_rows},
          {"contradicting_rows", c.contradicting_rows},
          {"reordered_batches", c.reordered_batches},
          {"future_rows", c.future_rows},
          {"gaps", c.gaps},
          {"skipped_rows", c.skipped_rows},
          {"sessions", c.sessions},
          {"sequence_jumps", c.sequence_jumps},
          {"clock_jumps", c.clock_jumps},
          {"slips", c.slips},
          {"stale_values", c.stale_values},
          {"already_stored", c.already_stored},
          {"second_sender_rows", c.second_sender_rows}};
}

json SourceJson(const SourceStatus& s, double age) {
  return {{"name", s.name},
          {"connected", s.connected},
          {"state", s.state.english},
          {"german", {{"state", s.state.german}}},
          {"age_s", JsonNumber(age)},
          {"batches", s.batches},
          {"rows", s.rows},
          {"lost_rows", s.lost_rows},
          {"duplicate_rows", s.duplicate_rows},
          {"reordered_batches", s.reordered_batches},
          {"reconnects", s.reconnects},
          {"malformed", s.malformed},
          {"timeouts", s.timeouts},
          {"exceptions", s.exceptions},
          {"refused", s.refused}};
}

json StreamJson(const StreamState& s) {
  return {{"source", s.source},
          {"channels", s.channels},
          {"period_s", s.period},
          {"batches", s.batches},
          {"clock_offset_s", s.has_clock ? JsonNumber(s.clock_offset) : json()},
          {"drift_ppm", s.drift * 1e6},
          {"delay_s", s.delay},
          {"worst_delay_s", s.worst_delay}};
}

json SenderJson(const SenderStatus& s) {
  return {{"source", s.id.source},   {"name", s.name},
          {"session", s.id.session}, {"age_s", JsonNumber(s.age)},
          {"rows", s.rows},          {"refused_rows", s.refused_rows},
          {"channels", s.channels},  {"refused_channels", s.refused}};
}

json ChannelJson(const ChannelStatus& c) {
  return {{"name", c.name},
          {"unit", c.unit},
          {"rate_hz", c.rate},
          {"age_s", JsonNumber(c.age)},
          {"value", JsonNumber(c.value)},
          {"noise_std", JsonNumber(c.noise_std)},
          {"flagged", c.flagged},
          {"stale", c.stale},
          {"senders", c.senders}};
}

/// `statements`: how the estimates of the axis are stated.
json AxisJson(const AxisStatus& a, const std::vector<EstimateStatement>& statements) {
  json estimates = json::object();
  for (const Estimate& e : a.estimates) {
    json& estimate = estimates[e.parameter] = {{"value", JsonNumber(e.value)},
                                               {"std", JsonNumber(e.std)},
                                               {"unit", e.unit},
                                               {"reason", ReasonName(e.reason)}};
    if (const EstimateStatement* s = FindStatement(statements, e.parameter);
        s != nullptr && s->confounded && e.reason == EstimateReason::kConfounded)
      estimate["why"] = s->why.english;
  }
  return {{"name", a.name},
          {"strokes", a.strokes},
          {"last_stroke_s", JsonNumber(a.last_stroke)},
          {"estimates", estimates},
          {"warnings", InEnglish(a.warnings)},
          {"german", {{"warnings", InGerman(a.warnings)}}},
          {"counters", CountersJson(a.counters)}};
}

json WriterJson(const WriterStatus& w) {
  return {{"state", WriterStateName(w.state)},
          {"problem", w.problem.english},
          {"free_bytes", w.free_bytes},
          {"database_bytes", w.database_bytes},
          {"waiting_items", w.waiting_items},
          {"waiting_bytes", w.waiting_bytes},
          {"waiting_strokes", w.waiting_strokes},
          {"steps", w.steps},
          {"strokes", w.strokes},
          {"rows", w.rows},
          {"dropped_rows", w.dropped_rows},
          {"dropped_strokes", w.dropped_strokes},
          {"refused", w.refused},
          {"pauses", w.pauses},
          {"databases", w.databases},
          {"begun_anew", w.begun_anew.english},
          {"german", {{"problem", w.problem.german}, {"begun_anew", w.begun_anew.german}}},
          {"latency_p50_s", w.latency_p50},
          {"latency_p99_s", w.latency_p99},
          {"latency_max_s", w.latency_max},
          {"commit_p99_s", w.commit_p99}};
}

json FeedJson(const FeedStatus& f) {
  json out = {{"name", f.name},           {"connected", f.connected},
              {"state", f.state.english}, {"german", {{"state", f.state.german}}},
              {"clients", f.clients},     {"delivered", f.delivered},
              {"behind", f.behind},       {"errors", f.errors}};
  for (const auto& [first, values] : f.registers)
    out["registers"].push_back({{"first", first}, {"values", values}});
  return out;
}

std::string Word(const json& object, const char* key) { return object.at(key).get<std::string>(); }
std::int64_t Count(const json& object, const char* key) { return object.at(key).get<std::int64_t>(); }
double Real(const json& object, const char* key) { return object.at(key).get<double>(); }

/// "12.3 bar"; numbers without a unit alone.
std::string InUnit(std::string number, std::string_view unit) {
  return unit == "1" || unit.empty() ? number : number.append(" ").append(unit);
}

/// "12.3 bar" from SI.
std::string Shown(const json& value, const std::string& si) {
  if (!value.is_number()) return "-";
  const DisplayUnit unit = DisplayUnitFor(si);
  return InUnit(fmt::format("{:.5g}", value.get<double>() * unit.factor + unit.offset), unit.name);
}

std::string NoiseShown(const json& value, const std::string& si) {
  if (!value.is_number()) return "-";
  const DisplayUnit unit = DisplayUnitFor(si);
  return InUnit(fmt::format("{:.3g}", value.get<double>() * unit.factor), unit.name);
}

std::string Age(const json& age) { return age.is_number() ? DurationText(age.get<double>()) : "never"; }

std::string Label(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '"' || c == '\\') escaped += '\\';
    escaped += c == '\n' ? ' ' : c;
  }
  return escaped;
}

/// Collects samples of one metric after the other, with its help line.
class Metrics {
 public:
  void Begin(const char* name, const char* type, const char* help) {
    name_ = name;
    text_ += fmt::format("# HELP hydroscope_{} {}\n# TYPE hydroscope_{} {}\n", name, help, name, type);
  }
  /// A sample of the metric begun last; none of a value that is not finite.
  template <typename Number>
  void Add(Number number, const std::string& labels = "") {
    const auto value = static_cast<double>(number);
    if (!std::isfinite(value)) return;
    text_ += labels.empty() ? fmt::format("hydroscope_{} {}\n", name_, value)
                            : fmt::format("hydroscope_{}{{{}}} {}\n", name_, labels, value);
  }
  template <typename Number>
  void One(const char* name, const char* type, const char* help, Number value) {
    Begin(name, type, help);
    Add(value);
  }
  /// One sample for each of `list`, named by `label`.
  template <typename Named, typename ValueOf>
  void Each(const char* name, const char* type, const char* help, const std::vector<Named>& list,
            const char* label, const ValueOf& value_of) {
    Begin(name, type, help);
    for (const Named& one : list)
      Add(std::invoke(value_of, one), fmt::format("{}=\"{}\"", label, Label(one.name)));
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string name_, text_;
};

json DriftJson(const DriftWatchStatus& drift) {
  json axes = json::array();
  for (const AxisHealth& a : drift.axes) {
    axes.push_back({{"name", a.name},
                    {"health", std::string(1, a.health.letter())},
                    {"health_reason", HealthReasonName(a.health.reason)},
                    {"health_text", a.health.text},
                    {"health_text_german", a.health.german},
                    {"reference_version", a.reference},
                    {"commissioning_strokes", a.learned},
                    {"commissioning_needed", a.needed},
                    {"judged_to", a.judged},
                    {"alarms", a.alarms},
                    {"statements", json::array()}});
    for (const EstimateStatement& s : a.statements) axes.back()["statements"].push_back(StatementJson(s));
  }
  return {{"problem", drift.problem.english},
          {"german", {{"problem", drift.problem.german}}},
          {"axes", std::move(axes)}};
}

std::string DriftText(const json& drift) {
  std::string text;
  if (const std::string problem = Word(drift, "problem"); !problem.empty())
    text += fmt::format("PROBLEM     drift is not watched: {}\n", problem);
  for (const json& a : drift.at("axes")) {
    std::vector<std::string> alarms = a.at("alarms");
    const std::string reason = Word(a, "health_reason");
    const bool alarms_say_it = reason == "alarms" || reason == "judged_good";
    text += fmt::format("health {} {}: {}{}\n", Word(a, "health"), Word(a, "name"),
                        alarms_say_it ? "" : Word(a, "health_text") + "; ",
                        alarms.empty() ? "no alarm stands" : fmt::format("{}", fmt::join(alarms, ", ")));
  }
  return text;
}

/// What is stored, what waits, and what keeps it from being stored.
std::string WriterText(const json& s, const std::string& counted) {
  const json &w = s.at("writer"), &inbox = s.at("inbox");
  const bool timed = Real(w, "latency_max_s") > 0;  // else no stroke, or a sender's clock that is no clock
  std::string text =
      fmt::format("writer      {}; {} {}s and {} rows stored, {} to estimate {}\n", Word(w, "state"),
                  Count(w, "strokes"), counted, Count(w, "rows"), counted,
                  timed ? fmt::format("p50 {:.1f} ms, p99 {:.1f} ms", Real(w, "latency_p50_s") * 1e3,
                                      Real(w, "latency_p99_s") * 1e3)
                        : "not known");
  text += fmt::format("disk        {} MB free, database {} MB\n", Count(w, "free_bytes") >> 20,
                      Count(w, "database_bytes") >> 20);
  text += fmt::format(
      "queues      {} batches before the pipeline, {} steps ({} kB) before the disk; "
      "dropped {} batches, {} rows, {} {}s\n",
      Count(inbox, "batches"), Count(w, "waiting_items"), Count(w, "waiting_bytes") >> 10,
      Count(inbox, "dropped_batches"), Count(w, "dropped_rows"), Count(w, "dropped_strokes"), counted);
  for (const auto& [title, said] : {std::pair{"PROBLEM     ", Word(w, "problem")},
                                    {"NEW DATABASE ", Word(w, "begun_anew")},
                                    {"last reload ", Word(s, "limits")},
                                    {"valve check ", Word(s, "valve_check")}})
    if (!said.empty()) text += title + said + "\n";
  return text;
}

/// Sources, the clocks of their senders, and senders that are not believed.
std::string SourcesText(const json& s) {
  std::string text;
  for (const json& source : s.at("sources"))
    text += fmt::format("source {}: {}; {}; {} rows, {} lost, {} reconnects, {} timeouts, {} malformed\n",
                        Printable(Word(source, "name")), Printable(Word(source, "state")),
                        source.at("age_s").is_number() ? fmt::format("last {} ago", Age(source.at("age_s")))
                                                       : "nothing came yet",
                        Count(source, "rows"), Count(source, "lost_rows"), Count(source, "reconnects"),
                        Count(source, "timeouts"), Count(source, "malformed"));
  for (const json& stream : s.at("streams"))
    if (stream.at("clock_offset_s").is_number())
      text += fmt::format(
          "sender of {} channels: clock {:+.3f} ms from ours, drift {:+.1f} ppm, "
          "delay {:.1f} ms (worst {:.1f} ms)\n",
          Count(stream, "channels"), -Real(stream, "clock_offset_s") * 1e3, -Real(stream, "drift_ppm"),
          Real(stream, "delay_s") * 1e3, Real(stream, "worst_delay_s") * 1e3);
  for (const json& sender : s.at("senders"))
    if (const auto refused = sender.at("refused_channels").size(); refused > 0)
      text += fmt::format(
          "TWO SENDERS {} (session {}) is not believed: {} of its channels, {} for example, come from "
          "another one; {} rows left out\n",
          Printable(Word(sender, "name").empty() ? "a sender" : Word(sender, "name")),
          sender.at("session").get<std::uint64_t>(), refused,
          sender.at("refused_channels").front().get<std::string>(), Count(sender, "refused_rows"));
  return text;
}

std::string FeedsText(const json& feeds) {
  std::string text;
  for (const json& feed : feeds)
    text +=
        fmt::format("feed {}: {}; {}; journal row {}, {} behind; {}\n", Printable(Word(feed, "name")),
                    Printable(Word(feed, "state")), Counted(feed.at("clients").get<int>(), "client"),
                    Count(feed, "delivered"), Count(feed, "behind"), Counted(Count(feed, "errors"), "error"));
  return text;
}

std::string ChannelTable(const json& channels) {
  std::string text = fmt::format("\n{:<22} {:>9} {:>9} {:>13} {:>13} {:>8}\n", "channel", "rate", "age",
                                 "value", "noise", "flagged");
  for (const json& c : channels)
    text += fmt::format("{:<22} {:>6.0f} Hz {:>9} {:>13} {:>13} {:>8}{}\n", Word(c, "name"),
                        Real(c, "rate_hz"), Age(c.at("age_s")), Shown(c.at("value"), Word(c, "unit")),
                        NoiseShown(c.at("noise_std"), Word(c, "unit")), Count(c, "flagged"),
                        c.at("stale").get<bool>() ? "  STALE" : "");
  return text;
}

/// "12331 ± 420 bar", as `fit` prints it.
std::string EstimateShown(const MachineKind& kind, const std::string& name, const json& e) {
  if (!e.at("value").is_number() || !e.at("std").is_number()) return Shown(e.at("value"), Word(e, "unit"));
  return ParameterWithInterval(kind, name, Real(e, "value"), Real(e, "std"), Word(e, "unit"));
}

std::string AxesText(const json& axes, const std::string& counted, const MachineKind& kind) {
  std::string text;
  for (const json& a : axes) {
    text += fmt::format("\n{}: {} {}s", Word(a, "name"), Count(a, "strokes"), counted);
    for (const auto& [name, e] : a.at("estimates").items())
      text += fmt::format(", {} {}", name, EstimateShown(kind, name, e));
    for (const auto& [name, e] : a.at("estimates").items())
      if (e.contains("why")) text += fmt::format("\n  {} NOT IDENTIFIABLE: {}", name, Word(e, "why"));
    for (const std::string warning : a.at("warnings")) text += "\n  WARNING: " + warning;
    text += "\n ";
    for (const auto& [name, count] : a.at("counters").items())
      if (count.get<std::int64_t>() != 0) text += fmt::format(" {} {}", name, count.get<std::int64_t>());
    text += "\n";
  }
  return text;
}

/// Of the writer and its queues.
void AddWriter(const LiveStatus& s, Metrics& m) {
  const WriterStatus& w = s.writer;
  m.Begin("writer_state", "gauge", "1 for the state the writer is in.");
  for (const WriterState state : {WriterState::kWriting, WriterState::kDiskFull, WriterState::kLocked,
                                  WriterState::kGone, WriterState::kDamaged, WriterState::kFailing})
    m.Add(w.state == state, fmt::format("state=\"{}\"", WriterStateName(state)));
  m.One("disk_free_bytes", "gauge", "Free where the database lies.", w.free_bytes);
  m.One("strokes_stored_total", "counter", "Strokes stored.", w.strokes);
  m.One("rows_stored_total", "counter", "Raw rows stored.", w.rows);
  m.Begin("dropped_total", "counter", "What did not fit into a queue.");
  m.Add(s.inbox.dropped_values, "queue=\"inbox\",what=\"values\"");
  m.Add(w.dropped_rows, "queue=\"writer\",what=\"rows\"");
  m.Add(w.dropped_strokes, "queue=\"writer\",what=\"strokes\"");
  m.Begin("queue_depth", "gauge", "What waits: batches before the pipeline, steps before the disk.");
  m.Add(s.inbox.batches, "queue=\"inbox\"");
  m.Add(w.waiting_items, "queue=\"writer\"");
  m.Begin("stroke_latency_seconds", "gauge",
          "From the sending of the sample that ends a stroke to its estimate stored.");
  m.Add(w.latency_p50, "quantile=\"0.5\"");
  m.Add(w.latency_p99, "quantile=\"0.99\"");
}

void AddSources(const std::vector<SourceStatus>& sources, Metrics& m) {
  m.Each("source_connected", "gauge", "1 while a sender is there.", sources, "source",
         &SourceStatus::connected);
  m.Each("source_rows_total", "counter", "Rows received.", sources, "source", &SourceStatus::rows);
  m.Begin("source_faults_total", "counter",
          "Lost rows, reconnects, timeouts, exceptions, malformed messages.");
  for (const SourceStatus& source : sources)
    for (const auto& [kind, count] : {std::pair{"lost_rows", source.lost_rows},
                                      {"reconnects", source.reconnects},
                                      {"timeouts", source.timeouts},
                                      {"exceptions", source.exceptions},
                                      {"malformed", source.malformed}})
      m.Add(count, fmt::format("source=\"{}\",kind=\"{}\"", Label(source.name), kind));
}

void AddAxes(const std::vector<AxisStatus>& axes, Metrics& m) {
  m.Begin("axis_events_total", "counter", "What the aligner counted.");
  for (const AxisStatus& axis : axes) {
    const json counters = CountersJson(axis.counters);
    for (const auto& [event, count] : counters.items())
      m.Add(count.get<double>(), fmt::format("axis=\"{}\",event=\"{}\"", Label(axis.name), event));
  }
  m.Each("axis_last_stroke_seconds", "gauge", "End of the last stroke, since 1970.", axes, "axis",
         &AxisStatus::last_stroke);
  m.Begin("estimate", "gauge", "Parameter after the last stroke, SI.");
  for (const AxisStatus& axis : axes)
    for (const Estimate& e : axis.estimates)
      m.Add(e.value, fmt::format("axis=\"{}\",parameter=\"{}\"", Label(axis.name), Label(e.parameter)));
}

void AddHealth(const std::vector<AxisHealth>& axes, Metrics& m) {
  m.Begin("axis_health", "gauge", "NAMUR NE 107: 1 for the state the axis is in.");
  for (const AxisHealth& a : axes)
    for (const char state : {'-', 'M', 'S', 'C', 'F'})
      m.Add(a.health.letter() == state, fmt::format("axis=\"{}\",health=\"{}\"", Label(a.name), state));
  m.Begin("axis_health_reason", "gauge", "1 for what the health comes from.");
  for (const AxisHealth& a : axes)
    m.Add(1, fmt::format("axis=\"{}\",reason=\"{}\"", Label(a.name), HealthReasonName(a.health.reason)));
  m.Each("axis_alarms", "gauge", "Alarms that are not at rest.", axes, "axis",
         [](const AxisHealth& a) { return a.alarms.size(); });
}

}  // namespace

json StatusJson(const LiveStatus& s) {
  json out = {{"machine", s.machine},
              {"database", s.database},
              {"state", s.state},
              {"counted", s.counted.one},
              {"kind", s.kind},
              {"uptime_s", s.uptime},
              {"limits", s.limits.english},
              {"malformed", s.malformed},
              {"heartbeats", s.heartbeats},
              {"cpu_s", s.cpu},
              {"memory_bytes", s.memory},
              {"descriptors", s.descriptors},
              {"valve_check", s.valve_check.english},
              {"german", {{"limits", s.limits.german}, {"valve_check", s.valve_check.german}}}};
  for (const char* list : {"sources", "streams", "senders", "channels", "axes", "feeds"})
    out[list] = json::array();
  for (std::size_t i = 0; i < s.sources.size(); ++i)
    out["sources"].push_back(SourceJson(s.sources[i], s.source_ages[i]));
  for (const StreamState& stream : s.streams) out["streams"].push_back(StreamJson(stream));
  for (const SenderStatus& sender : s.senders) out["senders"].push_back(SenderJson(sender));
  for (const ChannelStatus& channel : s.channels) out["channels"].push_back(ChannelJson(channel));
  for (const AxisStatus& axis : s.axes) {
    const auto known = std::ranges::find(s.drift.axes, axis.name, &AxisHealth::name);
    out["axes"].push_back(
        AxisJson(axis, known == s.drift.axes.end() ? std::vector<EstimateStatement>{} : known->statements));
  }
  for (const FeedStatus& feed : s.feeds) out["feeds"].push_back(FeedJson(feed));
  out["inbox"] = {{"batches", s.inbox.batches},
                  {"values", s.inbox.values},
                  {"most_values", s.inbox.most_values},
                  {"dropped_batches", s.inbox.dropped_batches},
                  {"dropped_values", s.inbox.dropped_values}};
  for (std::size_t i = 0; i < s.sources.size(); ++i) {
    const auto dropped = s.inbox.dropped_by_source.find(static_cast<int>(i));
    out["sources"][i]["dropped_values"] = dropped == s.inbox.dropped_by_source.end() ? 0 : dropped->second;
  }
  out["writer"] = WriterJson(s.writer);
  out["drift"] = DriftJson(s.drift);
  out["log"] = json::array();
  for (const LogLine& line : s.log)
    out["log"].push_back({{"wall_s", line.wall}, {"level", line.level}, {"text", Printable(line.text)}});
  return out;
}

std::string StatusText(const json& s) {
  const auto counted = s.value("counted", std::string("stroke"));  // an older service does not say
  Machine machine;
  machine.model = s.value("kind", std::string());
  return fmt::format("{} {}, up {}, database {}\n", Word(s, "machine"), Word(s, "state"),
                     Age(s.at("uptime_s")), Word(s, "database")) +
         WriterText(s, counted) +
         fmt::format("process     {:.1f} s of processor, {} MB, {} descriptors\n\n", Real(s, "cpu_s"),
                     Count(s, "memory_bytes") >> 20, Count(s, "descriptors")) +
         SourcesText(s) + FeedsText(s.at("feeds")) + DriftText(s.at("drift")) +
         ChannelTable(s.at("channels")) + AxesText(s.at("axes"), counted, KindOf(machine));
}

std::string PrometheusText(const LiveStatus& s) {
  Metrics m;
  m.One("uptime_seconds", "gauge", "Since the service began.", s.uptime);
  m.One("heartbeats_total", "counter", "Rounds of the pipeline.", s.heartbeats);
  AddWriter(s, m);
  AddSources(s.sources, m);
  m.Each("channel_age_seconds", "gauge", "Since the last value.", s.channels, "channel", &ChannelStatus::age);
  m.Each("channel_rate_hertz", "gauge", "Values per second.", s.channels, "channel", &ChannelStatus::rate);
  m.Each("channel_senders", "gauge", "Senders of the channel at the same time.", s.channels, "channel",
         &ChannelStatus::senders);
  AddAxes(s.axes, m);
  m.Each("feed_connected", "gauge", "1 while the feed can be heard.", s.feeds, "feed",
         &FeedStatus::connected);
  m.Each("feed_rows_behind", "gauge", "Journal rows not out yet.", s.feeds, "feed", &FeedStatus::behind);
  m.Each("feed_errors_total", "counter", "Rounds of the feed that failed.", s.feeds, "feed",
         &FeedStatus::errors);
  AddHealth(s.drift.axes, m);
  m.One("process_resident_bytes", "gauge", "Memory of the process.", s.memory);
  m.One("process_descriptors", "gauge", "Open files of the process.", s.descriptors);
  m.One("process_cpu_seconds_total", "counter", "Processor time of the process.", s.cpu);
  return m.Take();
}

}  // namespace hydroscope
