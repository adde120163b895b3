#include "models/expressions/program.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "core/wide.h"
#include "models/expressions/operation.h"

namespace hydroscope {
namespace {

/// Registers of one block of samples, on the stack: 32 kB, what the first cache holds. Long programs run on shorter blocks.
constexpr std::size_t kBlockRegisters = 4096;
constexpr std::size_t kLongestBlock = 128;

/// Marks what `outputs` need.
std::vector<bool> Needed(const std::vector<GraphValue>& values, const std::vector<int>& outputs) {
  std::vector<bool> needed(values.size());
  for (int output : outputs) needed[static_cast<std::size_t>(output)] = true;
  for (std::size_t v = values.size(); v-- > 0;) {
    const GraphValue& value = values[v];
    if (!needed[v] || value.operation == Operation::kInput || value.operation == Operation::kConstant)
      continue;
    for (int operand : {value.a, value.b, value.c}) needed[static_cast<std::size_t>(operand)] = true;
  }
  return needed;
}

/// Each register is a column of `count` samples; a count of std::integral_constant 1 is one point.
template <typename Count>
void Execute(const std::vector<ExpressionProgram::Instruction>& code, double* registers, Count count) {
  for (const ExpressionProgram::Instruction& i : code) {
    double* to = registers + static_cast<std::ptrdiff_t>(i.to) * count;
    const double* a = registers + static_cast<std::ptrdiff_t>(i.a) * count;
    const double* b = registers + static_cast<std::ptrdiff_t>(i.b) * count;
    const double* c = registers + static_cast<std::ptrdiff_t>(i.c) * count;
    const auto each = [&](auto operation) {
      for (int k = 0; k < count; ++k) to[k] = operation(a[k], b[k], c[k]);
    };
#define HYDROSCOPE_CASE(name)                                                             \
  case Operation::name:                                                                   \
    each([](double x, double y, double z) { return Compute(Operation::name, x, y, z); }); \
    break
    switch (i.operation) {
      HYDROSCOPE_CASE(kInput);
      HYDROSCOPE_CASE(kConstant);
      HYDROSCOPE_CASE(kNegate);
      HYDROSCOPE_CASE(kNot);
      HYDROSCOPE_CASE(kAdd);
      HYDROSCOPE_CASE(kSubtract);
      HYDROSCOPE_CASE(kMultiply);
      HYDROSCOPE_CASE(kDivide);
      HYDROSCOPE_CASE(kPower);
      HYDROSCOPE_CASE(kLess);
      HYDROSCOPE_CASE(kLessEqual);
      HYDROSCOPE_CASE(kGreater);
      HYDROSCOPE_CASE(kGreaterEqual);
      HYDROSCOPE_CASE(kEqual);
      HYDROSCOPE_CASE(kNotEqual);
      HYDROSCOPE_CASE(kAnd);
      HYDROSCOPE_CASE(kOr);
      HYDROSCOPE_CASE(kSelect);
      HYDROSCOPE_CASE(kMin);
      HYDROSCOPE_CASE(kMax);
      HYDROSCOPE_CASE(kAbs);
      HYDROSCOPE_CASE(kSign);
      HYDROSCOPE_CASE(kSqrt);
      HYDROSCOPE_CASE(kExp);
      HYDROSCOPE_CASE(kLn);
      HYDROSCOPE_CASE(kLog10);
      HYDROSCOPE_CASE(kSin);
      HYDROSCOPE_CASE(kCos);
      HYDROSCOPE_CASE(kTan);
      HYDROSCOPE_CASE(kAsin);
      HYDROSCOPE_CASE(kAcos);
      HYDROSCOPE_CASE(kAtan);
      HYDROSCOPE_CASE(kAtan2);
      HYDROSCOPE_CASE(kSinh);
      HYDROSCOPE_CASE(kCosh);
      HYDROSCOPE_CASE(kTanh);
    }
#undef HYDROSCOPE_CASE
  }
}

HYDROSCOPE_WIDE void ExecuteBlock(const std::vector<ExpressionProgram::Instruction>& code, double* registers,
                                  int count) {
  Execute(code, registers, count);
}

}  // namespace

ExpressionProgram::ExpressionProgram(const ExpressionGraph& graph, const std::vector<int>& outputs,
                                     int inputs, int first_fixed)
    : inputs_(static_cast<std::size_t>(inputs)), registers_(inputs_) {
  const std::vector<GraphValue>& values = graph.values();
  const std::vector<bool> needed = Needed(values, outputs);
  std::vector<std::size_t> place(values.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (!needed[v] || values[v].operation != Operation::kConstant) continue;
    place[v] = registers_++;
    constants_.push_back(values[v].constant);
  }
  std::vector<bool> varies(values.size());
  for (std::size_t v = 0; v < values.size(); ++v) {  // operands stand before what uses them
    const GraphValue& value = values[v];
    if (!needed[v] || value.operation == Operation::kConstant) continue;
    if (value.operation == Operation::kInput) {
      place[v] = static_cast<std::size_t>(value.a);
      varies[v] = value.a < first_fixed;
      continue;
    }
    const auto a = static_cast<std::size_t>(value.a), b = static_cast<std::size_t>(value.b),
               c = static_cast<std::size_t>(value.c);
    varies[v] = varies[a] || varies[b] || varies[c];
    place[v] = registers_++;
    const auto at = [&](std::size_t operand) { return static_cast<std::uint16_t>(place[operand]); };
    (varies[v] ? code_ : fixed_).push_back({value.operation, at(v), at(a), at(b), at(c)});
  }
  for (int output : outputs) outputs_.push_back(place[static_cast<std::size_t>(output)]);
}

std::vector<double> ExpressionProgram::Registers() const {
  std::vector<double> registers(registers_);
  std::copy(constants_.begin(), constants_.end(), registers.begin() + static_cast<std::ptrdiff_t>(inputs_));
  return registers;
}

void ExpressionProgram::RunFixed(double* registers) const {
  Execute(fixed_, registers, std::integral_constant<int, 1>());
}
void ExpressionProgram::Run(double* registers) const {
  Execute(code_, registers, std::integral_constant<int, 1>());
}

void ExpressionProgram::RunColumns(const double* const* inputs, std::size_t count, double* values) const {
  std::array<double, kBlockRegisters> registers;
  const std::size_t block = std::min(kLongestBlock, kBlockRegisters / std::max<std::size_t>(registers_, 1));
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t size = std::min(block, count - first);
    for (std::size_t i = 0; i < inputs_; ++i)
      std::copy_n(inputs[i] + first, size, registers.data() + i * size);
    for (std::size_t k = 0; k < constants_.size(); ++k)
      std::fill_n(registers.data() + (inputs_ + k) * size, size, constants_[k]);
    ExecuteBlock(fixed_, registers.data(), static_cast<int>(size));
    ExecuteBlock(code_, registers.data(), static_cast<int>(size));
    std::copy_n(registers.data() + outputs_[0] * size, size, values + first);
  }
}

}  // namespace hydroscope
