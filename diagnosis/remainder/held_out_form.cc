#include "diagnosis/remainder/held_out_form.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/wide.h"

namespace hydroscope {
namespace {

constexpr int kGroupLanes = 8;     ///< groups left out side by side, each in a lane of its own
constexpr int kColumnsAtOnce = 4;  ///< of the solution, for each element of the factor that is loaded

/// A number per group, in two vectors of four: vectors of eight, without AVX-512, are taken apart into words in memory by GCC 12 and
/// put together again, at every operation. Aligned as memory without AVX is, whichever processor a function is compiled for.
struct GroupLanes {
  typedef double Four __attribute__((vector_size(32), aligned(16)));
  Four half[2] = {};
  double operator[](int lane) const { return half[lane / 4][lane % 4]; }
  void Set(int lane, double value) { half[lane / 4][lane % 4] = value; }
};
[[gnu::always_inline]] inline void AddProduct(const GroupLanes& a, const GroupLanes& b, GroupLanes& sum) {
  for (int h = 0; h < 2; ++h) sum.half[h] += a.half[h] * b.half[h];
}
[[gnu::always_inline]] inline void SubtractProduct(const GroupLanes& a, const GroupLanes& b,
                                                   GroupLanes& left) {
  for (int h = 0; h < 2; ++h) left.half[h] -= a.half[h] * b.half[h];
}
[[gnu::always_inline]] inline void PutProduct(const GroupLanes& a, const GroupLanes& b, GroupLanes& out) {
  for (int h = 0; h < 2; ++h) out.half[h] = a.half[h] * b.half[h];
}

/// Cholesky's factor of `a` (lower, by rows) in its place, with the inverse of its diagonal on the diagonal.
HYDROSCOPE_WIDE void FactorInPlace(int n, GroupLanes* a) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      GroupLanes left = a[i * n + j];
      for (int k = 0; k < j; ++k) SubtractProduct(a[i * n + k], a[j * n + k], left);
      if (j < i)
        PutProduct(left, a[j * n + j], a[i * n + j]);
      else
        for (int lane = 0; lane < kGroupLanes; ++lane) a[i * n + i].Set(lane, 1 / std::sqrt(left[lane]));
    }
}

/// Columns `x` (by rows of kColumnsAtOnce) become the solutions of the factored equations.
HYDROSCOPE_WIDE void SolveInPlace(int n, const GroupLanes* factor, GroupLanes* x) {
  for (int i = 0; i < n; ++i) {
    GroupLanes left[kColumnsAtOnce];
    for (int c = 0; c < kColumnsAtOnce; ++c) left[c] = x[i * kColumnsAtOnce + c];
    for (int k = 0; k < i; ++k)
      for (int c = 0; c < kColumnsAtOnce; ++c)
        SubtractProduct(factor[i * n + k], x[k * kColumnsAtOnce + c], left[c]);
    for (int c = 0; c < kColumnsAtOnce; ++c)
      PutProduct(left[c], factor[i * n + i], x[i * kColumnsAtOnce + c]);
  }
  for (int i = n - 1; i >= 0; --i) {
    GroupLanes left[kColumnsAtOnce];
    for (int c = 0; c < kColumnsAtOnce; ++c) left[c] = x[i * kColumnsAtOnce + c];
    for (int k = i + 1; k < n; ++k)
      for (int c = 0; c < kColumnsAtOnce; ++c)
        SubtractProduct(factor[k * n + i], x[k * kColumnsAtOnce + c], left[c]);
    for (int c = 0; c < kColumnsAtOnce; ++c)
      PutProduct(left[c], factor[i * n + i], x[i * kColumnsAtOnce + c]);
  }
}

/// `out` = symmetric `h` (by rows) times `x` (by rows of kColumnsAtOnce).
HYDROSCOPE_WIDE void Multiply(int n, const GroupLanes* h, const GroupLanes* x, GroupLanes* out) {
  for (int i = 0; i < n; ++i) {
    GroupLanes sum[kColumnsAtOnce] = {};
    for (int k = 0; k < n; ++k)
      for (int c = 0; c < kColumnsAtOnce; ++c) AddProduct(h[i * n + k], x[k * kColumnsAtOnce + c], sum[c]);
    for (int c = 0; c < kColumnsAtOnce; ++c) out[i * kColumnsAtOnce + c] = sum[c];
  }
}

/// x' y of each pair of columns, over all lanes.
HYDROSCOPE_WIDE void ProductsOverLanes(int n, const GroupLanes* x, const GroupLanes* y, double* products) {
  for (int a = 0; a < kColumnsAtOnce; ++a) {
    GroupLanes sum[kColumnsAtOnce] = {};
    for (int i = 0; i < n; ++i)
      for (int b = 0; b < kColumnsAtOnce; ++b)
        AddProduct(x[i * kColumnsAtOnce + a], y[i * kColumnsAtOnce + b], sum[b]);
    for (int b = 0; b < kColumnsAtOnce; ++b) {
      double total = 0;
      for (int lane = 0; lane < kGroupLanes; ++lane) total += sum[b][lane];
      products[a * kColumnsAtOnce + b] = total;
    }
  }
}

/// The groups from `first` on, one a lane, each left out in turn.
class LeftOut {
 public:
  LeftOut(const GroupEquations& groups, Eigen::Index first)
      : groups_(groups),
        n_(static_cast<int>(groups.q.rows())),
        first_(first),
        lanes_(static_cast<int>(std::min<Eigen::Index>(kGroupLanes, groups.q.cols() - first))),
        h_(static_cast<std::size_t>(n_) * n_),
        factor_(h_.size()) {
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j)
        for (int lane = 0; lane < lanes_; ++lane) h_[i * n_ + j].Set(lane, groups.h[first + lane](i, j));
  }

  /// To the lower half of `form`. `total`: equations of all groups, with the ridge.
  void AddTo(const Eigen::MatrixXd& total, Eigen::MatrixXd& form);

 private:
  std::size_t block_size() const { return static_cast<std::size_t>(n_) * kColumnsAtOnce; }
  std::size_t blocks() const { return solutions_.size() / block_size(); }
  void Solve(const Eigen::MatrixXd& total);

  const GroupEquations& groups_;
  int n_;
  Eigen::Index first_;
  int lanes_;
  std::vector<GroupLanes> h_, factor_;  ///< n x n
  std::vector<GroupLanes>
      solutions_;  ///< c_u without each group, kColumnsAtOnce by kColumnsAtOnce; c_s without s is 0
};

void LeftOut::Solve(const Eigen::MatrixXd& total) {
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j)
      for (int lane = 0; lane < kGroupLanes; ++lane)
        factor_[i * n_ + j].Set(lane, total(i, j) - h_[i * n_ + j][lane]);
  FactorInPlace(n_, factor_.data());
  const Eigen::Index groups = groups_.q.cols();
  const auto blocks = static_cast<std::size_t>((groups + kColumnsAtOnce - 1) / kColumnsAtOnce);
  solutions_.assign(blocks * block_size(), GroupLanes{});
  for (std::size_t b = 0; b < blocks; ++b) {
    GroupLanes* const x = solutions_.data() + b * block_size();
    for (int c = 0; c < kColumnsAtOnce; ++c) {
      const Eigen::Index u = static_cast<Eigen::Index>(b) * kColumnsAtOnce + c;
      for (int i = 0; u < groups && i < n_; ++i)
        for (int lane = 0; lane < lanes_; ++lane)
          x[i * kColumnsAtOnce + c].Set(lane, u == first_ + lane ? 0.0 : groups_.q(i, u));
    }
    SolveInPlace(n_, factor_.data(), x);
  }
}

void LeftOut::AddTo(const Eigen::MatrixXd& total, Eigen::MatrixXd& form) {
  Solve(total);
  std::vector<GroupLanes> h_times(block_size());
  std::array<double, kColumnsAtOnce * kColumnsAtOnce> products;
  for (std::size_t second = 0; second < blocks(); ++second) {
    const GroupLanes* const y = solutions_.data() + second * block_size();
    Multiply(n_, h_.data(), y, h_times.data());
    for (std::size_t first = second; first < blocks(); ++first) {  // the form is symmetric: its lower half
      ProductsOverLanes(n_, solutions_.data() + first * block_size(), h_times.data(), products.data());
      for (int a = 0; a < kColumnsAtOnce; ++a)
        for (int b = 0; b < kColumnsAtOnce; ++b) {
          const auto row = static_cast<Eigen::Index>(first) * kColumnsAtOnce + a;
          const auto column = static_cast<Eigen::Index>(second) * kColumnsAtOnce + b;
          if (row < form.rows() && column <= row) form(row, column) += products[a * kColumnsAtOnce + b];
        }
    }
  }
  for (int lane = 0; lane < lanes_; ++lane) {
    const Eigen::Index s = first_ + lane;
    for (Eigen::Index u = 0; u < form.cols(); ++u) {
      const GroupLanes* const x = solutions_.data() + u / kColumnsAtOnce * block_size() + u % kColumnsAtOnce;
      double cross = 0;
      for (int i = 0; i < n_; ++i) cross += x[i * kColumnsAtOnce][lane] * groups_.q(i, s);
      form(std::max(s, u), std::min(s, u)) -= cross;  // its own solution is 0
    }
    form(s, s) += groups_.energy[s];
  }
}

}  // namespace

std::vector<Eigen::MatrixXd> HeldOutForms(const GroupEquations& groups, const Eigen::MatrixXd& ridges) {
  const Eigen::Index n = groups.q.rows(), count = groups.q.cols();
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::MatrixXd& h : groups.h) total += h;
  std::vector<Eigen::MatrixXd> forms(static_cast<std::size_t>(ridges.cols()),
                                     Eigen::MatrixXd::Zero(count, count));
  for (Eigen::Index first = 0; first < count; first += kGroupLanes) {
    LeftOut left_out(groups, first);
    for (std::size_t k = 0; k < forms.size(); ++k) {
      Eigen::MatrixXd held = total;
      held.diagonal() += ridges.col(static_cast<Eigen::Index>(k));
      left_out.AddTo(held, forms[k]);
    }
  }
  for (Eigen::MatrixXd& form : forms)
    form.triangularView<Eigen::StrictlyUpper>() = form.transpose().triangularView<Eigen::StrictlyUpper>();
  return forms;
}

}  // namespace hydroscope
