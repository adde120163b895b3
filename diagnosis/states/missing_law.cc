#include "diagnosis/states/missing_law.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/constants.h"
#include "diagnosis/states/function_bank.h"
#include "diagnosis/states/tangent.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

using Columns = std::vector<Eigen::Index>;

/// Products of the columns (parameters, functions, last the error) over groups of neighbouring pieces.
std::vector<Eigen::MatrixXd> GroupProducts(const std::vector<Eigen::MatrixXd>& pieces, int groups) {
  std::vector<Eigen::MatrixXd> out;
  const auto count = std::min<std::size_t>(static_cast<std::size_t>(groups), pieces.size());
  for (std::size_t g = 0; g < count; ++g) {
    out.push_back(pieces[g * pieces.size() / count]);
    for (std::size_t p = g * pieces.size() / count + 1; p < (g + 1) * pieces.size() / count; ++p)
      out.back() += pieces[p];
  }
  return out;
}

/// Ridge regression of the error on parameters, unpenalised, and some functions.
class LawRegression {
 public:
  LawRegression(const std::vector<Eigen::MatrixXd>& groups, int parameters, double ridge)
      : groups_(groups), parameters_(parameters), ridge_(ridge) {
    total_ = groups.front();
    for (std::size_t g = 1; g < groups.size(); ++g) total_ += groups[g];
  }

  /// Weights of parameters and functions (in this order) without a group; -1: of all groups.
  Eigen::VectorXd Weights(const Columns& functions, int without) const {
    const Columns columns = All(functions);
    Eigen::MatrixXd products = total_;
    if (without >= 0) products -= groups_[static_cast<std::size_t>(without)];
    const Eigen::VectorXd scale = total_.diagonal()(columns).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd own = scale.asDiagonal() * products(columns, columns) * scale.asDiagonal();
    own.diagonal().head(parameters_).array() += kRound;
    own.diagonal().tail(static_cast<Eigen::Index>(functions.size())).array() += ridge_;
    const Eigen::VectorXd cross = scale.cwiseProduct(products(columns, total_.cols() - 1));
    return scale.cwiseProduct(PositiveFactor(own).SolveColumns(cross));
  }
  /// Energy of the error on groups left out in turn.
  double LeftOut(const Columns& functions) const {
    const Columns columns = All(functions);
    const Eigen::Index error = total_.cols() - 1;
    double energy = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const Eigen::VectorXd w = Weights(functions, static_cast<int>(g));
      const Eigen::MatrixXd& here = groups_[g];
      energy +=
          here(error, error) - 2 * w.dot(here(columns, error).matrix()) + w.dot(here(columns, columns) * w);
    }
    return energy;
  }
  int groups() const { return static_cast<int>(groups_.size()); }

 private:
  static constexpr double kRound = 1e-9;  ///< parameters that the data do not see stay where they are
  Columns All(const Columns& functions) const {
    Columns out;
    for (int p = 0; p < parameters_; ++p) out.push_back(p);
    out.insert(out.end(), functions.begin(), functions.end());
    return out;
  }

  const std::vector<Eigen::MatrixXd>& groups_;
  int parameters_;
  double ridge_;
  Eigen::MatrixXd total_;
};

/// Takes the straight line out of each column that fits it best over the points, which are evenly apart: nearly every equation
/// has a term that is linear in its variable, and takes a line over.
void TakeLinesOut(Eigen::MatrixXd& curves) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(curves.rows(), -1, 1);
  curves.rowwise() -= curves.colwise().mean().eval();
  curves -= x * (x.transpose() * curves / x.squaredNorm()).eval();
}

/// Where the curve is drawn: evenly between the lowest and the highest value seen, but for the outermost.
Eigen::VectorXd PointsOver(const std::vector<double>& seen, const MissingLawOptions& options) {
  const auto at = [&](double share) {
    return seen[static_cast<std::size_t>(share * static_cast<double>(seen.size() - 1))];
  };
  return Eigen::VectorXd::LinSpaced(options.points, at((1 - options.inner_share) / 2),
                                    at((1 + options.inner_share) / 2));
}

/// Points x functions of one variable, straight lines taken out.
Eigen::MatrixXd CurvesOf(const StateModel& model, const FunctionBank& bank, int variable,
                         const std::vector<int>& functions, const Eigen::VectorXd& points) {
  std::vector<double> state(static_cast<std::size_t>(model.states())), input(model.inputs.size()),
      values(static_cast<std::size_t>(bank.count()));
  double& moved = variable < model.states() ? state[static_cast<std::size_t>(variable)]
                                            : input[static_cast<std::size_t>(variable - model.states())];
  Eigen::MatrixXd curves(points.size(), static_cast<Eigen::Index>(functions.size()));
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    moved = points[k];
    bank.Values(state.data(), input.data(), values.data());
    for (Eigen::Index f = 0; f < curves.cols(); ++f)
      curves(k, f) = values[static_cast<std::size_t>(functions[static_cast<std::size_t>(f)])];
  }
  TakeLinesOut(curves);
  return curves;
}

/// The curve with its scatter where groups are left out in turn (jackknife).
std::vector<MissingLaw::Point> Drawn(const LawRegression& regression, const Columns& columns,
                                     const Eigen::VectorXd& points, const Eigen::MatrixXd& curves) {
  const auto without = [&](int group) -> Eigen::VectorXd {
    return curves * regression.Weights(columns, group).tail(curves.cols());
  };
  const Eigen::VectorXd curve = without(-1);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(curve.size());
  for (int g = 0; g < regression.groups(); ++g) spread += (without(g) - curve).cwiseAbs2();
  const double groups = regression.groups();
  std::vector<MissingLaw::Point> out;
  for (Eigen::Index k = 0; k < points.size(); ++k)
    out.push_back({points[k], curve[k], std::sqrt(spread[k] * (groups - 1) / groups)});
  return out;
}

}  // namespace

std::optional<MissingLaw> FindMissingLaw(const StateFit& fit, std::span<const Episode> episodes,
                                         const std::string& about, const MissingLawOptions& options) {
  const StateModel& model = *fit.model;
  const FunctionBank bank(fit, episodes, 0, 0);
  std::vector<int> equation;
  const AddedTerms added = bank.Terms(equation);
  const std::vector<Eigen::MatrixXd> groups =
      GroupProducts(PieceProducts(fit, episodes, added, {&fit.residuals}), options.groups);
  if (groups.size() < 2) return std::nullopt;
  const LawRegression regression(groups, model.parameter_count(), options.ridge);
  struct Law {
    std::vector<int> functions;
    Columns columns;
  };
  std::map<int, Law> laws;  // by variable
  for (std::size_t k = 0; k < equation.size(); ++k) {
    const int function = static_cast<int>(k) % bank.count();
    const auto variable = bank.Variable(function);
    if (!variable || EquationName(model, equation[k]) != about) continue;
    laws[*variable].functions.push_back(function);
    laws[*variable].columns.push_back(model.parameter_count() + static_cast<Eigen::Index>(k));
  }
  const double before = regression.LeftOut({});
  double least = (1 - options.min_share) * before;
  std::optional<int> best;
  for (const auto& [variable, law] : laws) {
    const double left = regression.LeftOut(law.columns);
    if (!(left < least)) continue;
    least = left;
    best = variable;
  }
  if (!best) return std::nullopt;

  const auto& states = model.machine.states.states;
  MissingLaw out;
  out.equation = about;
  out.of_state =
      std::any_of(states.begin(), states.end(), [&](const StateSpec& state) { return state.name == about; });
  out.variable = bank.VariableName(*best);
  out.share = 1 - least / before;
  const Eigen::VectorXd points = PointsOver(ValuesOf(fit, episodes, *best), options);
  out.points = Drawn(regression, laws[*best].columns, points,
                     CurvesOf(model, bank, *best, laws[*best].functions, points));
  const bool clear = std::any_of(out.points.begin(), out.points.end(), [](const MissingLaw::Point& point) {
    return std::abs(point.value) > kNormal95 * point.std;
  });
  return clear ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace hydroscope
