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

bool AddStroke(Rollup& sum, int model_version, const StrokeGram& gram) {
  if (sum.model_version == 0) sum.model_version = model_version;
  return sum.model_version == model_version && AddGram(sum.gram, gram);
}

/// Adds the run's newest stroke to the sum of its group.
Status FollowGroup(Connection& connection, const RunRow& run, std::int64_t sequence,
                   std::span<const std::uint8_t> bytes) {
  GroupUnderWay& group = connection.memory[run.machine].group;
  if (sequence % kRollupStrokes.front() == 0) group = {.next = sequence};
  if (group.next != sequence) return group.next = -1, Status();
  const auto gram = TRY(DecodeGram(bytes));
  group.uniform = group.uniform && AddStroke(group.sum, run.model_version, gram);
  ++group.next;
  return {};
}

/// Sum of a group's single strokes; nullopt if they are of more than one model version.
Result<std::optional<Rollup>> SumOfStrokes(Connection& connection, std::int64_t machine, std::int64_t first,
                                           std::int64_t last) {
  const GroupUnderWay& group = connection.memory[machine].group;
  if (group.next == last) return group.uniform ? std::optional<Rollup>(group.sum) : std::nullopt;
  Rollup sum;
  bool uniform = true;
  TRY(ForEachGram(connection, machine, first, last, [&](const RunRow& run, std::int64_t, StrokeGram&& gram) {
    uniform = uniform && AddStroke(sum, run.model_version, gram);
    return Status();
  }));
  return uniform ? std::optional<Rollup>(std::move(sum)) : std::nullopt;
}

/// Sum of a group's smaller groups; nullopt if one is missing or of another model version.
Result<std::optional<Rollup>> SumOfGroups(Connection& connection, std::int64_t machine, std::int64_t first,
                                          std::int64_t last, std::int64_t group) {
  Rollup sum;
  for (std::int64_t at = first; at < last; at += group) {
    const auto part = TRY(FindRollup(connection, machine, group, at));
    if (!part) return std::optional<Rollup>();
    if (sum.model_version == 0) sum.model_version = part->model_version;
    if (sum.model_version != part->model_version || !AddGram(sum.gram, part->gram))
      return std::optional<Rollup>();
  }
  return std::optional<Rollup>(std::move(sum));
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
  TRY(FollowGroup(connection, run, sequence, gram));
  std::int64_t smaller = 1;
  for (const std::int64_t group : kRollupStrokes) {
    const std::int64_t last = sequence + 1;
    if (last % group != 0) return {};
    const std::int64_t first = last - group;
    const auto sum = TRY(smaller == 1 ? SumOfStrokes(connection, machine, first, last)
                                      : SumOfGroups(connection, machine, first, last, smaller));
    if (!sum) return {};
    const auto bytes = EncodeGram(sum->gram, NoisePrecision::kDouble);
    Query(
        connection,
        "INSERT INTO gram_rollup(machine, strokes, first_sequence, model_version, gram) VALUES(?, ?, ?, ?, ?)",
        machine, group, first, sum->model_version, bytes)
        .Run();
    smaller = group;
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
