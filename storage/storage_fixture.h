#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/expect_ok_fixture.h"
#include "storage/database.h"

namespace hydroscope::storage_test {

/// A folder of its own for each test, removed at its end.
class Folder {
 public:
  Folder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            Plain(std::string("hydroscope_") + test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string File(const std::string& name = "press.db") const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }

 private:
  /// Names of parameterised tests contain slashes.
  static std::string Plain(std::string name) {
    std::ranges::replace(name, '/', '_');
    return name;
  }
  std::filesystem::path path_;
};

inline std::vector<std::string> ColumnNames(int dimension) {
  std::vector<std::string> names;
  for (int i = 0; i < dimension; ++i) names.push_back("column_" + std::to_string(i));
  return names;
}

/// Numbers that differ in every bit, the same in every run: a 64-bit mix (Steele, Lea, Flood 2014, splitmix64).
inline double Noise(std::uint64_t seed) {
  seed += 0x9e3779b97f4a7c15ull;
  seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9ull;
  seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((seed ^ (seed >> 31)) >> 11) * 0x1p-53;
}

inline SymmetricMatrix MakeMatrix(int dimension, std::uint64_t seed, double scale) {
  SymmetricMatrix matrix(dimension);
  for (std::size_t k = 0; k < matrix.packed().size(); ++k)
    matrix.packed()[k] = scale * (Noise(seed + k) - 0.3);
  for (int i = 0; i < dimension; ++i) matrix(i, i) = scale * (1 + Noise(seed + 7919u * i));
  return matrix;
}

/// The stroke of this index of a log: its content depends on `index` and `log` alone.
inline StrokeRecord MakeStroke(std::int64_t index, int dimension = 6, std::uint64_t log = 1) {
  const std::uint64_t seed = log * 1'000'003u + static_cast<std::uint64_t>(index) * 10'007u;
  StrokeRecord record;
  record.summary = {.index = index,
                    .begin = 2.0 * index,
                    .end = 2.0 * index + 1.1,
                    .oil_temperature = 313.15 + Noise(seed),
                    .conditions = {0.2, 1.2e7, 1.9e7 + index, 0, 0, 3.5},
                    .rms_error = 1e-5,
                    .noise_floor = 4e-6,
                    .counters = {}};
  if (index % 5 == 3) record.summary.oil_temperature = std::nan("");
  record.summary.counters = {2000, 1100, 1080, {}};
  if (index % 4 == 1) record.summary.counters.flagged[1] = 20 + index;
  record.gram = {50 + index,
                 3,
                 11,
                 MakeMatrix(dimension, seed + 1, 1e-6),
                 MakeMatrix(dimension, seed + 2, 1e-12),
                 MakeMatrix(dimension, seed + 3, 1e-8)};
  const double end = record.summary.end;
  record.estimates = {
      {"K", 1.4e9 * (1 + 0.01 * Noise(seed + 4)), 2e7, "Pa", 0.6, end, EstimateReason::kUpdated},
      {"V0", 2.5e-3 * (1 + 0.01 * Noise(seed + 5)), 1e-5, "m3", 0.4, end, EstimateReason::kUpdated},
      {"Q_vn", 1.6e-3, index % 3 == 2 ? std::nan("") : 2e-6, "m3/s", 0.8, end, EstimateReason::kConfounded,
       311.15 + Noise(seed + 6)},
      {"y_0", 0.01 / 3, 1e-4, "1", 0, std::nan(""), EstimateReason::kNotExcited}};
  return record;
}

inline std::vector<StrokeRecord> MakeStrokes(std::int64_t first, std::int64_t last, int dimension = 6,
                                             std::uint64_t log = 1) {
  std::vector<StrokeRecord> records;
  for (std::int64_t index = first; index < last; ++index)
    records.push_back(MakeStroke(index, dimension, log));
  return records;
}

/// The value, or a failed test that shows the error.
template <typename T>
T Value(Result<T> result) {
  if (!result) {
    ADD_FAILURE() << result.error().text;
    throw std::runtime_error(result.error().text);
  }
  return std::move(*result);
}

/// A database with one machine and one model version.
struct Press {
  explicit Press(const std::string& path, int dimension = 6) : database(Value(Database::Open(path))) {
    machine = Value(database.MachineId("press 7"));
    version = Value(database.PutModelVersion(machine, {0, "name = \"press 7\"", ColumnNames(dimension)}));
  }
  RunInfo Begin(const std::string& log) {
    return Value(database.BeginRun(machine, version, log, "fingerprint of " + log));
  }

  Database database;
  std::int64_t machine = 0;
  int version = 0;
};

}  // namespace hydroscope::storage_test
