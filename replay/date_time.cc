#include "replay/date_time.h"

#include <cstdint>

#include "replay/decimal.h"

namespace hydroscope {
namespace {

/// Walks over the text; every Take... leaves the position alone when it does not match.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}
  bool AtEnd() const { return at_ == text_.size(); }
  char Peek() const { return AtEnd() ? '\0' : text_[at_]; }
  bool TakeOneOf(std::string_view set) {
    if (AtEnd() || set.find(text_[at_]) == std::string_view::npos) return false;
    ++at_;
    return true;
  }
  void SkipBlanks() {
    while (TakeOneOf(" \t")) {
    }
  }
  /// An integer of `least` to `most` digits.
  std::optional<int> TakeNumber(int least, int most) {
    int value = 0;
    int digits = 0;
    while (digits < most && at_ + digits < text_.size() && decimal_detail::IsDigit(text_[at_ + digits])) {
      value = value * 10 + (text_[at_ + digits] - '0');
      ++digits;
    }
    if (digits < least) return std::nullopt;
    at_ += digits;
    return value;
  }
  /// Digits after a decimal point as a fraction of one; 0 if there is no point.
  double TakeFraction() {
    if (!TakeOneOf(".,")) return 0.0;
    double mantissa = 0;
    double power = 1;
    for (; !AtEnd() && decimal_detail::IsDigit(text_[at_]); ++at_) {
      if (power >= 1e15) continue;
      mantissa = mantissa * 10 + (text_[at_] - '0');
      power *= 10;
    }
    return mantissa / power;
  }
  std::size_t position() const { return at_; }
  void Rewind(std::size_t position) { at_ = position; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

struct Date {
  int year = 0, month = 0, day = 0;
};

/// Days since 1970-01-01 of a date in the Gregorian calendar (H. Hinnant, "chrono-compatible low-level date
/// algorithms", days_from_civil).
std::int64_t DaysSince1970(Date date) {
  const std::int64_t year = date.year - (date.month <= 2);
  const std::int64_t era = (year >= 0 ? year : year - 399) / 400;
  const std::int64_t year_of_era = year - era * 400;
  const std::int64_t day_of_year = (153 * (date.month + (date.month > 2 ? -3 : 9)) + 2) / 5 + date.day - 1;
  const std::int64_t day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  return era * 146097 + day_of_era - 719468;
}

std::optional<Date> TakeDate(Scanner& scan) {
  Date date;
  if (const auto compact = scan.TakeNumber(8, 8)) {  // 20220629
    date = {*compact / 10000, *compact / 100 % 100, *compact % 100};
  } else if (const auto year = scan.TakeNumber(4, 4)) {  // 2022-06-29
    if (!scan.TakeOneOf("-/.")) return std::nullopt;
    const auto month = scan.TakeNumber(1, 2);
    if (!month || !scan.TakeOneOf("-/.")) return std::nullopt;
    const auto day = scan.TakeNumber(1, 2);
    if (!day) return std::nullopt;
    date = {*year, *month, *day};
  } else {  // 06/29/2022 or 29.06.2022
    const auto first = scan.TakeNumber(1, 2);
    const char separator = scan.Peek();
    if (!first || !scan.TakeOneOf("/.-")) return std::nullopt;
    const auto second = scan.TakeNumber(1, 2);
    if (!second || !scan.TakeOneOf("/.-")) return std::nullopt;
    const auto last = scan.TakeNumber(4, 4);
    if (!last) return std::nullopt;
    const bool month_first = separator == '/' && *first <= 12;
    date = month_first ? Date{*last, *first, *second} : Date{*last, *second, *first};
  }
  if (date.month < 1 || date.month > 12 || date.day < 1 || date.day > 31) return std::nullopt;
  return date;
}

/// s of the day from "16:05:36.674", "160536", "04:05:36 PM".
std::optional<double> TakeTimeOfDay(Scanner& scan) {
  auto hour = scan.TakeNumber(1, 2);
  if (!hour) return std::nullopt;
  const bool colons = scan.TakeOneOf(":");
  const auto minute = scan.TakeNumber(2, 2);
  if (!minute) return std::nullopt;
  std::optional<int> second = 0;
  if (!colons || scan.TakeOneOf(":")) second = scan.TakeNumber(2, 2);
  if (!second || *hour > 23 || *minute > 59 || *second > 60) return std::nullopt;
  const double fraction = scan.TakeFraction();
  scan.SkipBlanks();
  const bool morning = scan.Peek() == 'A' || scan.Peek() == 'a';
  if (scan.TakeOneOf("AaPp")) {
    if (!scan.TakeOneOf("Mm") || *hour < 1 || *hour > 12) return std::nullopt;
    *hour = *hour % 12 + (morning ? 0 : 12);
  }
  return *hour * 3600 + *minute * 60 + *second + fraction;
}

/// Offset from UTC in s: "Z", "+02:00", "-0530"; 0 if there is none.
std::optional<double> TakeZone(Scanner& scan) {
  if (scan.TakeOneOf("Zz")) return 0.0;
  const double sign = scan.Peek() == '-' ? -1 : 1;
  if (!scan.TakeOneOf("+-")) return 0.0;
  const auto hours = scan.TakeNumber(2, 2);
  scan.TakeOneOf(":");
  const auto minutes = scan.TakeNumber(2, 2);
  if (!hours) return std::nullopt;
  return sign * (*hours * 3600 + minutes.value_or(0) * 60);
}

}  // namespace

std::optional<double> ParseDateTime(std::string_view text) {
  Scanner scan(text);
  scan.SkipBlanks();
  const std::size_t start = scan.position();
  std::int64_t days = 0;
  if (const auto date = TakeDate(scan)) {
    days = DaysSince1970(*date);
    if (!scan.TakeOneOf("T ")) return std::nullopt;
    scan.SkipBlanks();
  } else {
    scan.Rewind(start);
    if (text.find(':') == std::string_view::npos) return std::nullopt;
  }
  const auto seconds = TakeTimeOfDay(scan);
  if (!seconds) return std::nullopt;
  const auto zone = TakeZone(scan);
  if (!zone) return std::nullopt;
  scan.SkipBlanks();
  if (!scan.AtEnd()) return std::nullopt;
  return static_cast<double>(days) * 86400.0 + (*seconds - *zone);
}

}  // namespace hydroscope
