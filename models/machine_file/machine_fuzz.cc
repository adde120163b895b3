// libFuzzer target: whatever the text, ParseMachine gives a machine or an error, a machine it gives reads
// back equal after writing, and its balance and effects can be computed. The text is also taken as an
// expression: what parses reads back equal from its canonical text and has a value.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "models/expressions/check.h"
#include "models/expressions/evaluator.h"
#include "models/expressions/guard.h"
#include "models/model_structure.h"

namespace {

using namespace hydroscope;

void Stop(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::abort();
}

void Compute(const Machine& machine) {
  constexpr int kSamples = 17;
  const auto model = BuildModel(machine);
  if (!model) return;
  Stretch stretch;
  stretch.samples = kSamples;
  stretch.period = 0.002;
  stretch.channel.assign((*model)->channel_names.size(), std::vector<double>(kSamples, 0.5));
  for (std::size_t c = 0; c < stretch.channel.size(); ++c) stretch.channel[c][c % kSamples] = -1e5;
  (*model)->derive_channels(stretch);
  std::vector<double> out(kSamples);
  double state = 0;
  for (const Column& column : (*model)->columns)
    column.fill(stretch, state, std::span(out).first(kSamples - ((*model)->level_form ? 0 : 1)));
  (*model)->derive(Eigen::VectorXd::Ones((*model)->base_count));
  if (const auto guard = ExpressionGuard::For(machine)) {
    SampleBlock block;
    block.Resize(machine.signals.size(), 3);
    guard->Flag(block, 3);
  }
}

void TakeAsExpression(const std::string& text) {
  ExpressionNames names;
  names.units = {{"x", Dimension{}}, {"p", ParseSiUnit("Pa")}};
  const auto tree = ParseExpression(text);
  if (!tree) {
    if (tree.error().text.empty()) Stop("an error without words");
    CaretLine(text, tree.error().at);
    return;
  }
  const std::string canonical = CanonicalText(**tree);
  // Canonical text has more brackets, so it may be refused for its size alone.
  if (const auto again = ParseExpression(canonical); again && CanonicalText(**again) != canonical)
    Stop("reads back differently: " + canonical);
  const auto checked = CheckExpression(text, names);
  if (!checked) return;
  const Expression level = WithRates(checked->tree, -1);
  const std::map<std::string, int> inputs = {{"x", 0}, {"p", 1}};
  const std::vector<std::vector<double>> channels = {std::vector<double>(150, 0.1),
                                                     std::vector<double>(150, 1e5)};
  std::vector<double> values(150);
  const ExpressionEvaluator evaluator(*level, inputs);
  evaluator.Values(channels, 0, values);
  ExpressionGraph graph;
  const int value = graph.Add(*level, inputs);
  const ExpressionProgram program(graph, {value, graph.Derivative(value, 0), graph.Derivative(value, 1)}, 2);
  std::vector<double> registers = program.Registers();
  registers[0] = 0.1;
  registers[1] = 1e5;
  program.Run(registers.data());
  const double alone = registers[program.output(0)];
  if (!(alone == values[0] && alone == values[149]) && !(std::isnan(alone) && std::isnan(values[149])))
    Stop("a column differs from a point");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  TakeAsExpression(text);
  const auto machine = ParseMachine(text, "fuzz");
  if (!machine) return machine.error().text.empty() ? std::abort(), 0 : 0;
  const auto again = ParseMachine(FormatMachine(*machine), "fuzz");
  if (!again || !(*again == *machine))
    Stop((again ? "read back differently" : again.error().text) + "\n" + FormatMachine(*machine));
  Compute(*machine);
  return 0;
}
