#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// Version of the outbox's tables, in `PRAGMA user_version`; docs/sparkplug.md describes them.
inline constexpr int kOutboxFormat = 1;
/// "HYDO", in `PRAGMA application_id`.
inline constexpr int kOutboxApplicationId = 0x4859444f;

/// A message that waits for somebody outside to take it.
struct OutboxItem {
  std::int64_t sequence = 0;  ///< of the journal row it tells
  std::string topic;
  std::string payload;
};

/// Store and forward: what was made of the journal and not yet taken by the other side, in a file of its own.
/// Items are put in the order of the journal and removed when they were acknowledged, so that each reaches
/// the other side at least once, whatever is killed when. WAL, synchronous=NORMAL: what a loss of power takes
/// is made again from the journal. Errors as of Database.
class Outbox {
 public:
  /// "press.db" -> "press.outbox.db".
  static std::string PathFor(const std::string& database);
  static Result<Outbox> Open(const std::string& path);
  Outbox(Outbox&&) noexcept;
  Outbox& operator=(Outbox&&) noexcept;
  ~Outbox();

  /// Journal sequence up to which everything was put; 0 at the beginning.
  Result<std::int64_t> Cursor() const;
  /// Puts items and moves the cursor in one transaction. An item or a cursor that is not ahead of the cursor
  /// is an error.
  Status Put(const std::vector<OutboxItem>& items, std::int64_t cursor);
  /// Items with sequence > `after` in order, at most `limit`.
  Result<std::vector<OutboxItem>> Items(std::int64_t after, std::int64_t limit) const;
  Result<std::int64_t> Count() const;
  Status Remove(const std::vector<std::int64_t>& sequences);
  /// 0, 1, ... 255, 0, ...: another one with each call, over all lives of the file.
  Result<std::uint8_t> NextBirth();

 private:
  struct Impl;
  explicit Outbox(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydroscope
