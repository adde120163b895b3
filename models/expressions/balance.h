#pragma once

#include "models/expressions/check.h"
#include "models/model_structure.h"

namespace hydroscope {

/// What an expression under `derived` may name: the parameters of the balance and the constants of the machine.
ExpressionNames NamesForDerived(const Machine& machine);

/// The balance of a machine file's own [balance]: output = sum of parameter * expression, in SI. Where a rate
/// enters linearly the balance is integrated (integral form, a ddt is a difference); without one it holds
/// sample by sample (level form). The effects of the file are its library. Errors: what CheckExpression says,
/// with the key.
Result<std::shared_ptr<ModelStructure>> BuildExpressionBalance(const Machine& machine);

}  // namespace hydroscope
