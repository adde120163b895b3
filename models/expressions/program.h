#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "models/expressions/graph.h"

namespace hydroscope {

/// Values of a graph as a flat program over registers: the inputs come first, constants next, then one register per
/// operation; a product that only one sum reads is computed with it. Computed at one point, at a few points side by side, or
/// on columns of samples block by block; nothing is allocated and no text is read.
class ExpressionProgram {
 public:
  ExpressionProgram() = default;
  /// `outputs` are values of the graph; all its inputs are below `inputs`. Operations on inputs from `first_fixed` on
  /// alone (parameters) are computed once for many points.
  ExpressionProgram(const ExpressionGraph& graph, const std::vector<int>& outputs, int inputs,
                    int first_fixed);
  ExpressionProgram(const ExpressionGraph& graph, const std::vector<int>& outputs, int inputs)
      : ExpressionProgram(graph, outputs, inputs, inputs) {}

  /// Registers with the constants in place: write the inputs into the first, RunFixed once, Run per point.
  std::vector<double> Registers() const;
  void RunFixed(double* registers) const;
  void Run(double* registers) const;
  /// Register of an output.
  std::size_t output(std::size_t index) const { return outputs_[index]; }
  std::size_t operations() const { return fixed_.size() + code_.size(); }

  /// Points that RunPoints computes at once: what an instruction costs is shared by them.
  static constexpr int kPoints = 8;
  /// As Registers, RunFixed and Run with kPoints values side by side in place of each register: value p of register r stands
  /// at r*kPoints + p. exp and ln are those of elementary.h, so that the last bits differ from Run's.
  std::vector<double> PointRegisters() const;
  void RunFixedPoints(double* registers) const;
  void RunPoints(double* registers) const;

  /// Output 0 at `count` samples: inputs[i] points to the column of input i. For programs of
  /// one expression, whose size the parser limits.
  void RunColumns(const double* const* inputs, std::size_t count, double* values) const;

  /// Registers; operands that an operation does not have repeat its first.
  struct Instruction {
    Operation operation;
    std::uint16_t to, a, b, c;
    std::uint8_t last = 0;  ///< operand that is what the instruction before gave: 1 a, 2 b, 3 c; 0 none
  };

 private:
  std::size_t inputs_ = 0, registers_ = 0;
  std::vector<double> constants_;  ///< registers inputs_ ... inputs_ + constants_.size() - 1
  std::vector<Instruction> fixed_, code_;
  std::vector<std::size_t> outputs_;
};

}  // namespace hydroscope
