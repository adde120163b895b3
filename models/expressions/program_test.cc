#include "models/expressions/program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/expressions/evaluator.h"

namespace hydroscope {
namespace {

const std::map<std::string, int> kInputs = {{"x", 0}, {"y", 1}};

/// Value and derivatives of an expression over x and y.
struct Slope {
  double value, by_x, by_y;
};

Slope SlopeOf(const std::string& text, double x, double y) {
  const auto tree = ParseExpression(text);
  EXPECT_TRUE(tree) << text;
  if (!tree) return {NAN, NAN, NAN};
  ExpressionGraph graph;
  const int value = graph.Add(**tree, kInputs);
  const ExpressionProgram program(graph, {value, graph.Derivative(value, 0), graph.Derivative(value, 1)}, 2);
  std::vector<double> registers = program.Registers();
  registers[0] = x;
  registers[1] = y;
  program.Run(registers.data());
  return {registers[program.output(0)], registers[program.output(1)], registers[program.output(2)]};
}

void ExpectSlopes(const std::string& text, double x, double y) {
  constexpr double kStep = 1e-6;
  const Slope slope = SlopeOf(text, x, y);
  const double by_x = (SlopeOf(text, x + kStep, y).value - SlopeOf(text, x - kStep, y).value) / (2 * kStep);
  const double by_y = (SlopeOf(text, x, y + kStep).value - SlopeOf(text, x, y - kStep).value) / (2 * kStep);
  EXPECT_NEAR(slope.by_x, by_x, 1e-7 * (1 + std::abs(by_x))) << text << " at " << x << ", " << y;
  EXPECT_NEAR(slope.by_y, by_y, 1e-7 * (1 + std::abs(by_y))) << text << " at " << x << ", " << y;
}

TEST(ExpressionProgram, DerivativesOfEveryFunctionAreThoseOfDifferences) {
  for (const ExpressionFunction& f : ExpressionFunctions()) {
    if (f.name == "ddt" || f.name == "delay") continue;  // replaced by a channel before anything is computed
    std::string text(f.name);
    text += f.max_args == 1 ? "(x*y + 0.1*x)" : "(x*y, x - 0.3*y)";
    for (const auto& [x, y] : {std::pair(0.3, 0.8), std::pair(0.7, 0.4), std::pair(0.9, 0.2)})
      ExpectSlopes(text, x, y);
  }
}

TEST(ExpressionProgram, DerivativesOfEveryOperatorAreThoseOfDifferences) {
  for (const char* text :
       {"x + y", "x - 2*y", "x*y", "x/y", "x^y", "x^2", "y^3", "x^4 + x^-1 + y^0.5", "-x", "!x + y",
        "x < y ? x^2 : y^2", "x <= y ? x*y : 1", "x > y && x != 0.2 ? sin(x) : cos(y)",
        "x >= y || x == 3 ? y : x", "x*x*x - 3*y*x + 2", "max(x, y, 0.5*x) - min(x, y, 2*y)",
        "exp(-abs(x - 0.55)/y)*sign(x - 0.55)", "sqrt(max(x, 0))*(y - sqrt(x))/(1 + x^2)",
        "atan2(x - y, x + y)"})
    for (const auto& [x, y] : {std::pair(0.3, 0.8), std::pair(0.7, 0.4), std::pair(1.3, 1.2)})
      ExpectSlopes(text, x, y);
}

TEST(ExpressionProgram, WhatHasNoDerivativeHasThatOfOneSide) {
  EXPECT_EQ(SlopeOf("sqrt(max(x, 0))", -1, 0).by_x, 0);
  EXPECT_EQ(SlopeOf("sqrt(x)", 0, 0).by_x, 0);
  EXPECT_EQ(SlopeOf("abs(x)", 0, 0).by_x, 0);
  EXPECT_EQ(SlopeOf("x^y", 0, 2).by_y, 0);
  EXPECT_EQ(SlopeOf("x^y", 0, 2).by_x, 0);
  for (const char* root : {"x^0.5", "max(x, 0)^0.5", "x^y", "max(x, 0)^y"})
    EXPECT_EQ(SlopeOf(root, 0, 0.5).by_x, 0) << root << ": as that of sqrt";
  for (const char* root : {"max(x, 0)^0.5", "max(x, 0)^y"})
    EXPECT_EQ(SlopeOf(root, -1, 0.5).by_x, 0) << root << ": a tank that is empty";
  EXPECT_EQ(SlopeOf("min(x, y)", 1, 1).by_x, 1);
}

TEST(ExpressionProgram, WhatIsNoNumberComesOutAsItIs) {
  EXPECT_TRUE(std::isnan(SlopeOf("sqrt(x)", -1, 0).value));
  EXPECT_TRUE(std::isnan(SlopeOf("x/y", 0, 0).value));
  EXPECT_TRUE(std::isinf(SlopeOf("x/y", 1, 0).value));
  EXPECT_TRUE(std::isinf(SlopeOf("ln(x)", 0, 0).value));
  EXPECT_TRUE(std::isnan(SlopeOf("0*x", NAN, 0).value));
  EXPECT_TRUE(std::isinf(SlopeOf("exp(x)", 1000, 0).value));
}

TEST(ExpressionProgram, WhatExpressionsShareIsComputedOnce) {
  ExpressionGraph graph;
  const int first = graph.Add(**ParseExpression("exp(-x/y) + x"), kInputs);
  const int second = graph.Add(**ParseExpression("2*exp(-x/y)"), kInputs);
  const ExpressionProgram one(graph, {first}, 2), both(graph, {first, second}, 2);
  EXPECT_EQ(one.operations(), 4u);
  EXPECT_EQ(both.operations(), 5u);
}

TEST(ExpressionProgram, AProductThatOneSumReadsIsComputedWithIt) {
  const auto operations = [](const std::string& text) {
    ExpressionGraph graph;
    return ExpressionProgram(graph, {graph.Add(**ParseExpression(text), kInputs)}, 2).operations();
  };
  EXPECT_EQ(operations("x*y + x"), 1u);
  EXPECT_EQ(operations("x - x*y"), 1u);
  EXPECT_EQ(operations("x*y - x*x"), 2u);
  EXPECT_EQ(operations("x*y + x*y"), 2u);
  EXPECT_EQ(operations("(x*y + x)/(x*y)"), 3u) << "read twice";
  for (const char* text : {"x*y + x", "x - x*y", "x*y - x", "x*y - x*x", "x*y + x*y", "(x*y + x)/(x*y)"})
    ExpectSlopes(text, 0.7, 1.3);
  EXPECT_EQ(SlopeOf("x - x*y", 3, 5).value, -12);
  EXPECT_EQ(SlopeOf("x*y - x", 3, 5).value, 12);
  EXPECT_EQ(SlopeOf("x*y - x*x", 3, 5).value, 6);
  EXPECT_EQ(SlopeOf("x*y + x*y", 3, 5).value, 30);
}

TEST(ExpressionProgram, PointsSideBySideAreThePointsOneByOne) {
  for (const char* text : {"x*y - exp(-x/y) + ln(y)*sqrt(max(x, 0))", "x > 0.2 ? tanh(x)*y : x^3 - y", "2"}) {
    ExpressionGraph graph;
    const int value = graph.Add(**ParseExpression(text), kInputs);
    const ExpressionProgram program(graph, {value, graph.Derivative(value, 0), graph.Derivative(value, 1)}, 2,
                                    1);
    constexpr auto kPoints = static_cast<std::size_t>(ExpressionProgram::kPoints);
    std::vector<double> beside = program.PointRegisters();
    for (std::size_t p = 0; p < kPoints; ++p) {
      beside[p] = 0.1 * static_cast<double>(p) - 0.15;
      beside[kPoints + p] = 1.7;
    }
    program.RunFixedPoints(beside.data());
    program.RunPoints(beside.data());
    for (std::size_t p = 0; p < kPoints; ++p) {
      std::vector<double> one = program.Registers();
      one[0] = beside[p];
      one[1] = 1.7;
      program.RunFixed(one.data());
      program.Run(one.data());
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(beside[program.output(k) * kPoints + p], one[program.output(k)], 1e-14)
            << text << ", point " << p << ", output " << k;
    }
  }
}

TEST(ExpressionProgram, WhatDependsOnFixedInputsAloneIsComputedOnceForManyPoints) {
  ExpressionGraph graph;
  const int value = graph.Add(**ParseExpression("x*exp(y)"), kInputs);
  const ExpressionProgram program(graph, {value}, 2, 1);
  std::vector<double> registers = program.Registers();
  registers[0] = 2;
  registers[1] = 0;
  program.RunFixed(registers.data());
  registers[1] = 5;  // is not looked at again
  program.Run(registers.data());
  EXPECT_EQ(registers[program.output(0)], 2);
}

TEST(ExpressionProgram, ColumnsOfAnyLengthAreThePointsOneByOne) {
  std::string longest = "x";
  for (int k = 0; k < 60; ++k)
    longest += k % 2 == 0 ? "+sin(y)*" + std::to_string(k) : "-x/" + std::to_string(k + 2);
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const std::string& text : {std::string("x^2 - exp(-abs(y))"), std::string("3"), longest}) {
    const auto tree = ParseExpression(text);
    ASSERT_TRUE(tree) << tree.error().text.english;
    const ExpressionEvaluator evaluator(**tree, kInputs);
    std::vector<std::vector<double>> channels(2, std::vector<double>(1003));
    for (auto& channel : channels)
      for (double& v : channel) v = normal(random);
    std::vector<double> values(1000);
    evaluator.Values(channels, 3, values);
    for (std::size_t k = 0; k < values.size(); k += 37)
      EXPECT_EQ(values[k], SlopeOf(text, channels[0][k + 3], channels[1][k + 3]).value) << text;
  }
}

TEST(ExpressionProgram, TheDeepestExpressionHasItsDerivative) {
  std::string deep = "x";
  for (int k = 0; k < kMaxExpressionParts - 1; ++k) deep = "sin(" + deep + ")";
  ASSERT_TRUE(ParseExpression(deep));
  EXPECT_GT(SlopeOf(deep, 0.5, 0).by_x, 0);
  EXPECT_FALSE(ParseExpression("sin(" + deep + ")"));
}

}  // namespace
}  // namespace hydroscope
