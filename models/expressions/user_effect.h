#pragma once

#include "models/effect.h"
#include "models/expressions/check.h"
#include "models/expressions/columns.h"

namespace hydroscope {

/// How expressions of a user's effect become columns of a model.
struct UserEffectContext {
  ExpressionChannels* channels = nullptr;
  bool level_form = false;
  double sign = 1.0;        ///< -1 where effects are flows out of the chamber (die cushion)
  std::string output_unit;  ///< SI
};

/// The effect of a machine file's [[effect]], for the library. Adds the channels its expression needs. Error:
/// what CheckExpression says, with the key.
Result<Effect> MakeUserEffect(const Machine& machine, const UserEffectSpec& spec,
                              const UserEffectContext& context);

/// Appends the machine's own effects to a model whose channels are complete (built-in balances).
Status AddUserEffects(const Machine& machine, double sign, ModelStructure& model);

/// Description of the effect alone, without columns: what lists and messages show.
Effect DescribeUserEffect(const Machine& machine, const UserEffectSpec& spec, const std::string& output_unit);

/// Unit of the parameter of a term: as given, else the output's over the expression's if that is exact, else "".
std::string ParameterUnit(const TermSpec& term, const ExpressionUnit& expression,
                          const std::string& output_unit);

}  // namespace hydroscope
