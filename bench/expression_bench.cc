// Time per value of expressions of machine files on columns of samples, and per point with derivatives.
#include <benchmark/benchmark.h>

#include <vector>

#include "models/expressions/evaluator.h"

namespace {

using namespace hydroscope;

const std::map<std::string, int> kInputs = {{"p", 0}, {"v", 1}};
const char* const kTexts[] = {"p*sign(v)", "p*sign(v)*exp(-abs(v)/0.01) + 3*v",
                              "max(p - 2e5, 0)^0.5*tanh(v/0.001)"};

void Columns(benchmark::State& state) {
  const auto tree = ParseExpression(kTexts[state.range(0)]);
  const ExpressionEvaluator evaluator(**tree, kInputs);
  std::vector<std::vector<double>> channels(2, std::vector<double>(1024));
  for (std::size_t k = 0; k < 1024; ++k) {
    channels[0][k] = 1e5 * static_cast<double>(k % 7);
    channels[1][k] = 0.001 * (static_cast<double>(k % 11) - 5);
  }
  std::vector<double> values(1024);
  for (auto _ : state) {
    evaluator.Values(channels, 0, values);
    benchmark::DoNotOptimize(values.data());
  }
  state.SetItemsProcessed(state.iterations() * 1024);
  state.SetLabel(kTexts[state.range(0)]);
}
BENCHMARK(Columns)->DenseRange(0, 2);

void PointWithDerivatives(benchmark::State& state) {
  const auto tree = ParseExpression(kTexts[state.range(0)]);
  ExpressionGraph graph;
  const int value = graph.Add(**tree, kInputs);
  const ExpressionProgram program(graph, {value, graph.Derivative(value, 0), graph.Derivative(value, 1)}, 2);
  std::vector<double> registers = program.Registers();
  registers[0] = 3e5;
  registers[1] = 0.002;
  for (auto _ : state) {
    program.Run(registers.data());
    benchmark::DoNotOptimize(registers.data());
  }
  state.SetLabel(kTexts[state.range(0)]);
}
BENCHMARK(PointWithDerivatives)->DenseRange(0, 2);

}  // namespace
