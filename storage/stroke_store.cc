#include <bit>

#include "core/records/quality.h"
#include "storage/blobs/content_hash.h"
#include "storage/connection.h"
#include "storage/database.h"
#include "storage/gram_rollup.h"
#include "storage/store_steps.h"

namespace hydroscope {
namespace {

/// Hash over everything that is stored of a stroke.
std::int64_t ContentHash(const PackedStroke& stroke) {
  Fnv1a hash;
  const StrokeSummary& s = stroke.summary;
  hash.Add(s.index);
  // Three conditions always, as before others could be declared; more only where there are any: hashes stored then hold.
  constexpr std::size_t kAlways = 3;
  for (const double value : {s.begin, s.end, s.oil_temperature, s.conditions[0], s.conditions[1],
                             s.conditions[2], s.rms_error, s.noise_floor})
    hash.Add(value);
  for (std::size_t c = kAlways; c < s.conditions.size(); ++c)
    if (s.conditions[c] != 0) hash.Add(s.conditions[c]);
  for (const std::int64_t count : {s.counters.samples, s.counters.gated, s.counters.used}) hash.Add(count);
  for (const std::int64_t count : s.counters.flagged) hash.Add(count);
  for (const Estimate& e : stroke.estimates) {
    hash.Add(e.parameter);
    hash.Add(e.unit);
    for (const double value : {e.value, e.std, e.excitation, e.last_excited, e.oil_temperature})
      hash.Add(value);
    hash.Add(std::string_view(ReasonName(e.reason)));
  }
  hash.Add(std::span<const std::uint8_t>(stroke.gram));
  return std::bit_cast<std::int64_t>(hash.value());
}

std::string FlagText(std::size_t bit) {
  for (const auto& [flag, name] : quality::kFlagNames)
    if (flag == 1u << bit) return std::string(name);
  return fmt::format("bit_{}", bit);
}

std::int64_t ParameterId(Connection& connection, std::int64_t machine, const Estimate& estimate) {
  for (const bool retry : {true, false}) {
    Query query(connection, "SELECT id FROM parameter WHERE machine = ? AND name = ? AND unit = ?", machine,
                estimate.parameter, estimate.unit);
    if (query.Step()) return query.Int(0);
    if (retry)
      Query(connection, "INSERT INTO parameter(machine, name, unit) VALUES(?, ?, ?)", machine,
            estimate.parameter, estimate.unit)
          .Run();
  }
  return 0;
}

void InsertSummary(Connection& connection, std::int64_t run, const StrokeSummary& s,
                   std::int64_t content_hash) {
  const auto& c = s.conditions;
  static_assert(kMaxConditions == 6);
  Query(connection, "INSERT INTO stroke VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", run,
        s.index, s.begin, s.end, s.oil_temperature, c[0], c[1], c[2], s.rms_error, s.noise_floor,
        s.counters.samples, s.counters.gated, s.counters.used, content_hash, c[3], c[4], c[5])
      .Run();
  for (std::size_t bit = 0; bit < s.counters.flagged.size(); ++bit)
    if (s.counters.flagged[bit] != 0)
      Query(connection, "INSERT INTO stroke_flag VALUES(?, ?, ?, ?)", run, s.index, FlagText(bit),
            s.counters.flagged[bit])
          .Run();
}

void InsertEstimates(Connection& connection, const RunRow& run, const PackedStroke& stroke) {
  for (const Estimate& e : stroke.estimates)
    Query(connection, "INSERT INTO estimate VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)", run.id, stroke.summary.index,
          ParameterId(connection, run.machine, e), e.value, e.std, e.excitation, e.last_excited,
          ReasonName(e.reason), e.oil_temperature)
        .Run();
}

Status CheckStroke(const PackedStroke& stroke, int columns) {
  const auto [integral, noise, flow] = stroke.dimensions;
  for (const int dimension : stroke.dimensions)
    if (dimension != 0 && dimension != columns)
      return InternalError("its Gram has dimension {} (noise {}, flow {}), the model version has {} columns",
                           integral, noise, flow, columns);
  for (std::size_t i = 0; i < stroke.estimates.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (stroke.estimates[i].parameter == stroke.estimates[j].parameter)
        return InternalError("it estimates parameter {} twice", stroke.estimates[i].parameter);
  return {};
}

/// A stroke that is stored already must be the same one.
Status CheckSame(Connection& connection, std::int64_t run, std::int64_t stroke, std::int64_t content_hash) {
  Query query(connection, "SELECT content_hash FROM stroke WHERE run = ? AND stroke = ?", run, stroke);
  if (!query.Step()) return InternalError("it should be stored but is missing: the file is damaged");
  if (query.Int(0) == content_hash) return {};
  return BadInput(
      "it is stored with other content. The same log, machine file and program give the same strokes; one "
      "of them changed. Replay into a new database");
}

Status StoreOne(Connection& connection, RunRow& run, const PackedStroke& stroke, int columns) {
  const std::int64_t index = stroke.summary.index;
  if (index < 0 || index > run.strokes)
    return InternalError("strokes up to {} are stored: {} would leave a hole", run.strokes - 1, index);
  TRY(CheckStroke(stroke, columns));
  const std::int64_t content_hash = ContentHash(stroke);
  if (index < run.strokes) return CheckSame(connection, run.id, index, content_hash);
  if (run.state != "open") return InternalError("the run is {} and takes no more strokes", run.state);
  InsertSummary(connection, run.id, stroke.summary, content_hash);
  InsertEstimates(connection, run, stroke);
  Query(connection, "INSERT INTO gram(run, stroke, gram) VALUES(?, ?, ?)", run.id, index, stroke.gram).Run();
  ++run.strokes;
  Query(connection, "UPDATE run SET strokes = ? WHERE id = ?", run.strokes, run.id).Run();
  return UpdateRollups(connection, run, stroke.gram);
}

}  // namespace

Status AppendStrokes(Connection& connection, RunRow& run, std::span<const PackedStroke> strokes) {
  if (strokes.empty()) return {};
  const int columns = connection.ColumnCount(run.machine, run.model_version);
  for (const PackedStroke& stroke : strokes)
    if (const Status stored = StoreOne(connection, run, stroke, columns); !stored)
      return tl::unexpected(
          Error{stored.error().kind, fmt::format("{}: run {} ({}), stroke {}: {}", connection.path, run.id,
                                                 run.source, stroke.summary.index, stored.error().text)});
  return {};
}

Status Database::StoreStrokes(std::int64_t run, const std::vector<StrokeRecord>& strokes) {
  return InTransaction(*impl_, [&]() -> Status {
    auto row = TRY(impl_->FindRun(run));
    for (const StrokeRecord& record : strokes) {
      const PackedStroke stroke = Pack(record);
      TRY(AppendStrokes(*impl_, row, {&stroke, 1}));
    }
    return {};
  });
}

Status Database::CompareStrokes(std::int64_t run, const std::vector<StrokeRecord>& strokes) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    const auto row = TRY(impl_->FindRun(run));
    if (static_cast<std::int64_t>(strokes.size()) < row.strokes)
      return BadInput("run {} holds {} strokes, {} were offered", run, row.strokes, strokes.size());
    for (std::int64_t i = 0; i < row.strokes; ++i) {
      const StrokeRecord& record = strokes[i];
      if (const Status same = CheckSame(*impl_, run, i, ContentHash(Pack(record))); !same)
        return BadInput("run {}, stroke {} (ends at {:.3f} s): stored and offered content differ", run, i,
                        record.summary.end);
    }
    return {};
  });
}

}  // namespace hydroscope
