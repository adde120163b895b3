#include "estimation/states/step_tangent.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/limits.h"
#include "core/parallel/wide.h"
#include "estimation/states/explicit_method.h"
#include "estimation/states/implicit_method.h"

namespace hydroscope {
namespace {

using Entry = TangentEntries::Entry;

/// out = df/dp + what added terms give; 0 in rows of states that are held. Written for all stages before any is read: reading
/// whole vectors of what has just been written number by number makes the processor wait.
[[gnu::always_inline]] inline void PutOwnSlopes(const TangentShape& shape, const TangentPoint& point,
                                                double* out) {
  const int columns = shape.columns;
  std::fill_n(out, shape.states * columns, 0.0);
  for (const auto& [row, column, place] : shape.entries.by_parameters)
    if (point.held[row] == 0) out[row * columns + column] = point.registers[place];
  if (shape.terms == nullptr) return;
  for (const auto& [value, row, column] : shape.terms->to_states)
    if (point.held[row] == 0) out[row * columns + shape.terms_from + column] += point.added[value];
}

/// Numbers side by side in a register of the processor, or in two. By memcpy, as they need not be aligned.
using Lanes [[gnu::vector_size(kSensitivityPadding * sizeof(double))]] = double;
[[gnu::always_inline]] inline void TakeLanes(const double* from, Lanes& lanes) {
  std::memcpy(&lanes, from, sizeof lanes);
}
[[gnu::always_inline]] inline void PutLanes(const Lanes& lanes, double* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}

/// to += sum over the entries of a row of value * s, for kCount times kSensitivityPadding columns from `s` and `to` on.
template <int kCount>
[[gnu::always_inline]] inline void AddProducts(const Entry* entry, const Entry* end, const double* registers,
                                               const double* s, int columns, double* to) {
  Lanes sum[kCount] = {};
  for (; entry != end; ++entry) {
    const double value = registers[entry->place];
    const double* from = s + entry->column * columns;
    for (int c = 0; c < kCount; ++c) {
      Lanes moved;
      TakeLanes(from + c * kSensitivityPadding, moved);
      sum[c] += value * moved;
    }
  }
  for (int c = 0; c < kCount; ++c, to += kSensitivityPadding) {
    Lanes own;
    TakeLanes(to, own);
    PutLanes(sum[c] + own, to);
  }
}

/// out += J s.
[[gnu::always_inline]] inline void AddMovedSlopes(const TangentShape& shape, const TangentPoint& point,
                                                  const double* s, double* out) {
  const int columns = shape.columns;
  const Entry *entry = shape.entries.by_states.data(), *last = entry + shape.entries.by_states.size();
  while (entry != last) {
    const int row = entry->row;
    const Entry* end = entry;
    while (end != last && end->row == row) ++end;
    int c = 0;
    const auto add = [&]<int kCount>(std::integral_constant<int, kCount>) __attribute__((always_inline)) {
      for (; c + kCount * kSensitivityPadding <= columns; c += kCount * kSensitivityPadding)
        AddProducts<kCount>(entry, end, point.registers, s + c, columns, out + row * columns + c);
    };
    if (point.held[row] == 0) {
      add(std::integral_constant<int, 4>());
      add(std::integral_constant<int, 2>());
      add(std::integral_constant<int, 1>());
    }
    entry = end;
  }
}

/// As BeginOfStage, in lanes: what is written in them is read in them.
template <int kCount>
[[gnu::always_inline]] inline void SlopesFrom(const double* s, const double* k, const double* weights,
                                              double step, std::size_t size, double* out) {
  std::array<double, static_cast<std::size_t>(kCount)> w;
  for (std::size_t j = 0; j < kCount; ++j) w[j] = step * weights[j];
  for (std::size_t i = 0; i < size; i += kSensitivityPadding) {
    Lanes sum, rate;
    TakeLanes(s + i, sum);
    for (std::size_t j = 0; j < kCount; ++j) {
      TakeLanes(k + j * size + i, rate);
      sum += w[j] * rate;
    }
    PutLanes(sum, out + i);
  }
}

HYDROSCOPE_WIDE void DifferentiateExplicit(const TangentShape& shape, const TangentPoint* stages, double step,
                                           const double* s, double* k, double* end) {
  const auto size = static_cast<std::size_t>(shape.states * shape.columns);
  for (std::size_t stage = 0; stage + 1 < kExplicitStages; ++stage)
    PutOwnSlopes(shape, stages[stage], k + stage * size);
  AddMovedSlopes(shape, stages[0], s, k);
  const auto take = [&]<int kStage>(std::integral_constant<int, kStage>) __attribute__((always_inline)) {
    SlopesFrom<kStage>(s, k, kExplicitA[kStage], step, size, end);
    AddMovedSlopes(shape, stages[kStage], end, k + kStage * size);
  };
  take(std::integral_constant<int, 1>());
  take(std::integral_constant<int, 2>());
  take(std::integral_constant<int, 3>());
  take(std::integral_constant<int, 4>());
  take(std::integral_constant<int, 5>());
  SlopesFrom<kExplicitStages - 1>(s, k, kExplicitA[kExplicitStages - 1], step, size, end);
}

/// ks = matrix^-1 ks, kSensitivityPadding columns at a time.
[[gnu::always_inline]] inline void SolveColumns(std::size_t n, std::size_t columns, const double* factor,
                                                const std::size_t* pivots, double* ks) {
  std::array<Lanes, kMaxStates> b;
  for (std::size_t c = 0; c < columns; c += kSensitivityPadding) {
    for (std::size_t r = 0; r < n; ++r) TakeLanes(ks + r * columns + c, b[r]);
    SolveFactored(n, factor, pivots, b.data());
    for (std::size_t r = 0; r < n; ++r) PutLanes(b[r], ks + r * columns + c);
  }
}

HYDROSCOPE_WIDE void DifferentiateImplicit(const TangentShape& shape, const TangentPoint* stages, double step,
                                           const double* s, double* k, double* end) {
  const auto n = static_cast<std::size_t>(shape.states), columns = static_cast<std::size_t>(shape.columns),
             size = n * columns;
  std::array<double, kMaxStates * kMaxStates> matrix;
  std::array<std::size_t, kMaxStates> pivots;
  const auto take = [&]<int kStage>(std::integral_constant<int, kStage>) __attribute__((always_inline)) {
    const TangentPoint& point = stages[kStage];
    double* own = k + kStage * size;
    SlopesFrom<kStage>(s, k, kImplicitA[kStage], step, size, end);
    PutOwnSlopes(shape, point, own);
    AddMovedSlopes(shape, point, end, own);
    PutStageMatrix(shape.entries.by_states, point.registers, point.held, step, n, matrix.data());
    FactorFew(n, matrix.data(), pivots.data());
    SolveColumns(n, columns, matrix.data(), pivots.data(), own);
  };
  take(std::integral_constant<int, 0>());
  take(std::integral_constant<int, 1>());
  take(std::integral_constant<int, 2>());
  take(std::integral_constant<int, 3>());
  take(std::integral_constant<int, 4>());
  SlopesFrom<kImplicitStages>(s, k, kImplicitA[kImplicitStages - 1], step, size, end);
}

}  // namespace

void DifferentiateStep(const TangentShape& shape, const TangentPoint* stages, double step, const double* s,
                       double* k, double* end) {
  DifferentiateExplicit(shape, stages, step, s, k, end);
}

void DifferentiateImplicitStep(const TangentShape& shape, const TangentPoint* stages, double step,
                               const double* s, double* k, double* end) {
  DifferentiateImplicit(shape, stages, step, s, k, end);
}

void PutStageMatrix(const std::vector<Entry>& by_states, const double* registers, const unsigned char* held,
                    double step, std::size_t n, double* matrix) {
  std::fill_n(matrix, n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) matrix[i * n + i] = 1;
  for (const auto& [row, column, place] : by_states)
    if (held[row] == 0)
      matrix[static_cast<std::size_t>(row) * n + static_cast<std::size_t>(column)] -=
          kImplicitOwn * step * registers[place];
}

}  // namespace hydroscope
