#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "models/expressions/check.h"
#include "models/expressions/columns.h"
#include "models/expressions/guard.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

Machine Cylinder() {
  Machine machine;
  machine.model = "expressions";
  for (const auto& [name, unit] : {std::pair("F", "N"), std::pair("x", "mm"), std::pair("p", "bar")}) {
    machine.signals.emplace_back();
    machine.signals.back().name = name;
    machine.signals.back().unit = unit;
  }
  machine.geometry["d"] = {0.025, 0, "m"};
  machine.geometry["n"] = {1.3, 0, ""};
  return machine;
}

ExpressionError ErrorOf(const std::string& text) {
  const auto checked = CheckExpression(text, ExpressionNamesOf(Cylinder()));
  EXPECT_FALSE(checked) << text;
  return checked ? ExpressionError{} : checked.error();
}

/// Value of an expression without signals.
double Value(const std::string& text) {
  const auto tree = ParseExpression(text);
  EXPECT_TRUE(tree) << text << ": " << (tree ? "" : tree.error().text.english);
  if (!tree) return NAN;
  const ExpressionEvaluator evaluator(**tree, {});
  double value = NAN;
  evaluator.Values({}, 0, std::span(&value, 1));
  return value;
}

TEST(Expression, FollowsTheRulesOfArithmetic) {
  EXPECT_DOUBLE_EQ(Value("1 + 2*3 - 4/8"), 6.5);
  EXPECT_DOUBLE_EQ(Value("2^3^2"), 512);
  EXPECT_DOUBLE_EQ(Value("-2^2"), -4);
  EXPECT_DOUBLE_EQ(Value("2^-1"), 0.5);
  EXPECT_DOUBLE_EQ(Value("8/4/2"), 1);
  EXPECT_DOUBLE_EQ(Value("(1 + 2)*3e-1"), 0.9);
  EXPECT_DOUBLE_EQ(Value("1 < 2 && !(3 <= 2) ? 7 : 8"), 7);
  EXPECT_DOUBLE_EQ(Value("0 ? 1 : 0 ? 2 : 3"), 3);
}

TEST(Expression, EveryFunctionIsComputed) {
  EXPECT_DOUBLE_EQ(Value("abs(-3) + sign(-2) + sqrt(9)"), 5);
  EXPECT_DOUBLE_EQ(Value("ln(exp(2)) + log10(1000)"), 5);
  EXPECT_DOUBLE_EQ(Value("sin(0.5)^2 + cos(0.5)^2"), 1);
  EXPECT_NEAR(Value("tan(atan(0.7)) + asin(sin(0.2)) + acos(cos(0.1))"), 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(Value("atan2(1, 1)"), std::atan2(1, 1));
  EXPECT_NEAR(Value("cosh(1)^2 - sinh(1)^2 + tanh(0)"), 1, 1e-12);
  EXPECT_DOUBLE_EQ(Value("min(3, 1, 2) + max(3, 1, 2)"), 4);
}

TEST(Expression, AMistakeIsFoundAtItsCharacter) {
  EXPECT_EQ(ErrorOf("p*sign(ddt(xx))").at, 11u);
  EXPECT_THAT(ErrorOf("p*sign(ddt(xx))").text.english, HasSubstr("did you mean \"x\"?"));
  EXPECT_EQ(ErrorOf("p*").at, 2u);
  EXPECT_EQ(ErrorOf("p*sgn(x)").at, 2u);
  EXPECT_THAT(ErrorOf("p*sgn(x)").text.english, HasSubstr("did you mean \"sign\"?"));
  EXPECT_EQ(ErrorOf("(p + 1").at, 6u);
  EXPECT_EQ(ErrorOf("p $ x").at, 2u);
  EXPECT_THAT(ErrorOf("2p").text.english, HasSubstr("write *"));
  EXPECT_THAT(ErrorOf("1,5*p").text.english, HasSubstr("decimal sign is a point"));
  EXPECT_THAT(ErrorOf("log(p)").text.english, HasSubstr("ln"));
  EXPECT_THAT(ErrorOf("min(p)").text.english, HasSubstr("2 or more arguments, found 1"));
  EXPECT_EQ(CaretLine("p*sign(ddt(xx))", 11), "    p*sign(ddt(xx))\n               ^");
}

TEST(Expression, EveryMistakeIsToldInGermanToo) {
  for (const char* wrong :
       {"p*", "p $ x", "1,5*p", "2p", "p)", "(p", "sgn(p)", "log(p)", "min(p)", "p*q", "p + x", "exp(p)",
        "p^x", "1/ddt(x)", "ddt(x)^1.5", "sqrt(ddt(x))", "delay(p, 1)"}) {
    const Told text = ErrorOf(wrong).text;
    EXPECT_FALSE(text.english.empty()) << wrong;
    EXPECT_FALSE(text.german.empty()) << wrong;
    EXPECT_NE(text.german, text.english) << wrong;
  }
  EXPECT_THAT(ErrorOf("p*sgn(x)").text.german, HasSubstr("war \"sign\" gemeint?"));
  EXPECT_THAT(ErrorOf("min(p)").text.german, HasSubstr("2 oder mehr Argumente, gefunden 1"));
}

TEST(Expression, DeepOrLongOnesAreRefusedBeforeTheyHurt) {
  EXPECT_THAT(ErrorOf(std::string(1000, '(')).text.english, HasSubstr("200 brackets"));
  std::string sum = "x";
  for (int k = 0; k < 600; ++k) sum += "+x";
  EXPECT_THAT(ErrorOf(sum).text.english, HasSubstr("500 operators"));
  EXPECT_THAT(ErrorOf(std::string(3000, ' ') + "x").text.english, HasSubstr("longer than 2000"));
  std::string power = "x";
  for (int k = 0; k < 600; ++k) power += "^x";
  EXPECT_THAT(ErrorOf(power).text.english, HasSubstr("500 operators"));
}

TEST(Expression, UnitsThatCannotFitAreFound) {
  EXPECT_THAT(ErrorOf("p + x").text.english, HasSubstr("puts Pa and m together"));
  EXPECT_EQ(ErrorOf("p + x").at, 2u);
  EXPECT_THAT(ErrorOf("exp(p)").text.english, HasSubstr("exp of Pa"));
  EXPECT_THAT(ErrorOf("p > x ? 1 : 0").text.english, HasSubstr("puts Pa and m together"));
  EXPECT_THAT(ErrorOf("max(p, x)").text.english, HasSubstr("Pa and m"));
}

TEST(Expression, NumbersMayCarryAnyUnit) {
  const ExpressionNames names = ExpressionNamesOf(Cylinder());
  for (const char* fine :
       {"p*exp(-((x - 0.11)/0.02)^2)", "p + 1e5", "max(p - 2e5, 0)", "p^n", "F + p*pi*d^2/4"})
    EXPECT_TRUE(CheckExpression(fine, names)) << fine;
}

TEST(Expression, ItsUnitFollowsFromTheSignals) {
  const ExpressionNames names = ExpressionNamesOf(Cylinder());
  const auto unit = [&](const std::string& text) {
    const auto checked = CheckExpression(text, names);
    return checked && checked->unit.exact ? SiUnitName(checked->unit.dimension) : "?";
  };
  EXPECT_EQ(unit("p*sign(ddt(x))"), "Pa");
  EXPECT_EQ(unit("F/p"), "m2");
  EXPECT_EQ(unit("sqrt(p)"), "sqrt(Pa)");
  EXPECT_EQ(unit("ddt(p*x)"), "Pa m/s");
  EXPECT_EQ(unit("0.5*p"), "?");
}

TEST(Expression, SiUnitsAreReadAndWritten) {
  EXPECT_EQ(SiUnitName(*ParseSiUnit("m3/(s Pa)")), "m3/(s Pa)");
  EXPECT_EQ(SiUnitName(*ParseSiUnit("N/Pa")), "m2");
  EXPECT_EQ(SiUnitName(*ParseSiUnit("N m s-1")), "W");
  EXPECT_EQ(SiUnitName(*ParseSiUnit("J")), "N m");
  EXPECT_EQ(SiUnitName(*ParseSiUnit("kg m2/s")), "N m s");
  EXPECT_EQ(SiUnitName(*ParseSiUnit("kg m5/A")), "kg m5/A");
  for (const char* short_name : {"V2", "1/(V2 s)", "1/W", "s/V", "1/(N m)", "N2", "Pa2 s"})
    EXPECT_EQ(SiUnitName(*ParseSiUnit(short_name)), short_name);
  for (const char* wrong : {"bar", "mm", "m3/(s Pa", "m//s", "", "N)", "m-", "furlong"})
    EXPECT_FALSE(ParseSiUnit(wrong)) << wrong;
}

TEST(Expression, WhatFailsWhenTheMotionTurnsIsRefused) {
  EXPECT_THAT(ErrorOf("1/ddt(x)").text.english, HasSubstr("division"));
  EXPECT_THAT(ErrorOf("sqrt(ddt(x))").text.english, HasSubstr("sqrt"));
  EXPECT_THAT(ErrorOf("ln(abs(ddt(x)))").text.english, HasSubstr("ln"));
  EXPECT_THAT(ErrorOf("ddt(x)^1.5").text.english, HasSubstr("power"));
  ExpressionNames names = ExpressionNamesOf(Cylinder());
  names.units["v_s"] = ParseSiUnit("m/s");
  names.found["v_s"] = {0.001, 0.1};
  for (const char* fine : {"exp(-abs(ddt(x))/v_s)*sign(ddt(x))", "abs(ddt(x))^n", "sqrt(abs(ddt(x)))",
                           "ddt(x)/max(abs(ddt(x)), 0.001)", "ddt(x)^2", "exp(-(ddt(x)/0.01)^2)",
                           "exp(-abs(ddt(x))/0.005)*sign(ddt(x))", "abs(ddt(x))^0.5", "tanh(ddt(x)/0.001)"})
    EXPECT_TRUE(CheckExpression(fine, names)) << fine;
}

/// x = t^2, p = t at samples 0.01 s apart; rates by a window of 0.03 s.
class Columns : public testing::Test {
 protected:
  Columns() {
    model_.channel_names = {"x", "p"};
    stretch_.samples = 201;
    stretch_.period = 0.01;
    names_.units = {{"x", Dimension{}}, {"p", Dimension{}}};
  }
  Expression Tree(const std::string& text) { return CheckExpression(text, names_)->tree; }
  void Derive(const ExpressionChannels& channels) {
    stretch_.channel.assign(model_.channel_names.size(), std::vector<double>(201));
    for (int k = 0; k < 201; ++k) {
      stretch_.channel[0][static_cast<std::size_t>(k)] = 1e-4 * k * k;
      stretch_.channel[1][static_cast<std::size_t>(k)] = 0.01 * k;
    }
    channels.Derivation()(stretch_);
  }
  /// The integral of the expression over the stretch, 0 ... 2 s.
  double Integral(const std::string& text) {
    ExpressionChannels channels(model_, 0.03);
    const std::vector<ExpressionPart> sum_of = channels.Parts(Tree(text));
    const ExpressionParts parts(sum_of, channels.Indices());
    Derive(channels);
    std::vector<double> increments(200);
    parts.Increments(stretch_, increments);
    double sum = 0;
    for (double i : increments) sum += i;
    return sum;
  }

  ModelStructure model_;
  Stretch stretch_;
  ExpressionNames names_;
};

TEST_F(Columns, TheIntegralOfARateIsADifference) {
  EXPECT_NEAR(Integral("ddt(x)"), 4, 1e-12);
  EXPECT_NEAR(Integral("3*ddt(x) - ddt(p)/2"), 11, 1e-12);
  EXPECT_NEAR(Integral("-(p*ddt(x))"), -16.0 / 3, 1e-3);  // integral of t * 2 t dt
  EXPECT_NEAR(Integral("ddt(p*x)"), 8, 1e-12);
  EXPECT_NEAR(Integral("p"), 2, 1e-12);
  EXPECT_EQ(model_.channel_names.size(), 2u) << "no rate is needed as a value";
}

TEST_F(Columns, ARateInsideAFunctionComesFromTheWindow) {
  EXPECT_NEAR(Integral("sign(ddt(x))"), 2, 1e-12);
  EXPECT_NEAR(Integral("ddt(x)^2"), 32.0 / 3, 0.05);  // integral of 4 t^2 dt
  EXPECT_NEAR(Integral("ddt(ddt(x))"), 4, 0.15);      // the speed rises by 4 but for the ends of the window
  EXPECT_EQ(model_.channel_names.back(), "ddt(x)");
}

TEST_F(Columns, SensorNoiseIsSeenByTheContrastAndSlopesAreNot) {
  ExpressionChannels channels(model_, 0.03);
  const ExpressionParts parts(channels.Parts(Tree("2*p")), channels.Indices());
  Derive(channels);
  EXPECT_NEAR(parts.Contrast(stretch_, 50), 0, 1e-12);
  stretch_.channel[1][50] += 0.3;
  EXPECT_NEAR(parts.Contrast(stretch_, 50), -0.3, 1e-12);
}

TEST(ExpressionGuard, RowsWithoutAFiniteValueAreFlagged) {
  Machine machine = Cylinder();
  machine.balance = {"F", "N", {{"A", "sqrt(p - 1e5)", ""}}, {}};
  const auto guard = ExpressionGuard::For(machine);
  ASSERT_TRUE(guard);
  SampleBlock block;
  block.Resize(3, 4);
  block.signal[2] = {2e5, 0.5e5, 0.5e5, 3e5};
  for (auto& flags : block.quality) flags.assign(4, quality::kGood);
  block.quality[2][2] = quality::kSpike;
  guard->Flag(block, 4);
  EXPECT_EQ(block.quality[2], (std::vector<Quality>{0, quality::kExpression, quality::kSpike, 0}));
  EXPECT_EQ(block.quality[0], std::vector<Quality>(4, 0));
}

TEST(ExpressionGuard, CostsNothingWhereNothingCanFail) {
  Machine machine = Cylinder();
  machine.balance = {"F", "N", {{"A", "p", ""}, {"c", "1", ""}}, {}};
  machine.user_effects = {{"friction", "", {{"F_c", "sign(ddt(x))", "N"}}}};
  EXPECT_FALSE(ExpressionGuard::For(machine));
}

}  // namespace
}  // namespace hydroscope
