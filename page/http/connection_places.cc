#include "page/http/connection_places.h"

#include <utility>

namespace hydroscope {

ConnectionPlaces::Id ConnectionPlaces::Opened(const std::string& address, std::function<void()> close) {
  const Id id = ++turn_;
  open_[id] = {address, std::move(close), Use::kNothing, id};
  KeepTo(limits_.of_one_address, id, &address);
  KeepTo(limits_.all, id, nullptr);
  return id;
}

void ConnectionPlaces::Uses(Id id, Use use) {
  const auto found = open_.find(id);
  if (found == open_.end() || found->second.use == use) return;
  found->second.use = use;
  found->second.since = ++turn_;
}

void ConnectionPlaces::Closed(Id id) { open_.erase(id); }

/// Has one leave if there are more than `limit` (of this address alone): the one that has been longest at what is worth least.
void ConnectionPlaces::KeepTo(std::size_t limit, Id newest, const std::string* address) {
  std::size_t there = 0, ask_nothing = 0;
  const auto counts = [&](const Connection& c) {
    return !c.leaves && (address == nullptr || c.address == *address);
  };
  for (const auto& [id, connection] : open_) {
    if (!counts(connection)) continue;
    ++there;
    ask_nothing += connection.use == Use::kNothing;
  }
  if (there <= limit) return;
  // Who has just come needs a moment to ask: the last ones that did stay until others leave.
  const bool spare_new = ask_nothing <= limit / 4;
  Connection* leaves = nullptr;
  const auto worth = [&](const Connection& c) {
    const bool spared = spare_new && c.use == Use::kNothing;
    return std::pair(spared ? static_cast<int>(Use::kUser) : static_cast<int>(c.use), c.since);
  };
  for (auto& [id, connection] : open_)
    if (counts(connection) && connection.use != Use::kUser && id != newest &&
        (leaves == nullptr || worth(connection) < worth(*leaves)))
      leaves = &connection;
  if (leaves == nullptr) leaves = &open_[newest];
  leaves->leaves = true;
  leaves->close();
}

}  // namespace hydroscope
