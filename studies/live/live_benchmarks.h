#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace hydroscope {

/// Campaigns of `hydroscope serve` against a simulated press in a process of its own. Each prints a table,
/// says what was required and returns 0 if it was reached, else 1.

struct LiveLatencyOptions {
  int axes = 4;
  double rate = 1000, seconds = 60;
  bool ring = false;
  std::uint64_t seed = 1;
  std::int64_t history = 0;  ///< strokes of each axis that the database holds already
  std::int64_t grams = std::numeric_limits<std::int64_t>::max();  ///< newest of these that have their Grams
  std::string folder = "";  ///< kept, with a database that the next run begins on; "" = a temporary one
};
/// Stroke sent to estimate stored, processor share, loss; then the raw window against its replay.
int RunLiveLatency(const LiveLatencyOptions& options);

struct LiveKillOptions {
  int times = 20;
  std::string transport = "default";  ///< of DDS
  std::uint64_t seed = 1;
};
/// kill -9 at random times under load; every step that was acknowledged must be there once.
int RunLiveKill(const LiveKillOptions& options);

struct LiveFaultOptions {
  bool long_cuts = false;
  bool brief = false;  ///< only what takes seconds, and only what an operator sees
  std::uint64_t seed = 1;
};
/// Senders killed, hung, talking nonsense; clock stepped; disk full.
int RunLiveFaults(const LiveFaultOptions& options);
/// The second table of it: faults of every kind, and where an operator saw them after how long.
int RunOperatorFaults(const LiveFaultOptions& options);

struct LiveNetworkOptions {
  double cut = 60;  ///< s, the longer of the two cuts
  std::uint64_t seed = 1;
};
/// Press and service in network namespaces of their own, joined by a wire that loses, delays, reorders and is
/// cut. Where namespaces are not allowed it says so and returns 0.
int RunLiveNetwork(const LiveNetworkOptions& options);

struct LiveSoakOptions {
  double minutes = 30;
  std::uint64_t seed = 1;
};
/// Memory and descriptors over time at full rates.
int RunLiveSoak(const LiveSoakOptions& options);

}  // namespace hydroscope
