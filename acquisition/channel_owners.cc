#include "acquisition/channel_owners.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hydroscope {
namespace {

constexpr std::int64_t kBatchesAllowed = 3;      ///< batches of a slow sender that may be lacking
constexpr std::int64_t kTogether = 250'000'000;  ///< ns two send side by side before that is told

}  // namespace

ChannelOwners::ChannelOwners(std::size_t channels, double takeover)
    : takeover_(std::llround(takeover * 1e9)), owners_(channels), rivals_(channels) {}

/// The sender, made if new; in place of one that nobody heeds if there are too many.
int ChannelOwners::IndexOf(const SenderId& id, std::int64_t now) {
  const auto found =
      std::find_if(senders_.begin(), senders_.end(), [&](const Known& known) { return known.id == id; });
  if (found != senders_.end()) {
    found->heard = now;
    return static_cast<int>(found - senders_.begin());
  }
  if (senders_.size() < owners_.size() + kStrangersKept) {
    senders_.push_back({.id = id, .heard = now});
    return static_cast<int>(senders_.size()) - 1;
  }
  const auto owns = [&](const Known& known) {
    return std::any_of(owners_.begin(), owners_.end(), [&](const Owner& o) {
      return o.sender == static_cast<int>(&known - senders_.data());
    });
  };
  // Who is believed stays known however many others come by in between.
  const auto oldest = std::min_element(senders_.begin(), senders_.end(), [&](const Known& a, const Known& b) {
    return std::pair(owns(a), a.heard) < std::pair(owns(b), b.heard);
  });
  const int place = static_cast<int>(oldest - senders_.begin());
  for (Owner& owner : owners_)
    if (owner.sender == place) owner = {};
  for (auto& rivals : rivals_) std::erase_if(rivals, [&](const Rival& r) { return r.sender == place; });
  *oldest = {.id = id, .heard = now};
  return place;
}

const std::vector<std::size_t>& ChannelOwners::Admit(int source, const SampleBatch& batch) {
  const std::int64_t now = batch.received.monotonic_ns;
  const int sender = IndexOf({source, batch.writer, batch.session}, now);
  const std::int64_t allowed =
      std::max(takeover_, kBatchesAllowed * batch.period_ns * static_cast<std::int64_t>(batch.rows));
  columns_.clear();
  for (std::size_t column = 0; column < batch.channels.size(); ++column)
    if (Admit(batch.channels[column], sender, now, allowed)) columns_.push_back(column);
  Known& known = senders_[static_cast<std::size_t>(sender)];
  const auto rows = static_cast<std::int64_t>(batch.rows);
  if (!columns_.empty()) known.rows += rows;
  if (columns_.size() < batch.channels.size()) known.refused_rows += rows;
  return columns_;
}

bool ChannelOwners::Admit(std::size_t channel, int sender, std::int64_t now, std::int64_t allowed) {
  Owner& owner = owners_[channel];
  auto& rivals = rivals_[channel];
  const auto same = [&](const Rival& rival) { return rival.sender == sender; };
  if (owner.sender >= 0 && owner.sender != sender && now - owner.heard < owner.allowed) {
    auto rival = std::find_if(rivals.begin(), rivals.end(), same);
    if (rival == rivals.end()) {
      if (rivals.size() == kRivalsKept) rivals.erase(rivals.begin());
      rival = rivals.insert(rivals.end(), {.sender = sender, .since = now});
    }
    rival->heard = now;
    return false;
  }
  if (owner.sender != sender && !rivals.empty()) std::erase_if(rivals, same);
  for (Rival& rival : rivals) rival.told = rival.told || now - rival.since > kTogether;
  owner = {sender, now, allowed};
  return true;
}

bool ChannelOwners::Stands(const Rival& rival, std::int64_t now) {
  return rival.told && static_cast<double>(now - rival.heard) < kRemembered * 1e9;
}

int ChannelOwners::count(std::size_t channel, std::int64_t now) const {
  if (owners_[channel].sender < 0) return 0;
  return 1 + static_cast<int>(std::count_if(rivals_[channel].begin(), rivals_[channel].end(),
                                            [&](const Rival& r) { return Stands(r, now); }));
}

std::vector<LiveSender> ChannelOwners::senders(std::int64_t now) const {
  std::vector<LiveSender> live;
  for (std::size_t s = 0; s < senders_.size(); ++s) {
    const Known& known = senders_[s];
    if (static_cast<double>(now - known.heard) >= kRemembered * 1e9) continue;
    LiveSender sender{known.id, known.heard, known.rows, known.refused_rows, {}, {}};
    for (std::size_t c = 0; c < owners_.size(); ++c) {
      if (owners_[c].sender == static_cast<int>(s)) sender.taken.push_back(c);
      for (const Rival& rival : rivals_[c])
        if (rival.sender == static_cast<int>(s) && Stands(rival, now)) sender.refused.push_back(c);
    }
    live.push_back(std::move(sender));
  }
  std::stable_partition(live.begin(), live.end(), [](const LiveSender& s) { return !s.taken.empty(); });
  return live;
}

}  // namespace hydroscope
