#pragma once

#include <any>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace hydroscope {

/// The settings of one feed or one source, or where a signal of a source stands: of a type of the part's own folder
/// (alarms/feeds/<feed>/settings.h, acquisition/<source>/settings.h), with the part's name as kName.
class PartSettings {
 public:
  template <typename Settings>
  explicit PartSettings(Settings settings)
      : part_(Settings::kName), value_(std::move(settings)), same_(Same<Settings>) {}

  /// "modbus"
  const std::string& part() const { return part_; }
  /// nullptr if they are those of another part.
  template <typename Settings>
  const Settings* As() const {
    return std::any_cast<Settings>(&value_);
  }
  template <typename Settings>
  Settings* As() {
    return std::any_cast<Settings>(&value_);
  }
  bool operator==(const PartSettings& other) const {
    return value_.type() == other.value_.type() && same_(value_, other.value_);
  }

 private:
  template <typename Settings>
  static bool Same(const std::any& a, const std::any& b) {
    return *std::any_cast<Settings>(&a) == *std::any_cast<Settings>(&b);
  }

  std::string part_;
  std::any value_;
  bool (*same_)(const std::any&, const std::any&);
};

/// The [feeds] part of a machine file, or the sources of its [live] part: each is off unless its section is there.
struct PartsSpec {
  std::map<std::string, PartSettings, std::less<>> settings;  ///< by the part's name, "modbus"

  /// Turns the part with these settings on.
  template <typename Settings>
  Settings& Add(Settings added = {}) {
    return *settings.insert_or_assign(std::string(Settings::kName), PartSettings(std::move(added)))
                .first->second.template As<Settings>();
  }
  /// nullptr: that part is off.
  template <typename Settings>
  const Settings* Of() const {
    const auto at = settings.find(Settings::kName);
    return at == settings.end() ? nullptr : at->second.template As<Settings>();
  }
  bool operator==(const PartsSpec&) const = default;
};

}  // namespace hydroscope
