#include "diagnosis/states/other_causes/parameter_drift.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/constants.h"
#include "core/interval_text.h"
#include "core/relative_change.h"
#include "core/unit_told.h"
#include "core/units.h"
#include "diagnosis/states/state_candidate.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

/// Pieces with the slope of a parameter over the log beside the parameters that are free: its columns are those of the parameter,
/// times -1/2 at the log's begin and 1/2 at its end.
std::vector<StatePiece> WithSlope(const StateFit& fit, const std::vector<Eigen::Index>& free,
                                  Eigen::Index parameter) {
  std::vector<StatePiece> pieces = fit.pieces;
  const auto count = static_cast<Eigen::Index>(free.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    StatePiece& piece = pieces[k];
    const double at = (static_cast<double>(k) + 0.5) / static_cast<double>(pieces.size()) - 0.5;
    Eigen::MatrixXd information(count + 1, count + 1);
    information.topLeftCorner(count, count) = piece.information(free, free);
    information.col(count).head(count) = at * piece.information(free, parameter);
    information.row(count) = information.col(count).transpose();
    information(count, count) = at * at * piece.information(parameter, parameter);
    Eigen::VectorXd gradient(count + 1);
    gradient.head(count) = piece.gradient(free);
    gradient[count] = at * piece.gradient[parameter];
    piece.information = std::move(information);
    piece.gradient = std::move(gradient);
  }
  return pieces;
}

/// The last parameter of a regression over pieces.
double LastOf(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient) {
  return ScaledFactor(information).Solve(gradient)[gradient.size() - 1];
}

/// The slope, and its standard error from leaving out each piece in turn (jackknife; Efron and Tibshirani 1993, 11).
std::pair<double, double> SlopeOf(const std::vector<StatePiece>& pieces) {
  Eigen::MatrixXd information = pieces.front().information;
  Eigen::VectorXd gradient = pieces.front().gradient;
  for (std::size_t k = 1; k < pieces.size(); ++k) {
    information += pieces[k].information;
    gradient += pieces[k].gradient;
  }
  const double slope = LastOf(information, gradient);
  double scatter = 0;
  for (const StatePiece& piece : pieces)
    scatter += std::pow(LastOf(information - piece.information, gradient - piece.gradient) - slope, 2);
  const auto count = static_cast<double>(pieces.size());
  return {slope, std::sqrt(scatter * (count - 1) / count)};
}

}  // namespace

std::optional<ParameterDrift> FindParameterDrift(const StateFit& fit, const StateRemainder& left,
                                                 const ParameterDriftOptions& options) {
  if (fit.pieces.size() < options.least_pieces) return std::nullopt;
  std::vector<Eigen::Index> free;
  for (int p = 0; p < fit.model->parameter_count(); ++p)
    if (!fit.at_limit[static_cast<std::size_t>(p)]) free.push_back(p);
  const std::vector<double> constant = fit.HeldOutEnergies();
  const double energy = std::accumulate(constant.begin(), constant.end(), 0.0);
  const double least_share =
      std::max(options.least_share, left.structured ? options.beyond_functions * left.least_share : 0.0);
  struct Slope {
    double removed;
    ParameterDrift::Moved moved;
  };
  std::vector<Slope> slopes;
  for (const Eigen::Index p : free) {
    if (fit.parameters[p] == 0) continue;
    const std::vector<StatePiece> pieces = WithSlope(fit, free, p);
    const auto [removed, t] = PairedGain(constant, HeldOutEnergies(pieces));
    if (removed < least_share * energy || t < options.least_t) continue;
    const auto [slope, std] = SlopeOf(pieces);
    if (std::abs(slope) < options.least_sizes * std) continue;
    const StateParameter& parameter = fit.model->parameters[static_cast<std::size_t>(p)];
    const bool of_size = RelativeChange(fit.parameters[p], 0, slope).has_value();
    const double size = of_size ? std::abs(fit.parameters[p]) : 1;
    slopes.push_back(
        {removed, {parameter.name, slope / size, std / size, of_size ? std::string() : parameter.spec.unit}});
  }
  if (slopes.empty()) return std::nullopt;
  std::sort(slopes.begin(), slopes.end(),
            [](const Slope& a, const Slope& b) { return a.removed > b.removed; });
  ParameterDrift drift;
  drift.share = slopes.front().removed / energy;
  for (const Slope& slope : slopes)
    if (slope.removed >= options.rival_share * slopes.front().removed) drift.moved.push_back(slope.moved);
  return drift;
}

Told ParameterDriftText(const ParameterDrift& drift) {
  Told parts;
  for (const ParameterDrift::Moved& moved : drift.moved) {
    const DisplayUnit unit = moved.unit.empty() ? DisplayUnit{100, 0, "%"} : DisplayUnitFor(moved.unit);
    const Told part =
        Tell("{} by {} {}", "{} um {} {}", moved.parameter,
             TellNumber(ChangeWithInterval(moved.change * unit.factor, kNormal95 * moved.std * unit.factor)),
             UnitTold(unit.name));
    parts = parts.empty() ? part : Tell("{}, or {}", "{}, oder {}", parts, part);
  }
  return Tell(
      "the machine seems to have changed while this was recorded: {} from begin to end takes away {:.0f} % of the error's "
      "energy. Oil that warms or wear would do that: cut the log with [episodes] seconds and follow the parameters with "
      "'hydroscope replay'",
      "die Maschine scheint sich während der Aufnahme geändert zu haben: {} von Anfang bis Ende nimmt {:.0f} % der Energie des "
      "Fehlers weg. Öl, das warm wird, oder Verschleiß täte das: die Aufzeichnung mit [episodes] seconds zerlegen und den "
      "Parametern mit 'hydroscope replay' folgen",
      parts, 100 * drift.share);
}

}  // namespace hydroscope
