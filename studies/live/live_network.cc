#include <signal.h>

#include "host/output.h"
#include "studies/fault_table.h"
#include "studies/live/impaired_wire.h"
#include "studies/live/live_benchmarks.h"

namespace hydroscope {
namespace {

constexpr double kImpaired = 20.0;  // s that the wire stays impaired

/// The wire is bad for a while: no row may be missing, and the service must go on.
void Impair(LiveRig& rig, ImpairedWire& wire, FaultTable& table, const char* what,
            const Impairment& impairment) {
  const auto before = rig.Ask();
  wire.Set(impairment);
  Sleep(kImpaired);
  const auto after = rig.Ask();
  wire.Set({});
  if (!before || !after) return table.Row(what, {}, {}, false, "the service does not answer");
  const auto passed = [&](const char* counter) {
    return SumOverAxes(*after, counter) - SumOverAxes(*before, counter);
  };
  const std::int64_t missing = passed("missing_rows") + passed("skipped_rows");
  table.Row(what, {}, {}, missing == 0 && passed("rows") > 0,
            fmt::format("{} rows, {} missing", passed("rows"), missing));
  Sleep(2);
}

}  // namespace

int RunLiveNetwork(const LiveNetworkOptions& o) {
  const auto wire = ImpairedWire::Create(o.seed);
  if (!wire) {
    fmt::print("not tried: {}\n", wire.error().text);
    return 0;
  }
  LiveRig rig({.seed = o.seed,
               .transport = "udp",
               .folder = {},
               .press_address = ImpairedWire::kAddresses[0],
               .service_address = ImpairedWire::kAddresses[1],
               .press_network = (*wire)->network(0),
               .service_network = (*wire)->network(1)});
  if (const Status begun = rig.Begin(); !begun) return ReportError(begun.error());
  FaultTable table(rig);
  Impair(rig, **wire, table, "5 % of the frames lost", {.loss = 0.05});
  Impair(rig, **wire, table, "50 ms delay, a quarter overtakes", {.delay = 0.05, .overtaking = 0.25});
  Impair(rig, **wire, table, "all of that", {.loss = 0.05, .delay = 0.05, .overtaking = 0.25});
  const auto cut = [&] { (*wire)->Set({.cut = true}); };
  const auto join = [&] { (*wire)->Set({}); };
  for (const double seconds : {5.0, o.cut}) {
    table.Cut(fmt::format("wire cut for {:g} s (DDS)", seconds), "p_A", seconds, cut, join);
    table.Cut(fmt::format("wire cut for {:g} s (Modbus)", seconds), "T_oil", seconds, cut, join);
  }
  const auto last = rig.Ask();
  const int ended = rig.service().End(SIGTERM);
  fmt::print("frames carried {}, lost {}; rows missing in all {}\n", (*wire)->carried(), (*wire)->lost(),
             last ? SumOverAxes(*last, "missing_rows") : -1);
  const auto same = ReplaysAreTheSame(rig.database(), ended);
  if (!same) return ReportError(same.error());
  return table.missed() == 0 && *same && ended == 0 ? 0 : 1;
}

}  // namespace hydroscope
