#pragma once

#include <any>
#include <map>
#include <string>
#include <utility>

namespace hydroscope {

/// The settings of one feed, of a type of its own (alarms/feeds/<feed>/settings.h).
class FeedSettings {
 public:
  template <typename Settings>
  explicit FeedSettings(Settings settings) : value_(std::move(settings)), same_(Same<Settings>) {}

  /// nullptr if they are those of another feed.
  template <typename Settings>
  const Settings* As() const {
    return std::any_cast<Settings>(&value_);
  }
  template <typename Settings>
  Settings* As() {
    return std::any_cast<Settings>(&value_);
  }
  bool operator==(const FeedSettings& other) const {
    return value_.type() == other.value_.type() && same_(value_, other.value_);
  }

 private:
  template <typename Settings>
  static bool Same(const std::any& a, const std::any& b) {
    return *std::any_cast<Settings>(&a) == *std::any_cast<Settings>(&b);
  }

  std::any value_;
  bool (*same_)(const std::any&, const std::any&);
};

/// The [feeds] part of a machine file: each feed is off unless its section is there.
struct FeedsSpec {
  std::map<std::string, FeedSettings, std::less<>> settings;  ///< by the feed's name, "modbus"

  /// Turns the feed with these settings on.
  template <typename Settings>
  Settings& Add(Settings added = {}) {
    return *settings.insert_or_assign(std::string(Settings::kName), FeedSettings(std::move(added)))
                .first->second.template As<Settings>();
  }
  /// nullptr: that feed is off.
  template <typename Settings>
  const Settings* Of() const {
    const auto at = settings.find(Settings::kName);
    return at == settings.end() ? nullptr : at->second.template As<Settings>();
  }
  bool operator==(const FeedsSpec&) const = default;
};

}  // namespace hydroscope
