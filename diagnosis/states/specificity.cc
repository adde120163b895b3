#include "diagnosis/states/specificity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "diagnosis/states/function_bank.h"
#include "diagnosis/states/tangent.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

/// Measured less modelled without the effect, less the same with it.
std::vector<RowMatrix> Contribution(const StateFit& rest, const StateFit& with) {
  std::vector<RowMatrix> out;
  for (std::size_t e = 0; e < rest.residuals.size(); ++e)
    out.push_back(rest.residuals[e] - with.residuals[e]);
  return out;
}

/// Energy of finite values, each output over its noise.
double Energy(const std::vector<RowMatrix>& errors, const Eigen::VectorXd& noise) {
  double sum = 0;
  for (const RowMatrix& error : errors)
    for (Eigen::Index row = 0; row < error.rows(); ++row)
      for (Eigen::Index j = 0; j < error.cols(); ++j)
        if (std::isfinite(error(row, j))) sum += std::pow(error(row, j) / noise[j], 2);
  return sum;
}

/// Products of columns (parameters, functions, contribution, error) by piece.
struct Products {
  std::vector<Eigen::MatrixXd> pieces;
  Eigen::MatrixXd total;
  Eigen::Index parameters = 0;
};

Products ProductsOf(const StateFit& rest, std::span<const Episode> episodes, const AddedTerms& added,
                    const std::vector<RowMatrix>& contribution) {
  Products out;
  out.parameters = rest.model->parameter_count();
  out.pieces = PieceProducts(rest, episodes, added, {&contribution, &rest.residuals});
  const Eigen::Index size = out.parameters + added.columns + 2;
  out.total = Eigen::MatrixXd::Zero(size, size);
  for (const Eigen::MatrixXd& piece : out.pieces) out.total += piece;
  return out;
}

/// Per piece, the energy of the error after a regression on the parameters and one more column over all other pieces.
std::vector<double> EnergiesWith(const Products& products, Eigen::Index column) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index p = 0; p < products.parameters; ++p) kept.push_back(p);
  kept.push_back(column);
  const Eigen::Index error = products.total.rows() - 1;
  std::vector<StatePiece> pieces;
  for (const Eigen::MatrixXd& all : products.pieces) {
    StatePiece piece;
    piece.information = all(kept, kept);
    piece.gradient = all(kept, error);
    piece.energy = all(error, error);
    pieces.push_back(std::move(piece));
  }
  return HeldOutEnergies(pieces);
}

/// Squared correlation of two columns when the parameters are taken out of both.
class Correlation {
 public:
  explicit Correlation(const Products& products) : total_(products.total), own_(products.parameters) {
    by_parameters_ = ScaledFactor(total_.topLeftCorner(own_, own_)).SolveColumns(total_.topRows(own_));
  }
  double Squared(Eigen::Index a, Eigen::Index b) const {
    const double both = Product(a, b);
    return both * both / std::max(Product(a, a) * Product(b, b), 1e-300);
  }

 private:
  double Product(Eigen::Index a, Eigen::Index b) const {
    return total_(a, b) - total_.col(a).head(own_).dot(by_parameters_.col(b));
  }
  const Eigen::MatrixXd& total_;
  Eigen::Index own_;
  Eigen::MatrixXd by_parameters_;
};

}  // namespace

Specificity::Specificity(const StateFit& rest, const StateFit& with, std::span<const Episode> episodes,
                         const SpecificityOptions& options) {
  const std::vector<RowMatrix> contribution = Contribution(rest, with);
  weak_ =
      Energy(contribution, rest.noise) <= options.weak * options.weak * Energy(with.residuals, rest.noise);
  if (!weak_) return;
  const FunctionBank bank(rest, episodes, 0,
                          0);  // sums of all states and inputs are no law that anybody would name
  std::vector<int> equation;
  const AddedTerms added = bank.Terms(equation);
  const Products products = ProductsOf(rest, episodes, added, contribution);
  const Eigen::Index effect = products.parameters + added.columns;
  with_effect_ = EnergiesWith(products, effect);
  const Correlation correlation(products);
  for (Eigen::Index k = 0; k < added.columns; ++k) {
    const Eigen::Index column = products.parameters + k;
    if (correlation.Squared(column, effect) > options.same_law) continue;
    const auto at = static_cast<std::size_t>(k);
    functions_.push_back(
        {{EquationName(*rest.model, equation[at]), bank.About(static_cast<int>(k) % bank.count())},
         EnergiesWith(products, column)});
  }
}

const Specificity::Function* Specificity::Best() const {
  const auto energy = [](const Function& function) {
    return std::accumulate(function.energies.begin(), function.energies.end(), 0.0);
  };
  const auto best = std::min_element(functions_.begin(), functions_.end(),
                                     [&](const auto& a, const auto& b) { return energy(a) < energy(b); });
  return best == functions_.end() ? nullptr : &*best;
}

}  // namespace hydroscope
