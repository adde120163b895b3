#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "acquisition/source.h"

namespace hydroscope {

/// One life of a sender: two messages come from the same one if all of this is the same.
struct SenderId {
  int source = 0;             ///< number of the source
  std::uint64_t writer = 0;   ///< SampleBatch::writer
  std::uint64_t session = 0;  ///< SampleBatch::session
  auto operator<=>(const SenderId&) const = default;
};

/// A sender that was heard a moment ago.
struct LiveSender {
  SenderId id;
  std::int64_t heard = 0;            ///< ns, monotonic, its newest batch
  std::int64_t rows = 0;             ///< taken
  std::int64_t refused_rows = 0;     ///< rows with values that were another sender's to send
  std::vector<std::size_t> taken;    ///< channels it sends
  std::vector<std::size_t> refused;  ///< channels it sends as well as the one that is believed
};

/// Whose values of a channel count. The first sender of a channel keeps it while it sends; another one is
/// refused, and takes its place as soon as the first has been silent for `takeover`. Without this, batches of
/// two senders would take turns in beginning the grid anew, and neither would ever give a row.
class ChannelOwners {
 public:
  /// `takeover` in s; of a sender of longer batches three of these.
  ChannelOwners(std::size_t channels, double takeover);

  /// Columns of the batch that count, in their order. All channels of the batch exist.
  const std::vector<std::size_t>& Admit(int source, const SampleBatch& batch);

  /// Senders heard within the last kRemembered s, the present owners first.
  std::vector<LiveSender> senders(std::int64_t now) const;
  /// Senders of the channel that send at the same time: 0, 1, or more.
  int count(std::size_t channel, std::int64_t now) const;

  static constexpr double kRemembered = 5.0;  ///< s a refused sender counts as there

 private:
  struct Owner {
    int sender = -1;           ///< index into senders_; -1: nobody
    std::int64_t heard = 0;    ///< ns, its newest batch with this channel
    std::int64_t allowed = 0;  ///< ns it may be silent
  };
  struct Rival {
    int sender = -1;
    std::int64_t since = 0, heard = 0;  ///< ns
    bool told = false;                  ///< the owner has sent since the rival began
  };
  static constexpr std::size_t kStrangersKept = 32;  ///< senders that own no channel
  static constexpr std::size_t kRivalsKept = 4;      ///< of a channel

  int IndexOf(const SenderId& id, std::int64_t now);
  bool Admit(std::size_t channel, int sender, std::int64_t now, std::int64_t allowed);
  static bool Stands(const Rival& rival, std::int64_t now);

  std::int64_t takeover_;
  struct Known {
    SenderId id;
    std::int64_t heard = 0, rows = 0, refused_rows = 0;
  };
  std::vector<Known> senders_;
  std::vector<Owner> owners_;               ///< by channel
  std::vector<std::vector<Rival>> rivals_;  ///< by channel
  std::vector<std::size_t> columns_;        ///< of the last batch
};

}  // namespace hydroscope
