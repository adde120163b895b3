#pragma once

#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "alarms/feeds/feed_reader.h"
#include "diagnosis/drift/temperature_model.h"
#include "monitor/axis_monitor.h"
#include "report/report_parameters.h"

namespace hydroscope {

/// What a picture of a parameter needs beside its values.
struct WatchedParameter {
  ParameterInfo info;
  /// ParameterInfo::name and ::sentence in German; "" = told in English alone.
  std::string german, german_sentence;
  std::string si;
  std::optional<drift::TemperatureModel> healthy;      ///< as learned; nothing: not learned, or not watched
  double smallest = 0;                                 ///< SI, change worth finding; 0: not watched
  std::vector<std::pair<std::string, double>> limits;  ///< of the machine file, SI: "warn_low", ...
};

/// Something that happened to a machine, for trends.
struct TrendMark {
  std::string kind;          ///< "alarm", "cleared", "reference", "model", "valve_check"
  std::int64_t stroke = -1;  ///< machine-wide; as many as there are: since the last one
  Told name, text;           ///< id of the alarm, "version 3"; a sentence
  double time = std::numeric_limits<double>::quiet_NaN();  ///< s; that of the stroke if it is not known
};

/// One machine of a database as the page shows it. Only reads. One object belongs to one thread.
class WatchedMachine {
 public:
  /// What it needs; all outlives the object.
  struct Sources {
    const Database& database;
    std::string path;
    AlarmJournal* journal;     ///< nullptr: there is none
    std::string machine_file;  ///< beside which the rules file lies; "" = built-in rules
  };
  /// Errors: the model stored last, or the rules, cannot be read.
  static Result<std::unique_ptr<WatchedMachine>> Create(const Sources& sources, const std::string& name,
                                                        std::int64_t id);

  /// Takes over what was stored since. `told`: health as a running service tells it (an axis of StatusJson's `drift`); null:
  /// nobody does, and it is judged from the journal.
  Status Refresh(const nlohmann::json& told);

  const std::string& name() const { return name_; }
  std::int64_t id() const { return id_; }
  std::int64_t end() const { return end_; }
  bool dated() const { return dated_; }
  int model_version() const { return model_version_; }
  /// As feeds see it, without alarms.
  const AxisPicture& picture() const { return picture_; }
  /// As the model stored last describes it: its [feeds], and the name of the press.
  const Machine& described() const { return described_; }
  /// docs/page.md, `watch/overview`.
  const nlohmann::json& json() const { return json_; }
  /// What the effects of its library are called, in addition to those that stand there: `id`, `title`, `german`.
  void AddTitles(nlohmann::json& effects) const;
  const std::map<std::string, WatchedParameter>& parameters() const { return parameters_; }
  /// Model changes and valve checks, in order.
  const std::vector<TrendMark>& marks() const { return marks_; }

 private:
  explicit WatchedMachine(const Sources& sources) : sources_(sources) {}
  Status ReadRuns();
  Status ReadValveChecks();
  Status StateLatest(const nlohmann::json& told, std::vector<TrendPoint>& latest);
  Status DescribeParameters(const std::vector<TrendPoint>& latest);
  Result<nlohmann::json> ParametersJson(const std::vector<TrendPoint>& latest) const;
  nlohmann::json ReferenceJson(const std::string& parameter,
                               const std::vector<AxisMonitor::JudgedValue>& judged) const;
  hydroscope::Health Health() const;

  Sources sources_;
  std::string name_;
  std::int64_t id_ = 0, end_ = 0;
  int model_version_ = 0;
  bool dated_ = false;  ///< times count from 1970
  std::size_t runs_ = 0;
  Machine described_;
  Machine machine_;  ///< the same by the name it has in the database
  std::shared_ptr<const ModelStructure> model_;
  drift::RuleBook rules_;  ///< of its kind; what the monitor goes by
  std::unique_ptr<AxisMonitor> monitor_;
  std::string not_looked_;  ///< why the monitor could not be read
  std::map<std::string, WatchedParameter> parameters_;
  std::vector<EstimateStatement> statements_;  ///< how estimates are stated
  std::vector<Told> doubts_;                   ///< DoubtsOfNewest, and what a service tells of it
  std::int64_t stated_to_ = -1;                ///< strokes there were when that was asked here; -1: never
  std::vector<TrendMark> marks_;
  AxisPicture picture_;
  nlohmann::json json_;
};

}  // namespace hydroscope
