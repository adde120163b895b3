#include "diagnosis/states/remainder.h"

#include "diagnosis/states/function_bank.h"
#include "diagnosis/states/left_out_columns.h"
#include "diagnosis/states/tangent.h"

namespace hydroscope {
namespace {

/// Of groups of pieces left out, where single pieces show less than a law: beyond it chance is no reason either, though parameters
/// that only one group tells of may be. An effect that stands in for another law fits all groups but those that show it best.
constexpr double kOfGroupsAlone = 0.25;

/// The equation whose functions alone predict most; `equation` of each function: state, or states + output.
std::string MostIn(const StateFit& fit, const LeftOutColumns& columns, const std::vector<int>& equation) {
  const StateModel& model = *fit.model;
  std::string about;
  double most = 0;
  for (int e = 0; e < model.states() + model.output.rows; ++e) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < columns.parameters(); ++i) kept.push_back(i);
    for (std::size_t k = 0; k < equation.size(); ++k)
      if (equation[k] == e) kept.push_back(columns.parameters() + static_cast<Eigen::Index>(k));
    if (kept.size() == static_cast<std::size_t>(columns.parameters())) continue;
    const double share = columns.Some(kept).Share();
    if (share <= most) continue;
    most = share;
    about = EquationName(model, e);
  }
  return about;
}

}  // namespace

StateRemainder RemainderOf(const StateFit& fit, std::span<const Episode> episodes,
                           const StateRemainderOptions& options) {
  const FunctionBank bank(fit, episodes, options.fourier, options.seed);
  std::vector<int> equation;  // but kinematic ones
  const AddedTerms added = bank.Terms(equation);
  LeftOutColumns columns(fit, episodes.size(), added.columns);
  for (std::size_t e = 0; e < episodes.size(); ++e)
    columns.Add(fit, e, TangentColumns(fit, episodes[e], e, added, {&fit.residuals[e]}));
  StateRemainder out = columns.Remainder(fit, options);
  out.structured = out.p_value <= options.max_p && out.least_share >= options.min_share;
  out.doubtful =
      !out.structured && ((out.p_value <= options.doubt_p && out.least_share >= options.doubt_share) ||
                          (out.p_value <= options.max_p && out.share >= kOfGroupsAlone));
  out.powerless = !out.structured && out.null_share >= options.powerless;
  out.bursts = FindErrorBursts(fit, episodes, options.bursts);
  if (out.structured || out.doubtful) out.about = MostIn(fit, columns, equation);
  return out;
}

}  // namespace hydroscope
