#include "models/expressions/program.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <type_traits>

#include "core/parallel/wide.h"
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

/// Products that a single sum or difference reads and nothing else: computed with it. `uses`: readers of each value.
std::vector<bool> Joined(const std::vector<GraphValue>& values, const std::vector<bool>& needed,
                         const std::vector<int>& uses, const std::vector<bool>& varies) {
  std::vector<bool> joined(values.size());
  const auto free_product = [&](int v) {
    const auto at = static_cast<std::size_t>(v);
    return values[at].operation == Operation::kMultiply && uses[at] == 1 && varies[at];
  };
  for (std::size_t v = 0; v < values.size(); ++v) {
    const GraphValue& value = values[v];
    if (!needed[v] || (value.operation != Operation::kAdd && value.operation != Operation::kSubtract))
      continue;
    if (value.a == value.b) continue;
    if (free_product(value.b))
      joined[static_cast<std::size_t>(value.b)] = true;
    else if (free_product(value.a))
      joined[static_cast<std::size_t>(value.a)] = true;
  }
  return joined;
}

/// How many values and outputs read each value.
std::vector<int> Uses(const std::vector<GraphValue>& values, const std::vector<bool>& needed,
                      const std::vector<int>& outputs) {
  std::vector<int> uses(values.size());
  for (int output : outputs) ++uses[static_cast<std::size_t>(output)];
  for (std::size_t v = 0; v < values.size(); ++v) {
    const GraphValue& value = values[v];
    if (!needed[v] || value.operation == Operation::kInput || value.operation == Operation::kConstant)
      continue;
    ++uses[static_cast<std::size_t>(value.a)];
    if (value.b != value.a) ++uses[static_cast<std::size_t>(value.b)];
    if (value.c != value.a && value.c != value.b) ++uses[static_cast<std::size_t>(value.c)];
  }
  return uses;
}

/// Points side by side, a count of its own: exp and ln run on vectors.
struct PointCount : std::integral_constant<int, ExpressionProgram::kPoints> {};

template <typename Count>
[[gnu::always_inline]] inline double ComputeFor(Operation operation, double a, double b, double c) {
  if constexpr (std::is_same_v<Count, PointCount>) {
    if (operation == Operation::kExp) return Exp(a);
    if (operation == Operation::kLn) return Log(a);
  }
  return Compute(operation, a, b, c);
}

/// Calls `each(k)` with every operation from kInput to kMinusProduct as a constant k.
#define HYDROSCOPE_OPERATIONS(each)                                                                        \
  each(kInput) each(kConstant) each(kNegate) each(kNot) each(kAdd) each(kSubtract) each(kMultiply)         \
      each(kDivide) each(kPower) each(kLess) each(kLessEqual) each(kGreater) each(kGreaterEqual)           \
          each(kEqual) each(kNotEqual) each(kAnd) each(kOr) each(kSelect) each(kMin) each(kMax) each(kAbs) \
              each(kSign) each(kSqrt) each(kExp) each(kLn) each(kLog10) each(kSin) each(kCos) each(kTan)   \
                  each(kAsin) each(kAcos) each(kAtan) each(kAtan2) each(kSinh) each(kCosh) each(kTanh)     \
                      each(kProductPlus) each(kProductMinus) each(kMinusProduct)

/// Each register is a column of `count` samples. No instruction writes what it reads.
template <typename Count>
[[gnu::always_inline]] inline void Execute(const std::vector<ExpressionProgram::Instruction>& code,
                                           double* registers, Count count) {
  for (const ExpressionProgram::Instruction& i : code) {
    double* __restrict to = registers + static_cast<std::ptrdiff_t>(i.to) * count;
    const double* a = registers + static_cast<std::ptrdiff_t>(i.a) * count;
    const double* b = registers + static_cast<std::ptrdiff_t>(i.b) * count;
    const double* c = registers + static_cast<std::ptrdiff_t>(i.c) * count;
    const auto each = [&](auto operation) __attribute__((always_inline)) {
      for (int k = 0; k < count; ++k) to[k] = operation(a[k], b[k], c[k]);
    };
#define HYDROSCOPE_CASE(name)                                                                       \
  case Operation::name:                                                                             \
    each([](double x, double y, double z) { return ComputeFor<Count>(Operation::name, x, y, z); }); \
    break;
    switch (i.operation) { HYDROSCOPE_OPERATIONS(HYDROSCOPE_CASE) }
#undef HYDROSCOPE_CASE
  }
}

/// One point: each instruction ends with a jump to the next one's code (threaded code, Bell 1973), which the processor
/// foretells better than one jump for all, as in a loop over a switch.
/// What an instruction gave goes on to the next one beside its register: from memory it would come later.
using Instruction = ExpressionProgram::Instruction;
using Step = void (*)(const Instruction* at, const Instruction* end, double* registers, double last);
template <Operation kOperation, int kLast>
void TakeStep(const Instruction* at, const Instruction* end, double* registers, double last);

constexpr int kLasts = 4;  // of Instruction::last
constexpr Step kSteps[][kLasts] = {
#define HYDROSCOPE_STEP(name)                                                                \
  {TakeStep<Operation::name, 0>, TakeStep<Operation::name, 1>, TakeStep<Operation::name, 2>, \
   TakeStep<Operation::name, 3>},
    HYDROSCOPE_OPERATIONS(HYDROSCOPE_STEP)
#undef HYDROSCOPE_STEP
};
#undef HYDROSCOPE_OPERATIONS
static_assert(std::size(kSteps) == static_cast<std::size_t>(Operation::kMinusProduct) + 1);

Step StepOf(const Instruction& instruction) {
  return kSteps[static_cast<std::size_t>(instruction.operation)][instruction.last];
}

template <Operation kOperation, int kLast>
void TakeStep(const Instruction* at, const Instruction* end, double* registers, double last) {
  const double a = kLast == 1 ? last : registers[at->a], b = kLast == 2 ? last : registers[at->b],
               c = kLast == 3 ? last : registers[at->c], value = Compute(kOperation, a, b, c);
  registers[at->to] = value;
  if (++at != end) return StepOf(*at)(at, end, registers, value);
}

void ExecutePoint(const std::vector<Instruction>& code, double* registers) {
  if (code.empty()) return;
  const Instruction* const first = code.data();
  StepOf (*first)(first, first + code.size(), registers, 0);
}

HYDROSCOPE_WIDE void ExecuteBlock(const std::vector<ExpressionProgram::Instruction>& code, double* registers,
                                  int count) {
  Execute(code, registers, count);
}

HYDROSCOPE_WIDE void ExecutePoints(const std::vector<ExpressionProgram::Instruction>& code,
                                   double* registers) {
  Execute(code, registers, PointCount());
}

/// Instruction::last where `before` is the register of the instruction before.
std::uint8_t LastOf(const Instruction& instruction, std::uint16_t before) {
  const std::uint16_t operands[] = {instruction.a, instruction.b, instruction.c};
  const auto found = std::find(std::begin(operands), std::end(operands), before);
  return found == std::end(operands) ? 0 : static_cast<std::uint8_t>(found - std::begin(operands) + 1);
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
    varies[v] = value.operation == Operation::kInput ? value.a < first_fixed
                                                     : varies[static_cast<std::size_t>(value.a)] ||
                                                           varies[static_cast<std::size_t>(value.b)] ||
                                                           varies[static_cast<std::size_t>(value.c)];
  }
  const std::vector<bool> joined = Joined(values, needed, Uses(values, needed, outputs), varies);
  for (std::size_t v = 0; v < values.size(); ++v) {
    const GraphValue& value = values[v];
    if (!needed[v] || value.operation == Operation::kConstant) continue;
    if (value.operation == Operation::kInput) {
      place[v] = static_cast<std::size_t>(value.a);
      continue;
    }
    if (joined[v]) continue;
    place[v] = registers_++;
    const auto at = [&](int operand) {
      return static_cast<std::uint16_t>(place[static_cast<std::size_t>(operand)]);
    };
    Instruction instruction{value.operation, at(static_cast<int>(v)), at(value.a), at(value.b), at(value.c)};
    const bool sum = value.operation == Operation::kAdd;
    if ((sum || value.operation == Operation::kSubtract) &&
        (joined[static_cast<std::size_t>(value.a)] || joined[static_cast<std::size_t>(value.b)])) {
      const bool second = joined[static_cast<std::size_t>(value.b)];
      const GraphValue& product = values[static_cast<std::size_t>(second ? value.b : value.a)];
      instruction.operation = sum      ? Operation::kProductPlus
                              : second ? Operation::kMinusProduct
                                       : Operation::kProductMinus;
      instruction.a = at(product.a);
      instruction.b = at(product.b);
      instruction.c = at(second ? value.a : value.b);
    }
    std::vector<Instruction>& code = varies[v] ? code_ : fixed_;
    if (!code.empty()) instruction.last = LastOf(instruction, code.back().to);
    code.push_back(instruction);
  }
  for (int output : outputs) outputs_.push_back(place[static_cast<std::size_t>(output)]);
}

std::vector<double> ExpressionProgram::Registers() const {
  std::vector<double> registers(registers_);
  std::copy(constants_.begin(), constants_.end(), registers.begin() + static_cast<std::ptrdiff_t>(inputs_));
  return registers;
}

void ExpressionProgram::RunFixed(double* registers) const { ExecutePoint(fixed_, registers); }
void ExpressionProgram::Run(double* registers) const { ExecutePoint(code_, registers); }

std::vector<double> ExpressionProgram::PointRegisters() const {
  constexpr auto kColumn = static_cast<std::size_t>(kPoints);
  std::vector<double> registers(registers_ * kColumn);
  for (std::size_t k = 0; k < constants_.size(); ++k)
    std::fill_n(registers.data() + (inputs_ + k) * kColumn, kColumn, constants_[k]);
  return registers;
}
void ExpressionProgram::RunFixedPoints(double* registers) const { ExecutePoints(fixed_, registers); }
void ExpressionProgram::RunPoints(double* registers) const { ExecutePoints(code_, registers); }

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
