#pragma once

#include <memory>

#include "acquisition/dds/settings.h"
#include "acquisition/source.h"
#include "dds/participant.h"
#include "models/machine.h"

namespace hydroscope {

struct DdsSourceOptions {
  DdsSpec spec;
  std::vector<std::string> wanted;  ///< DDS name of each channel of the source, "" = not from DDS
  /// s without a batch after which the participant is made anew; doubles up to 60 s while none comes, and
  /// begins again with each sender that is found.
  double deaf_after = 1.0;
};
/// How the settings find their sender.
DdsNetwork NetworkOf(const DdsSpec& spec);

/// Settings for the channels of a live machine (LiveChannels).
DdsSourceOptions DdsOptionsFor(const Machine& machine);

/// Samples by DDS: reliable, of any number of senders, each with its own session and sequence. Liveliness,
/// deadline and a watchdog that builds everything anew when nothing comes; docs/live_protocol.md.
std::unique_ptr<Source> MakeDdsSource(DdsSourceOptions options, Clock clock);

}  // namespace hydroscope
