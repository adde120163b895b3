#pragma once

#include "core/result.h"
#include "replay/log_head.h"

namespace hydroscope {

/// Error if the numbers of a log cannot be told although they are there: digits in groups ("2.935.570,5"), one value in a row
/// beside the name of its signal, rows from the newest to the oldest. The error says how to export it instead.
Status CheckShape(const LogHead& head, const std::string& path);

}  // namespace hydroscope
