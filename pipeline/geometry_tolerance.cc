#include "pipeline/geometry_tolerance.h"

#include <fmt/format.h>

#include <cmath>

#include "core/non_negative.h"
#include "models/machine_kind.h"

namespace hydroscope {

std::vector<AssumedTolerance> AssumeTolerances(Machine& machine) {
  std::vector<AssumedTolerance> assumed;
  for (const MachineInput& input : KindOf(machine).geometry) {
    const auto known = machine.geometry.find(std::string(input.name));
    if (input.shared_by.empty() || known == machine.geometry.end() || known->second.std > 0) continue;
    known->second.std = kAreaTolerance * std::abs(known->second.value);
    assumed.push_back({known->first, input.shared_by, known->second.std});
  }
  return assumed;
}

std::vector<EstimateStatement> ToleranceStatements(const Machine& machine, const ModelStructure& model) {
  const Eigen::VectorXd any = Eigen::VectorXd::Ones(model.base_count);  // shares do not depend on it
  const auto without = model.derive(any);
  std::vector<EstimateStatement> statements;
  for (const DerivedParameter& parameter : without)
    statements.push_back({.parameter = parameter.name, .why = {}});
  Machine tolerant = machine;
  if (AssumeTolerances(tolerant).empty()) return statements;
  const auto assumed = BuildModel(tolerant);
  if (!assumed) return statements;
  const auto with = (*assumed)->derive(any);
  for (std::size_t i = 0; i < with.size(); ++i)
    if (with[i].geometry_std > without[i].geometry_std)
      statements[i].shared =
          std::sqrt(NonNegative(std::pow(with[i].geometry_std, 2) - std::pow(without[i].geometry_std, 2))) /
          std::abs(with[i].value);
  return statements;
}

std::string AssumedText(const AssumedTolerance& assumed) {
  return fmt::format("{} has no tolerance in the machine file: {:g} % assumed, which {} share in proportion",
                     assumed.name, 100 * kAreaTolerance, assumed.shared_by);
}

}  // namespace hydroscope
