#include "diagnosis/remainder/held_out_form.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel/wide.h"

namespace hydroscope {
namespace {

constexpr int kGroupLanes = EightLanes::kCount;  ///< groups left out side by side, each in a lane of its own
constexpr int kColumnsAtOnce = 4;  ///< of the solution, for each element of the factor that is loaded
constexpr int kLanesAtOnce = 4;    ///< of choices of signs, for each element of the form that is loaded

/// Cholesky's factor of `a` (lower, by rows) in its place, with the inverse of its diagonal on the diagonal.
HYDROSCOPE_WIDE void FactorInPlace(int n, EightLanes* a) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      EightLanes left = a[i * n + j];
      for (int k = 0; k < j; ++k) SubtractProduct(a[i * n + k], a[j * n + k], left);
      if (j < i)
        PutProduct(left, a[j * n + j], a[i * n + j]);
      else
        for (int lane = 0; lane < kGroupLanes; ++lane) a[i * n + i].Set(lane, 1 / std::sqrt(left[lane]));
    }
}

/// Columns `x` (by rows of kColumnsAtOnce) become the solutions of the factored equations.
HYDROSCOPE_WIDE void SolveInPlace(int n, const EightLanes* factor, EightLanes* x) {
  for (int i = 0; i < n; ++i) {
    EightLanes left[kColumnsAtOnce];
    for (int c = 0; c < kColumnsAtOnce; ++c) left[c] = x[i * kColumnsAtOnce + c];
    for (int k = 0; k < i; ++k)
      for (int c = 0; c < kColumnsAtOnce; ++c)
        SubtractProduct(factor[i * n + k], x[k * kColumnsAtOnce + c], left[c]);
    for (int c = 0; c < kColumnsAtOnce; ++c)
      PutProduct(left[c], factor[i * n + i], x[i * kColumnsAtOnce + c]);
  }
  for (int i = n - 1; i >= 0; --i) {
    EightLanes left[kColumnsAtOnce];
    for (int c = 0; c < kColumnsAtOnce; ++c) left[c] = x[i * kColumnsAtOnce + c];
    for (int k = i + 1; k < n; ++k)
      for (int c = 0; c < kColumnsAtOnce; ++c)
        SubtractProduct(factor[k * n + i], x[k * kColumnsAtOnce + c], left[c]);
    for (int c = 0; c < kColumnsAtOnce; ++c)
      PutProduct(left[c], factor[i * n + i], x[i * kColumnsAtOnce + c]);
  }
}

/// `out` = symmetric `h` (by rows) times `x` (by rows of kColumnsAtOnce).
HYDROSCOPE_WIDE void Multiply(int n, const EightLanes* h, const EightLanes* x, EightLanes* out) {
  for (int i = 0; i < n; ++i) {
    EightLanes sum[kColumnsAtOnce] = {};
    for (int k = 0; k < n; ++k)
      for (int c = 0; c < kColumnsAtOnce; ++c) AddProduct(h[i * n + k], x[k * kColumnsAtOnce + c], sum[c]);
    for (int c = 0; c < kColumnsAtOnce; ++c) out[i * kColumnsAtOnce + c] = sum[c];
  }
}

/// `total` (by columns) less what each group has of it, by rows.
HYDROSCOPE_WIDE void TakeOff(int n, const double* total, const EightLanes* h, EightLanes* left) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) PutDifference(InAllLanes(total[j * n + i]), h[i * n + j], left[i * n + j]);
}

/// `column` of `x` (by rows of kColumnsAtOnce) times `q`.
HYDROSCOPE_WIDE void TimesColumn(int n, const EightLanes* x, int column, const EightLanes* q,
                                 EightLanes* product) {
  EightLanes sum;
  for (int i = 0; i < n; ++i) AddProduct(x[i * kColumnsAtOnce + column], q[i], sum);
  *product = sum;
}

/// x' y of each pair of columns, over all lanes.
HYDROSCOPE_WIDE void ProductsOverLanes(int n, const EightLanes* x, const EightLanes* y, double* products) {
  for (int a = 0; a < kColumnsAtOnce; ++a) {
    EightLanes sum[kColumnsAtOnce] = {};
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

/// Of as many choices as kLanesAtOnce lanes hold, whose `signs` are by groups.
HYDROSCOPE_WIDE void AddEnergies(int groups, const double* form, const EightLanes* signs,
                                 EightLanes* energies) {
  for (int i = 0; i < groups; ++i) {
    EightLanes sum[kLanesAtOnce] = {};
    for (int j = 0; j < i; ++j) {
      const EightLanes weight = InAllLanes(2 * form[i * groups + j]);
      for (int l = 0; l < kLanesAtOnce; ++l) AddProduct(weight, signs[j * kLanesAtOnce + l], sum[l]);
    }
    const EightLanes own = InAllLanes(form[i * groups + i]);
    for (int l = 0; l < kLanesAtOnce; ++l) {
      AddProduct(own, signs[i * kLanesAtOnce + l], sum[l]);
      AddProduct(sum[l], signs[i * kLanesAtOnce + l], energies[l]);
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
        factor_(h_.size()),
        q_(static_cast<std::size_t>(n_)) {
    for (int lane = 0; lane < lanes_; ++lane) {
      used_.Set(lane, 1);
      for (int i = 0; i < n_; ++i) {
        q_[i].Set(lane, groups.q(i, first + lane));
        for (int j = 0; j < n_; ++j) h_[i * n_ + j].Set(lane, groups.h[first + lane](i, j));
      }
    }
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
  EightLanes used_;                     ///< 1 in lanes that hold a group
  std::vector<EightLanes> h_, factor_;  ///< n x n
  std::vector<EightLanes> q_;           ///< n
  std::vector<EightLanes>
      solutions_;  ///< c_u without each group, kColumnsAtOnce by kColumnsAtOnce; c_s without s is 0
};

void LeftOut::Solve(const Eigen::MatrixXd& total) {
  TakeOff(n_, total.data(), h_.data(), factor_.data());
  FactorInPlace(n_, factor_.data());
  const Eigen::Index groups = groups_.q.cols();
  const auto blocks = static_cast<std::size_t>((groups + kColumnsAtOnce - 1) / kColumnsAtOnce);
  solutions_.assign(blocks * block_size(), EightLanes{});
  for (std::size_t b = 0; b < blocks; ++b) {
    EightLanes* const x = solutions_.data() + b * block_size();
    for (int c = 0; c < kColumnsAtOnce; ++c) {
      const Eigen::Index u = static_cast<Eigen::Index>(b) * kColumnsAtOnce + c, own = u - first_;
      if (u >= groups) continue;
      EightLanes others = used_;
      if (own >= 0 && own < lanes_) others.Set(static_cast<int>(own), 0);
      for (int i = 0; i < n_; ++i) PutProduct(InAllLanes(groups_.q(i, u)), others, x[i * kColumnsAtOnce + c]);
    }
    SolveInPlace(n_, factor_.data(), x);
  }
}

void LeftOut::AddTo(const Eigen::MatrixXd& total, Eigen::MatrixXd& form) {
  Solve(total);
  std::vector<EightLanes> h_times(block_size());
  std::array<double, kColumnsAtOnce * kColumnsAtOnce> products;
  for (std::size_t second = 0; second < blocks(); ++second) {
    const EightLanes* const y = solutions_.data() + second * block_size();
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
  for (Eigen::Index u = 0; u < form.cols(); ++u) {
    EightLanes cross;
    TimesColumn(n_, solutions_.data() + u / kColumnsAtOnce * block_size(),
                static_cast<int>(u % kColumnsAtOnce), q_.data(), &cross);
    for (int lane = 0; lane < lanes_; ++lane) {
      const Eigen::Index s = first_ + lane;
      form(std::max(s, u), std::min(s, u)) -= cross[lane];  // its own solution is 0
    }
  }
  for (int lane = 0; lane < lanes_; ++lane)
    form(first_ + lane, first_ + lane) += groups_.energy[first_ + lane];
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

SignChoices::SignChoices(const Eigen::MatrixXd& signs) : groups_(signs.rows()), choices_(signs.cols()) {
  constexpr Eigen::Index kTogether = kGroupLanes * kLanesAtOnce;
  const Eigen::Index blocks = (choices_ + kTogether - 1) / kTogether;
  signs_.resize(static_cast<std::size_t>(blocks * groups_ * kLanesAtOnce));
  for (Eigen::Index c = 0; c < choices_; ++c)
    for (Eigen::Index g = 0; g < groups_; ++g)
      signs_[static_cast<std::size_t>((c / kTogether * groups_ + g) * kLanesAtOnce +
                                      c % kTogether / kGroupLanes)]
          .Set(static_cast<int>(c % kGroupLanes), signs(g, c));
}

Eigen::VectorXd SignChoices::Energies(const Eigen::MatrixXd& form) const {
  Eigen::VectorXd out(choices_);
  constexpr Eigen::Index kTogether = kGroupLanes * kLanesAtOnce;
  for (Eigen::Index first = 0; first < choices_; first += kTogether) {
    EightLanes energies[kLanesAtOnce] = {};
    AddEnergies(static_cast<int>(groups_), form.data(),
                signs_.data() + first / kTogether * groups_ * kLanesAtOnce, energies);
    for (Eigen::Index k = 0; k < std::min(kTogether, choices_ - first); ++k)
      out[first + k] = energies[k / kGroupLanes][static_cast<int>(k % kGroupLanes)];
  }
  return out;
}

}  // namespace hydroscope
