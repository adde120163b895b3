#include "diagnosis/states/other_causes/missing_zero.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/states/tangent.h"
#include "estimation/column_products.h"
#include "estimation/decompositions.h"
#include "estimation/states/fit_task.h"
#include "models/output_unit.h"

namespace hydroscope {
namespace {

std::string ZeroName(const std::string& signal) { return signal + "_zero"; }

/// Energy left with a constant in an output over that without, by linearisation: parameters and initial states make up for what
/// they can, a zero that the file gives among them.
double LeftWithConstant(const StateFit& fit, std::span<const Episode> episodes, int output) {
  AddedTerms constant;
  constant.values = constant.columns = 1;
  constant.evaluate = [](const double*, const double*, double* value) { *value = 1; };
  constant.to_outputs.push_back({0, output, 0});
  Eigen::MatrixXd products;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const RowMatrix columns = TangentColumns(fit, episodes[e], e, constant, {&fit.residuals[e]});
    if (e == 0) products = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
    products += ColumnProducts(columns);
  }
  std::vector<Eigen::Index> others;
  for (Eigen::Index c = 0; c < products.rows(); ++c)
    if (c != products.rows() - 2) others.push_back(c);
  return EnergyLeft(products) / std::max(EnergyLeft(products(others, others)), 1e-300);
}

double SpanOf(std::span<const Episode> episodes, int signal) {
  double lowest = INFINITY, highest = -INFINITY;
  for (const Episode& episode : episodes)
    for (int row = 0; row < episode.rows(); ++row)
      if (const double reading = episode.Reading(row, signal); std::isfinite(reading)) {
        lowest = std::min(lowest, reading);
        highest = std::max(highest, reading);
      }
  return highest - lowest;
}

}  // namespace

std::optional<MissingZeros> FindMissingZeros(const StateFit& fit, std::span<const Episode> episodes,
                                             const MissingZeroOptions& options) {
  const std::vector<Episode> few = shooting::FirstRows(episodes, options.rows);
  StateStart start{fit.parameters, fit.initial};
  start.initial.resize(few.size());
  const StateFit without = RefitStates(fit.model, few, std::span(&start, 1), fit.noise, {});
  if (!without.solved()) return std::nullopt;
  const StateModel& model = *fit.model;
  MissingZeros found;
  for (int j = 0; j < model.output.rows; ++j) {
    const int signal = model.outputs[static_cast<std::size_t>(j)];
    const double span = SpanOf(few, signal);
    if (span > 0 && LeftWithConstant(without, few, j) <= options.foreseen)
      found.of.push_back({model.machine.signals[static_cast<std::size_t>(signal)].name, 0, span});
  }
  if (found.of.empty()) return std::nullopt;
  const auto with_zeros = BuildStateModel(WithZeros(model.machine, found), model.effects);
  if (!with_zeros) return std::nullopt;
  start = {{}, without.initial};
  const auto known = [&](const std::string& name) {
    return std::ranges::find(model.parameters, name, &StateParameter::name);
  };
  const auto& parameters = (*with_zeros)->parameters;
  start.parameters = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p)
    if (const auto same = known(parameters[p].name); same != model.parameters.end())
      start.parameters[static_cast<Eigen::Index>(p)] = without.parameters[same - model.parameters.begin()];
  const StateFit with = RefitStates(*with_zeros, few, std::span(&start, 1), fit.noise, {});
  if (!with.solved()) return std::nullopt;
  for (MissingZeros::Zero& zero : found.of) {
    const auto at = std::ranges::find(parameters, ZeroName(zero.signal), &StateParameter::name);
    zero.at = with.parameters[at - parameters.begin()];
  }
  found.error =
      with.noise.cwiseQuotient(without.noise).norm() / std::sqrt(static_cast<double>(with.noise.size()));
  if (found.error > options.less_error) return std::nullopt;
  return found;
}

Machine WithZeros(Machine machine, const MissingZeros& zeros) {
  for (const MissingZeros::Zero& zero : zeros.of) {
    const std::string name = ZeroName(zero.signal);
    for (OutputSpec& output : machine.states.outputs)
      if (output.signal == zero.signal) output.expression = fmt::format("{} + {}", output.expression, name);
    for (StateSpec& state : machine.states.states)
      for (std::string* from : {&state.initial, &state.near})
        if (*from == zero.signal) *from = fmt::format("{} - {}", zero.signal, name);
    machine.states.parameters.push_back({name, zero.at, zero.at - zero.span, zero.at + zero.span});
  }
  return machine;
}

Told MissingZerosText(const MissingZeros& zeros, const Machine& machine) {
  Told constants;
  for (const MissingZeros::Zero& zero : zeros.of) {
    const DisplayUnit unit = ShownUnit(machine, zero.signal);
    const Told one = Tell("{:+.4g} {} in {}", "{:+.4g} {} in {}", zero.at * unit.factor,
                          std::string(unit.name), zero.signal);
    constants = constants.empty() ? one : Tell("{}, {}", "{}, {}", constants, one);
  }
  return Tell(
      "a constant ({}) leaves {:.0f} % of the error without it, and is taken: the zero of a sensor, or a constant force or flow; if "
      "it is a sensor's, add a parameter to that output in [outputs]",
      "eine Konstante ({}) lässt {:.0f} % des Fehlers ohne sie übrig und wird genommen: der Nullpunkt eines Sensors oder eine "
      "konstante Kraft oder Strömung; wenn es der eines Sensors ist, zu diesem Ausgang in [outputs] einen Parameter addieren",
      constants, 100 * zeros.error);
}

}  // namespace hydroscope
