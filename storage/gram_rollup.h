#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "core/records/stroke_gram.h"
#include "core/result.h"
#include "storage/connection.h"

namespace hydroscope {

/// To be called after the run's newest stroke was stored with this Gram, in the same transaction: stores the
/// sums that it completes. Groups with more than one model version get none. The sums of the groups under way
/// are kept in memory, so that the stroke that completes one takes no longer than others; a group that another
/// process began is read again, by FetchRollups() or at its end.
Status UpdateRollups(Connection& connection, const RunRow& run, std::span<const std::uint8_t> gram);
/// Reads what is stored of the groups to which the machine's next stroke, `next`, belongs, if it is not in memory.
Status FetchRollups(Connection& connection, std::int64_t machine, std::int64_t next);

/// Calls `visit` with every stored Gram of first <= sequence < last in order, until it returns an error. A
/// torn or foreign blob is an error that names run and stroke.
using GramVisitor = std::function<Status(const RunRow& run, std::int64_t sequence, StrokeGram&& gram)>;
Status ForEachGram(Connection& connection, std::int64_t machine, std::int64_t first, std::int64_t last,
                   const GramVisitor& visit);

/// The stored sum of `strokes` strokes from sequence `first` on; nullopt if there is none.
Result<std::optional<Rollup>> FindRollup(Connection& connection, std::int64_t machine, std::int64_t strokes,
                                         std::int64_t first);

/// Adds counts and matrices; an empty Gram adds nothing. Returns false, leaving `sum` as it was, if
/// dimensions differ.
bool AddGram(StrokeGram& sum, const StrokeGram& gram);

}  // namespace hydroscope
