#include "storage/gram_rollup.h"

#include <algorithm>

#include "core/told_error.h"
#include "storage/blobs/gram_codec.h"

namespace hydroscope {
namespace {

void AddMatrix(SymmetricMatrix& sum, const SymmetricMatrix& matrix) {
  if (sum.dimension() == 0)
    sum = matrix;
  else if (matrix.dimension() > 0)
    sum += matrix;
}

bool Fits(const SymmetricMatrix& sum, const SymmetricMatrix& matrix) {
  return sum.dimension() == 0 || matrix.dimension() == 0 || sum.dimension() == matrix.dimension();
}

/// Adds a part of the group, nullopt if it is missing.
void AddPart(GroupUnderWay& group, const std::optional<Rollup>& part) {
  if (!part || !group.uniform) {
    group.uniform = false;
    return;
  }
  if (group.sum.model_version == 0) group.sum.model_version = part->model_version;
  group.uniform = group.sum.model_version == part->model_version && AddGram(group.sum.gram, part->gram);
}

/// Strokes in a part of a group of this size: one, or a smaller group.
std::int64_t PartStrokes(std::size_t size) { return size == 0 ? 1 : kRollupStrokes[size - 1]; }

/// What is stored of the group that holds sequence `next`, up to there; `next` begins one of its parts.
Result<GroupUnderWay> StoredGroup(Connection& connection, std::int64_t machine, std::size_t size,
                                  std::int64_t next) {
  GroupUnderWay group{.next = next};
  const std::int64_t first = next - next % kRollupStrokes[size];
  if (size == 0) {
    TRY(ForEachGram(connection, machine, first, next,
                    [&](const RunRow& run, std::int64_t, StrokeGram&& gram) {
                      AddPart(group, Rollup{std::move(gram), run.model_version});
                      return Status();
                    }));
    return group;
  }
  for (std::int64_t at = first; at < next && group.uniform; at += PartStrokes(size))
    AddPart(group, TRY(FindRollup(connection, machine, PartStrokes(size), at)));
  return group;
}

}  // namespace

Result<std::optional<Rollup>> FindRollup(Connection& connection, std::int64_t machine, std::int64_t strokes,
                                         std::int64_t first) {
  using Found = std::optional<Rollup>;
  Query query(
      connection,
      "SELECT model_version, gram FROM gram_rollup WHERE machine = ? AND strokes = ? AND first_sequence = ?",
      machine, strokes, first);
  if (!query.Step()) return Found();
  auto gram = DecodeGram(query.Blob(1));
  if (!gram)
    return BadInput(Tell("{}: stored sum of strokes {} to {}: {}",
                         "{}: gespeicherte Summe der Hübe {} bis {}: {}", connection.path, first,
                         first + strokes - 1, gram.error().text));
  return Found(Rollup{std::move(*gram), static_cast<int>(query.Int(0))});
}

bool AddGram(StrokeGram& sum, const StrokeGram& gram) {
  if (!Fits(sum.integral, gram.integral) || !Fits(sum.noise, gram.noise) || !Fits(sum.flow, gram.flow))
    return false;
  sum.blocks += gram.blocks;
  sum.spans += gram.spans;
  sum.windows += gram.windows;
  AddMatrix(sum.integral, gram.integral);
  AddMatrix(sum.noise, gram.noise);
  AddMatrix(sum.flow, gram.flow);
  return true;
}

Status ForEachGram(Connection& connection, std::int64_t machine, std::int64_t first, std::int64_t last,
                   const GramVisitor& visit) {
  for (const RunRow& run : connection.RunsOf(machine)) {
    const std::int64_t from = std::max<std::int64_t>(first - run.first_sequence, 0);
    const std::int64_t to = std::min(last - run.first_sequence, run.strokes);
    if (from >= to) continue;
    Query query(connection,
                "SELECT stroke, gram FROM gram WHERE run = ? AND stroke >= ? AND stroke < ? ORDER BY stroke",
                run.id, from, to);
    for (std::int64_t stroke = from; stroke < to; ++stroke) {
      if (!query.Step() || query.Int(0) != stroke)
        return BadInput(Tell("{}: run {} ({}), stroke {}: its Gram is missing; the file is damaged",
                             "{}: Lauf {} ({}), Hub {}: seine Produktsumme fehlt; die Datei ist beschädigt",
                             connection.path, run.id, run.source, stroke));
      auto gram = DecodeGram(query.Blob(1));
      if (!gram)
        return BadInput(Tell("{}: run {} ({}), stroke {}: Gram {}",
                             "{}: Lauf {} ({}), Hub {}: Produktsumme {}", connection.path, run.id, run.source,
                             stroke, gram.error().text));
      TRY(visit(run, run.first_sequence + stroke, std::move(*gram)));
    }
  }
  return {};
}

Status UpdateRollups(Connection& connection, const RunRow& run, std::span<const std::uint8_t> gram) {
  const std::int64_t machine = run.machine, sequence = run.first_sequence + run.strokes - 1;
  auto part = std::optional(Rollup{TRY(DecodeGram(gram)), run.model_version});
  std::int64_t at = sequence;  // first stroke of the part
  for (std::size_t size = 0; size < kRollupStrokes.size(); ++size) {
    GroupUnderWay& group = connection.memory[machine].groups[size];
    const std::int64_t strokes = kRollupStrokes[size], first = at - at % strokes;
    const bool complete = sequence + 1 == first + strokes;
    if (at == first)
      group = {.next = at};
    else if (group.next != at)
      group = complete ? TRY(StoredGroup(connection, machine, size, at)) : GroupUnderWay();
    if (group.next != at) return {};
    AddPart(group, part);
    group.next = sequence + 1;
    if (!complete) return {};
    part = group.uniform ? std::optional(std::move(group.sum)) : std::nullopt;
    at = first;
    if (!part) continue;
    const auto bytes = EncodeGram(part->gram, NoisePrecision::kDouble);
    Query(
        connection,
        "INSERT INTO gram_rollup(machine, strokes, first_sequence, model_version, gram) VALUES(?, ?, ?, ?, ?)",
        machine, strokes, first, part->model_version, bytes)
        .Run();
  }
  return {};
}

Status FetchRollups(Connection& connection, std::int64_t machine, std::int64_t next) {
  for (std::size_t size = 0; size < kRollupStrokes.size(); ++size) {
    GroupUnderWay& group = connection.memory[machine].groups[size];
    const std::int64_t at = next - next % PartStrokes(size);
    if (at % kRollupStrokes[size] != 0 && group.next != at)
      group = TRY(StoredGroup(connection, machine, size, at));
  }
  return {};
}

Result<std::vector<StrokeGram>> Database::Grams(std::int64_t machine, std::int64_t first,
                                                std::int64_t last) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<StrokeGram>> {
    std::vector<StrokeGram> grams;
    TRY(ForEachGram(*impl_, machine, first, last, [&](const RunRow&, std::int64_t, StrokeGram&& gram) {
      grams.push_back(std::move(gram));
      return Status();
    }));
    return grams;
  });
}

}  // namespace hydroscope
