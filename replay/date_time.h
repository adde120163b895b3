#pragma once

#include <optional>
#include <string_view>

namespace hydroscope {

/// Reads a date with time of day, or a time of day alone, as loggers write them:
///   2022-06-29T16:05:36.674Z, 2022-06-29 16:05:36,674, 2022-06-29T16:05:36+02:00, 20220629T160536   (ISO
///   8601) 06/29/2022 04:05:36.674 PM   month first; day first when the first number exceeds 12 29.06.2022
///   16:05:36.674      day first 16:05:36.674                 seconds of the day
/// Returns s since 1970-01-01 00:00 UTC (local times are taken as UTC; resolution of a double there: 0.24
/// us), or s of the day; nullopt if the text is none of these.
std::optional<double> ParseDateTime(std::string_view text);

}  // namespace hydroscope
