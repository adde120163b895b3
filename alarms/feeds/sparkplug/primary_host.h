#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace hydroscope::sparkplug {

/// What a host application says of itself, retained, on its topic: {"online": true, "timestamp":
/// 1700000000000} (Sparkplug 3.0, STATE message).
struct HostState {
  bool online = false;
  std::int64_t timestamp = 0;  ///< ms since 1970, when the host's session began; its will carries the same
};
/// nullopt: these bytes are no such message.
std::optional<HostState> ParseHostState(const std::string& payload);

/// Whether the host application that a node waits for is there. A message older than the newest one says
/// nothing: it is of an earlier session of the host.
class PrimaryHost {
 public:
  /// "" = none is waited for.
  explicit PrimaryHost(std::string id) : id_(std::move(id)) {}

  const std::string& id() const { return id_; }
  bool is_waited_for() const { return !id_.empty(); }
  /// "spBv1.0/STATE/<id>".
  std::string Topic() const { return "spBv1.0/STATE/" + id_; }
  /// Nothing is known yet of a connection just made.
  void Forget() { newest_.reset(); }
  /// False: the message is no state, or an old one, and changes nothing.
  bool Take(const std::string& payload);
  bool online() const { return !is_waited_for() || (newest_ && newest_->online); }
  /// Began the host's session, ms since 1970; 0 if it is not known.
  std::int64_t session() const { return newest_ ? newest_->timestamp : 0; }

 private:
  std::string id_;
  std::optional<HostState> newest_;
};

}  // namespace hydroscope::sparkplug
