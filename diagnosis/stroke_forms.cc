#include "diagnosis/stroke_forms.h"

#include <algorithm>
#include <numbers>

#include "core/parallel/wide.h"
#include "estimation/normal_equations.h"

namespace hydroscope {
namespace {

HYDROSCOPE_WIDE void AddScaled(std::size_t blocks, double weight, const EightLanes* from, EightLanes* to) {
  const EightLanes weights = InAllLanes(weight);
  for (std::size_t b = 0; b < blocks; ++b) AddProduct(weights, from[b], to[b]);
}

/// Of one block of strokes, each left out of `total` (lower triangle by rows, the output last): theta of `n` parameters, and the
/// determinant of the regressors scaled to a unit diagonal, 0 where they are not positive definite. By Cholesky's LDL' without
/// pivoting, each pivot over the diagonal; `factor`: room for n (n + 2) numbers. Elements of `clean` are `stride` apart.
HYDROSCOPE_WIDE void SolveWithout(int n, const double* total, const EightLanes* clean, std::size_t stride,
                                  EightLanes* factor, EightLanes* theta, EightLanes* determinant) {
  EightLanes *const pivots = factor + n * n, *const inverse = pivots + n;  // L D below the diagonal, L' above
  EightLanes product = InAllLanes(1);
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j < n && j <= i; ++j, ++total, clean += stride) {
      EightLanes left;
      PutDifference(InAllLanes(*total), *clean, left);
      const EightLanes whole = left;
      // The output's row goes the same way and leaves D L^-1 of the right-hand side in `theta`.
      EightLanes* const row = i < n ? factor + i * n : theta;
      for (int k = 0; k < j; ++k) SubtractProduct(row[k], factor[k * n + j], left);
      if (j < i) {
        row[j] = left;
        if (i < n) PutProduct(left, inverse[j], factor[j * n + i]);
        continue;
      }
      for (int h = 0; h < 2; ++h) {
        inverse[i].half[h] = 1.0 / left.half[h];
        const EightLanes::Four share = left.half[h] / whole.half[h];
        product.half[h] = share > 0.0 ? product.half[h] * share : EightLanes::Four{};
      }
    }
  }
  for (int i = n - 1; i >= 0; --i) {
    EightLanes solved;
    PutProduct(theta[i], inverse[i], solved);
    for (int k = i + 1; k < n; ++k) SubtractProduct(factor[i * n + k], theta[k], solved);
    theta[i] = solved;
  }
  *determinant = product;
}

/// What theta leaves of one block's `form`, whose elements are `stride` apart.
HYDROSCOPE_WIDE void Energies(int n, const EightLanes* form, std::size_t stride, const EightLanes* theta,
                              EightLanes* energy) {
  EightLanes sum;
  for (int i = 0; i <= n; ++i) {
    EightLanes row;
    for (int j = 0; j < i; ++j, form += stride) AddProduct(*form, theta[j], row);
    for (auto& half : row.half) half *= 2.0;
    if (i < n) {
      AddProduct(*form, theta[i], row);
      AddProduct(row, theta[i], sum);
      form += stride;
    } else {
      PutDifference(*form, row, row);
      for (int h = 0; h < 2; ++h) sum.half[h] += row.half[h];
    }
  }
  *energy = sum;
}

/// The same of one stroke, with pivots and their judgement; empty if its regressors are not independent.
Eigen::VectorXd SolveWithoutOne(const StrokeForms& clean, const Eigen::MatrixXd& total, std::size_t stroke) {
  const Eigen::Index n = total.cols() - 1;
  Eigen::MatrixXd left(n + 1, n + 1);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= i; ++j) left(i, j) = left(j, i) = total(i, j) - clean.Of(stroke, i, j);
  return SolveNormalEquations({left.topLeftCorner(n, n), left.col(n).head(n), left(n, n), 0});
}

/// The n - 1 larger eigenvalues of a matrix with a unit diagonal have a product below e (their mean is at most n / (n - 1)), so that
/// its determinant over e is below the least one: such a condition is far from what SolveNormalEquations refuses.
bool IsCertain(double determinant, int n) { return determinant > kLeastCondition * std::numbers::e * n * n; }

}  // namespace

Eigen::MatrixXd StrokeForms::Sum(std::span<const std::size_t> strokes) const {
  Eigen::MatrixXd sum(size_, size_);
  for (int i = 0; i < size_; ++i)
    for (int j = 0; j <= i; ++j) {
      double element = 0;
      for (const std::size_t s : strokes) element += Of(s, i, j);
      sum(i, j) = sum(j, i) = element;
    }
  return sum;
}

const EightLanes* GramElements::Gathered(int a, int b, std::size_t blocks) {
  const std::size_t element =
      SymmetricMatrix::Size(std::max(a, b)) + static_cast<std::size_t>(std::min(a, b));
  int& place = place_[element];
  if (place < 0) {
    place = static_cast<int>(gathered_.size());
    gathered_.resize(gathered_.size() + blocks);
    for (std::size_t s = 0; s < strokes_.size(); ++s)
      gathered_[place + s / EightLanes::kCount].Set(static_cast<int>(s % EightLanes::kCount),
                                                    strokes_[s]->packed()[element]);
  }
  return gathered_.data() + place;
}

StrokeForms GramElements::Congruence(const SparseColumns& columns) {
  const std::lock_guard lock(gathering_);
  const int size = static_cast<int>(columns.size());
  StrokeForms forms(size, strokes_.size());
  if (!strokes_.empty()) place_.resize(strokes_.front()->packed().size(), -1);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j <= i; ++j)
      for (const auto& [a, weight_a] : columns[j])
        for (const auto& [b, weight_b] : columns[i])
          AddScaled(forms.blocks(), weight_a * weight_b, Gathered(a, b, forms.blocks()), forms.At(i, j));
  return forms;
}

LeftOutStrokes LeaveOutEach(const StrokeForms& clean, const StrokeForms& flow, const Eigen::MatrixXd& total,
                            const Eigen::VectorXd& whole, std::span<const std::size_t> strokes) {
  const int n = clean.size() - 1;
  std::vector<double> lower;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= i; ++j) lower.push_back(total(i, j));
  std::vector<EightLanes> factor(static_cast<std::size_t>(n) * (n + 2)), theta(n * clean.blocks()),
      determinants(clean.blocks());
  for (std::size_t b = 0; b < clean.blocks(); ++b)
    SolveWithout(n, lower.data(), clean.At(0, 0) + b, clean.blocks(), factor.data(), theta.data() + b * n,
                 &determinants[b]);
  LeftOutStrokes out{Eigen::MatrixXd::Zero(n, strokes.size()), std::vector<bool>(strokes.size(), false),
                     Eigen::VectorXd(strokes.size()), Eigen::VectorXd(strokes.size())};
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    const std::size_t block = strokes[k] / EightLanes::kCount;
    const int lane = static_cast<int>(strokes[k] % EightLanes::kCount);
    if (!IsCertain(determinants[block][lane], n)) {
      const Eigen::VectorXd solved = SolveWithoutOne(clean, total, strokes[k]);
      out.indispensable[k] = solved.size() == 0;
      for (int i = 0; i < n; ++i) theta[block * n + i].Set(lane, (solved.size() == 0 ? whole : solved)[i]);
    }
    for (int i = 0; i < n; ++i) out.theta(i, k) = theta[block * n + i][lane];
  }
  for (const auto& [forms, errors] : {std::pair(&clean, &out.error), std::pair(&flow, &out.flow_error)}) {
    std::vector<EightLanes> energies(clean.blocks());
    for (std::size_t b = 0; b < clean.blocks(); ++b)
      Energies(n, forms->At(0, 0) + b, clean.blocks(), theta.data() + b * n, &energies[b]);
    for (std::size_t k = 0; k < strokes.size(); ++k)
      (*errors)[k] =
          energies[strokes[k] / EightLanes::kCount][static_cast<int>(strokes[k] % EightLanes::kCount)];
  }
  return out;
}

}  // namespace hydroscope
