#include <signal.h>

#include <algorithm>

#include "host/output.h"
#include "live/process_use.h"
#include "studies/live/live_benchmarks.h"
#include "studies/live/live_rig.h"

namespace hydroscope {

int RunLiveSoak(const LiveSoakOptions& o) {
  LiveRig rig({.seed = o.seed, .folder = {}});
  // The raw window fills and turns over within the soak.
  if (const Status begun = rig.Begin({"--raw-gb", "0.02"}); !begun) return ReportError(begun.error());
  fmt::print("{:>8} {:>12} {:>12} {:>12} {:>10} {:>10}\n", "minute", "memory MB", "descriptors",
             "database MB", "strokes", "p99 ms");
  struct Point {
    double minute, memory;
    int descriptors;
  };
  std::vector<Point> points;
  const double begin = Now(), step = std::max(5.0, o.minutes * 60 / 30);
  while (Now() - begin < o.minutes * 60) {
    Sleep(std::min(step, o.minutes * 60));
    const auto status = rig.Ask();
    if (!status) return ReportError({ErrorKind::kInternal, "the service does not answer any more"});
    const ProcessUse use = UseOf(std::to_string(rig.service().pid()));
    points.push_back({(Now() - begin) / 60, static_cast<double>(use.memory) / (1 << 20), use.descriptors});
    const auto& writer = status->at("writer");
    fmt::print("{:>8.1f} {:>12.1f} {:>12} {:>12} {:>10} {:>10.1f}\n", points.back().minute,
               points.back().memory, use.descriptors, writer.at("database_bytes").get<std::int64_t>() >> 20,
               writer.at("strokes").get<std::int64_t>(), writer.at("latency_p99_s").get<double>() * 1e3);
    std::fflush(stdout);
  }
  const int ended = rig.service().End(SIGTERM);
  if (points.size() < 3) return ended == 0 ? 0 : 1;
  const std::size_t third = points.size() / 3;
  const Point &early = points[third], &late = points.back();
  const double growth = late.memory - early.memory;
  const int more = late.descriptors - early.descriptors;
  fmt::print(
      "after the first third: memory {:+.1f} MB (required below +10 MB), descriptors {:+d} (required at most +2)\n",
      growth, more);
  return growth < 10 && more <= 2 && ended == 0 ? 0 : 1;
}

}  // namespace hydroscope
