#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "acquisition/aligner.h"
#include "acquisition/source.h"
#include "alarms/feeds/feed.h"
#include "core/told.h"
#include "live/drift_watch_status.h"
#include "live/inbox.h"
#include "live/log.h"
#include "live/writer.h"
#include "models/counted_words.h"

namespace hydroscope {

/// A channel as `hydroscope status` shows it.
struct ChannelStatus {
  std::string name;          ///< "cushion_1/p_A"
  std::string unit;          ///< SI
  double rate = 0;           ///< values per s, over the last seconds
  double age = 0;            ///< s since the last value; NaN: never came
  double value = 0;          ///< SI, newest
  double noise_std = 0;      ///< SI; NaN: not known
  std::int64_t flagged = 0;  ///< values with any quality flag, in the present run
  bool stale = false;        ///< older than two periods
  bool usable = true;        ///< the newest value is a number within the limits of the machine file
  int axis = 0;
  bool required = false;  ///< the model cannot do without it
  int senders = 0;        ///< that send it at the same time; more than one: only the first is believed
};

/// Somebody who sends.
struct SenderStatus {
  SenderId id;
  std::string name;                  ///< "simulated press at 192.168.0.7"; "" if the source tells none
  double age = 0;                    ///< s since its newest batch
  std::int64_t rows = 0;             ///< taken
  std::int64_t refused_rows = 0;     ///< rows with values that are another sender's to send
  std::size_t channels = 0;          ///< that it sends and that are believed
  std::vector<std::string> refused;  ///< channels of which another one is believed
  std::set<int> axes, refused_axes;  ///< where it is believed, and where another one
};

struct AxisStatus {
  std::string name;  ///< "press/cushion_1"
  AlignerCounters counters;
  std::int64_t strokes = 0;         ///< since the start
  double last_stroke = 0;           ///< s since 1970, its end; NaN: none yet
  std::vector<Estimate> estimates;  ///< of the last stroke, as they are stated (EstimateStatement)
  std::vector<Told> warnings = {};  ///< AxisPipeline::doubts, DoubtsOf these estimates
};

/// Everything the service tells about itself.
struct LiveStatus {
  std::string machine, database, state;  ///< state: "running", "stopping"
  CountedWords counted;                  ///< what the machine is judged by
  std::string kind;                      ///< of the machine, "die_cushion"
  double uptime = 0;                     ///< s
  std::int64_t taken = 0;                ///< ns, monotonic, when channels and axes were looked at
  Told limits;                           ///< result of the last reload, "" = none yet
  std::vector<SourceStatus> sources;
  std::vector<double> source_ages;  ///< s since each source received something; NaN: never
  std::vector<StreamState> streams;
  std::vector<SenderStatus> senders;  ///< heard within the last seconds
  std::vector<ChannelStatus> channels;
  std::vector<AxisStatus> axes;
  Inbox::Counters inbox;
  std::int64_t malformed = 0;
  WriterStatus writer;
  std::int64_t heartbeats = 0;  ///< rounds of the pipeline's thread
  double cpu = 0;               ///< s of processor time of the process
  std::int64_t memory = 0;      ///< bytes resident
  int descriptors = 0;          ///< open files
  Told valve_check;             ///< what it does now, "" = off
  std::vector<FeedStatus> feeds;
  DriftWatchStatus drift;
  std::vector<LogLine> log;  ///< its newest lines, oldest first
};

nlohmann::json StatusJson(const LiveStatus& status);
/// Prometheus text format 0.0.4.
std::string PrometheusText(const LiveStatus& status);
/// For people, from the JSON.
std::string StatusText(const nlohmann::json& status);

}  // namespace hydroscope
