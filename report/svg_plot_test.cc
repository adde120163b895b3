#include "report/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "report/svg_heat.h"
#include "report/svg_sheet.h"
#include "report/svg_text.h"
#include "report/xml_check_fixture.h"

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

SvgPlot::Options Named(const std::string& text) {
  SvgPlot::Options options;
  options.title = text;
  options.x_label = text;
  options.y_label = text;
  return options;
}

int CountOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(EscapeText, MakesMarkupHarmlessAndKeepsOtherLanguages) {
  EXPECT_EQ(EscapeText("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  EXPECT_EQ(EscapeText("Presse Süd 超长"), "Presse Süd 超长");
}

TEST(EscapeText, ReplacesBytesThatAreNoTextByTheReplacementCharacter) {
  const std::string replacement = "\xEF\xBF\xBD";
  EXPECT_EQ(EscapeText("a\xFFz"), "a" + replacement + "z");
  EXPECT_EQ(EscapeText(std::string("a\0z", 3)), "a" + replacement + "z");
  EXPECT_EQ(EscapeText("\xC3"), replacement);        // cut short
  EXPECT_EQ(EscapeText("\xED\xA0\x80").size(), 9u);  // a surrogate: three bad bytes
}

TEST(FormatWithUncertainty, ShowsTwoDigitsOfTheUncertainty) {
  EXPECT_EQ(FormatWithUncertainty(1.41234, 0.02149), "1.412 ± 0.021");
  EXPECT_EQ(FormatWithUncertainty(-0.418, 0.0877), "\u22120.418 ± 0.088");
  EXPECT_EQ(FormatWithUncertainty(1234.5, 25.0), "1234 ± 25");
  EXPECT_EQ(FormatWithUncertainty(0.0999, 0.0996), "0.10 ± 0.10");
}

TEST(FormatWithUncertainty, ShowsFourDigitsWithoutUncertaintyAndADashWithoutValue) {
  EXPECT_EQ(FormatWithUncertainty(38.1876, 0), "38.19");
  EXPECT_EQ(FormatWithUncertainty(kNaN, kNaN), "–");
}

TEST(FormatFixed, NeverShowsANegativeZero) { EXPECT_EQ(FormatFixed(-0.001, 1), "0.0"); }

TEST(FormatCount, GroupsLongNumbers) {
  EXPECT_EQ(FormatCount(9999), "9999");
  EXPECT_EQ(FormatCount(1800000), "1\u202F800\u202F000");
}

TEST(NiceTicks, StandAtRoundNumbersWithEqualDecimals) {
  EXPECT_THAT(NiceTicks(0.1, 0.95, 4).labels, ElementsAre("0.2", "0.4", "0.6", "0.8"));
  EXPECT_THAT(NiceTicks(-30, 12, 4).labels, ElementsAre("\u221230", "\u221220", "\u221210", "0", "10"));
}

TEST(NiceTicks, CountInWholeStepsWhereTheAxisCounts) {
  EXPECT_THAT(NiceTicks(0, 2.4, 8, true).labels, ElementsAre("0", "1", "2"));
}

TEST(NiceTicks, ShareAPowerOfTenWhereNumbersAreTinyOrHuge) {
  EXPECT_EQ(NiceTicks(0, 4e-12, 4).exponent, -12);
  EXPECT_THAT(NiceTicks(0, 4e-12, 4).labels, ElementsAre("0", "1", "2", "3", "4"));
  EXPECT_EQ(PowerOfTen(-12), "10⁻¹²");
}

TEST(PaddedRange, GivesASingleValueARangeAroundIt) {
  const AxisRange range = PaddedRange(5, 5, 0.1);
  EXPECT_LT(range.low, 5);
  EXPECT_GT(range.high, 5);
}

TEST(DecimateMinMax, KeepsTheOneSpikeAmongManyPoints) {
  std::vector<double> y(100000, 1.0);
  y[77777] = 9;
  const std::vector<std::size_t> kept = DecimateMinMax(y, 300);
  EXPECT_LE(kept.size(), 1200u);
  EXPECT_THAT(kept, testing::Contains(77777u));
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
}

TEST(DecimateMinMax, KeepsGapsThatAreAsLongAsABucket) {
  std::vector<double> y(10000, 1.0);
  std::fill(y.begin() + 4000, y.begin() + 6000, kNaN);
  int gaps = 0;
  for (const std::size_t i : DecimateMinMax(y, 100)) gaps += std::isnan(y[i]);
  EXPECT_GT(gaps, 10);
}

TEST(SvgPlot, IsWellFormedWhateverTheTextsSay) {
  SvgPlot plot(Named("<b>\"p_A\" & 'x' \xFF ]]> _{unclosed"));
  plot.Band({0, 1}, {0, 0}, {1, 1}, Ink::kBlue, "<band>");
  plot.Line({0, 1}, {0, 1}, {}, "a & b");
  plot.Points({0, 1}, {0, 1}, {}, "<i>", {"<title>", "&"});
  plot.Level(0.5, {}, "<level>");
  const std::string svg = plot.Render();
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_THAT(svg, Not(HasSubstr("<band>")));
  EXPECT_THAT(svg, HasSubstr("&lt;band&gt;"));
}

TEST(SvgPlot, SaysNoDataInsteadOfFailingWithoutAnyFiniteValue) {
  SvgPlot empty(Named("x"));
  EXPECT_EQ(XmlFault(empty.Render()), "");
  EXPECT_THAT(empty.Render(), HasSubstr("no data"));
  SvgPlot undefined(Named("x"));
  undefined.Line({kNaN, 1}, {1, kNaN}, {}, "line");
  undefined.Points({1}, {INFINITY}, {}, "");
  undefined.Band({1}, {kNaN}, {kNaN}, Ink::kSky, "");
  EXPECT_EQ(XmlFault(undefined.Render()), "");
  EXPECT_THAT(undefined.Render(), Not(HasSubstr("nan")));
  EXPECT_THAT(undefined.Render(), Not(HasSubstr("inf\"")));
}

TEST(SvgPlot, InterruptsALineAtAMissingValue) {
  SvgPlot plot(Named(""));
  plot.Line({0, 1, 2, 3, 4}, {0, 1, kNaN, 1, 0}, {}, "");
  const std::string svg = plot.Render();
  const std::size_t at = svg.find("class=\"p-line");
  const std::string path = svg.substr(at, svg.find("/>", at) - at);
  EXPECT_EQ(CountOf(path, "M"), 2);
}

TEST(SvgPlot, StaysSmallForManyPoints) {
  std::vector<double> x, y;
  for (int i = 0; i < 200000; ++i) x.push_back(i), y.push_back(std::sin(i * 0.01));
  SvgPlot plot(Named("x"));
  plot.Line(x, y, {}, "line");
  plot.Points(x, y, {}, "points", std::vector<std::string>(x.size(), "title"));
  plot.Band(x, y, y, Ink::kBlue, "band");
  EXPECT_LT(plot.Render().size(), 150000u);
}

TEST(SvgPlot, NamesALevelFarOffAtTheEdgeInsteadOfFlatteningTheData) {
  SvgPlot plot(Named("x"));
  plot.Line({0, 1}, {10, 11}, {}, "");
  plot.Level(500, {}, "alarm");
  plot.Level(11.5, {}, "warning");
  const std::string svg = plot.Render();
  EXPECT_THAT(svg, HasSubstr("alarm ↑"));
  EXPECT_THAT(svg, HasSubstr(">warning<"));
  EXPECT_THAT(svg, Not(HasSubstr(">500<")));
}

TEST(SvgPlot, DrawsSubscriptsOfSymbols) {
  SvgPlot plot(Named("Q_{vn} (l/min)"));
  EXPECT_THAT(plot.Render(), HasSubstr("Q<tspan dy=\"3\" font-size=\"75%\">vn</tspan>"));
  EXPECT_THAT(plot.Render(), HasSubstr("aria-label=\"Q_vn (l/min)\""));
}

TEST(SvgPlot, DrawsOneCellPerValueOfAHeatMapAndLeavesUnknownOnesBlank) {
  SvgPlot plot(Named("heat"));
  plot.HeatMap({0, 1, 2, 3}, {0, 1, 2}, {-1, 0, 1, kNaN, 0.5, -0.5}, true, "error (l/min)");
  const std::string svg = plot.Render();
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_EQ(CountOf(svg, "error (l/min): "), 6);
  EXPECT_EQ(CountOf(svg, "p-blank"), 1);
  EXPECT_THAT(svg, HasSubstr(HeatColour(0, true)));
  EXPECT_THAT(svg, HasSubstr(HeatColour(1, true)));
}

TEST(SvgPlot, DecadesOfALogarithmicAxisAreEquallyFarApart) {
  SvgPlot::Options options = Named("decades");
  options.log_x = true;
  options.x_range = AxisRange{1, 100};
  SvgPlot plot(options);
  plot.Line({1, 10, 100}, {0, 1, 2}, {}, "");
  plot.Line({-1, 0}, {1, 1}, {}, "nowhere");
  const std::string svg = plot.Render();
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  const std::size_t at = svg.find(" d=\"M", svg.find("p-line"));
  double x[3], y[3];
  ASSERT_EQ(std::sscanf(svg.c_str() + at, " d=\"M%lf %lfL%lf %lfL%lf %lf", x, y, x + 1, y + 1, x + 2, y + 2),
            6);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.2);
  for (const char* label : {">1<", ">2<", ">5<", ">10<", ">20<", ">50<", ">100<"})
    EXPECT_THAT(svg, HasSubstr(label));
  EXPECT_THAT(svg, Not(HasSubstr(">30<")));
}

TEST(SvgSheet, StandsByItselfAndHoldsItsPlotsOneBelowTheOther) {
  SvgPlot::Options options = Named("plot");
  options.height = 100;
  SvgPlot plot(options);
  plot.Line({1, 2}, {1, 2}, {}, "");
  const std::string sheet = SvgSheet("A <valve>", "with bars", {plot, plot});
  EXPECT_EQ(XmlFault(sheet), "");
  EXPECT_THAT(sheet,
              testing::AllOf(testing::StartsWith("<svg xmlns"), HasSubstr("<title>A &lt;valve&gt;</title>"),
                             HasSubstr("with bars"), HasSubstr("prefers-color-scheme:dark"),
                             HasSubstr("y=\"54\""), HasSubstr("y=\"164\"")));
}

TEST(HeatColour, OfADivergingMapIsPaleAtZero) {
  EXPECT_EQ(HeatColour(0.5, true), "#ebebeb");
  EXPECT_EQ(HeatColour(-3, false), HeatColour(0, false));
}

}  // namespace
}  // namespace hydroscope
