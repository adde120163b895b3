// Logs that the library holds no law for, or not all signals: neither an all-clear nor a sure name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_history.h"
#include "workbench/explain/explain_log.h"
#include "workbench/explain/what_to_record.h"

namespace hydroscope {
namespace {

using testing::AnyOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::Not;

PressOptions ASeenPress(std::uint64_t seed) {
  PressOptions options;
  options.seconds = 80;
  options.seed = seed;
  return options;
}

Explanation ExplanationOf(const SimulatedLog& log, const Machine& machine,
                          const ExplainOptions& options = {}) {
  return ExplainStrokes(*StrokesOf(log, machine, KeepSamples::kYes), options)->explanation;
}

/// The magnets of a position sensor err the same at every period of its scale: no function of z that a law could be.
void ErrInCycles(double size, SimulatedLog& log) {
  for (double& z : log.z) z += size * std::sin(2 * std::numbers::pi * z / 0.011);
}

Explanation WithCyclicError(double size, std::uint64_t seed) {
  const PressOptions options = ASeenPress(seed);
  SimulatedLog log = SimulatePress(options);
  ErrInCycles(size, log);
  return ExplanationOf(log, MachineFor(options));
}

TEST(NothingFalse, AnErrorThatGoesOnFromBlockToBlockIsNotBlamedOnTheFloor) {
  EXPECT_EQ(WithCyclicError(3e-5, 5).verdict, Verdict::kUnknown);
}

TEST(NothingFalse, AnErrorThatGoesOnFromBlockToBlockIsNoNoiseThoughTheFloorWouldAllowIt) {
  const Explanation x = WithCyclicError(2.2e-5, 6);
  EXPECT_LT(x.base.excess_ratio, ExplainOptions().floor_excess);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.doubt.english, HasSubstr("goes on from block to block"));
}

/// A ram that trembles hides the noise of its position, but what noise there is, is white. Means of blocks of 20 ms see
/// nothing of 50 Hz.
Explanation OfTremblingRam(double cyclic_error) {
  const PressOptions options = ASeenPress(5);
  SimulatedLog log = SimulatePress(options);
  ErrInCycles(cyclic_error, log);
  for (std::size_t k = 0; k < log.t.size(); ++k)
    log.z[k] += 3e-4 * std::sin(2 * std::numbers::pi * 50 * log.t[k]);
  Explanation x = ExplanationOf(log, MachineFor(options));
  EXPECT_THAT(x.warnings, Contains(Field(&Told::english, HasSubstr("z moves within"))));
  return x;
}

TEST(NothingFalse, AnErrorThatGoesOnFromBlockToBlockIsNoNoiseWhereASignalMovesFromRowToRow) {
  EXPECT_EQ(OfTremblingRam(0).verdict, Verdict::kAdequate);
  const Explanation x = OfTremblingRam(3e-5);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.doubt.english, HasSubstr("goes on from block to block"));
}

TEST(NothingFalse, ADelayBesideASignalThatADeadbandHeldIsDoubtedAndTheDeadbandTold) {
  PressOptions options = ASeenPress(4);
  options.seconds = 90;
  options.effects = {{"spool_signal_delay", 3e-3, {}}};
  options.imperfections = {{"deadband", 6, {}, "z"}};
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_TRUE(x.set.empty() || x.partial);
  EXPECT_THAT(x.warnings, Contains(Field(&Told::english, AnyOf(HasSubstr("stored only where"),
                                                               HasSubstr("not stored at every row")))));
}

/// A rod side without a sensor: its leak to the other chamber and one to the outside are all the same.
TEST(NothingFalse, ALeakIsDoubtedWhereARivalNeedsASignalThatIsMissing) {
  PressOptions options = ASeenPress(3);
  options.effects = {{"internal_leakage", 8e-13, {}}};
  Machine machine = MachineFor(options);
  std::erase_if(machine.signals, [](const SignalSpec& signal) { return signal.name == "p_B"; });
  SimulatedLog log = SimulatePress(options);
  const Explanation x = ExplanationOf(log, machine);
  ASSERT_THAT(x.set, Contains("external_leakage"));
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("internal_leakage"));
  EXPECT_THAT(x.doubt.english, HasSubstr("p_B is not measured"));
  EXPECT_THAT(x.unmeasured, ElementsAre("p_B"));
}

/// With the supply's pressure a leak past its edge stands beside the seal's; without it no less. What takes away a name comes
/// first, also where there are other doubts, and the next step is to measure it. Stored strokes say the same.
TEST(NothingFalse, ALeakIsDoubtedWhereTheSupplyIsNotMeasured) {
  PressOptions options = ASeenPress(3);
  options.effects = {{"internal_leakage", 8e-13, {}}};
  Machine machine = MachineFor(options);
  std::erase_if(machine.signals, [](const SignalSpec& signal) { return signal.name == "p_0"; });
  const auto strokes = StrokesOf(SimulatePress(options), machine, KeepSamples::kYes);
  const auto result = ExplainStrokes(*strokes);
  const Explanation& x = result->explanation;
  EXPECT_THAT(x.set, Contains("internal_leakage"));
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, testing::StartsWith("supply_leakage may be the cause as well"));
  EXPECT_THAT(WhatToRecord(*result)->english, HasSubstr("Measure p_0 as well"));

  StrokeHistory history;
  history.machine = machine;
  history.model = strokes->model;
  history.window = strokes->window;
  history.units = strokes->Grams();
  for (std::int64_t k = 0; k < std::ssize(history.units); ++k)
    history.unit_parts.push_back({machine.name, 1, k, k + 1});
  for (const StrokeRecord& stroke : strokes->strokes) history.sample.push_back(stroke.summary);
  const Explanation stored = ExplainHistory(history)->explanation;
  ASSERT_THAT(stored.set, Contains("internal_leakage"));
  EXPECT_TRUE(stored.partial);
  EXPECT_THAT(stored.doubt.english, HasSubstr("p_0 is not measured"));
}

/// The pressure of the rod side moves so little here that the seal's leak by itself explains all of both.
TEST(NothingFalse, TwoLeaksThatMayShareWhatWasFoundAreNotOneForSure) {
  PressOptions options = RandomMachine(4292157915);
  options.seconds = 148.94;
  options.oil_start = 302.305;
  options.oil_end = 310.924;
  options.effects = {{"internal_leakage", 3.3902e-12, {}}, {"external_leakage", 2.9369e-12, {}}};
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_THAT(x.set, Contains("internal_leakage"));
  EXPECT_THAT(x.set, Contains("external_leakage"));
}

/// As a historian with a deadband gives it out: what left the deadband was stored, the rest is drawn straight.
void StoreByDeadband(double deadband, std::vector<double>& x) {
  std::size_t stored = 0;
  for (std::size_t k = 1; k < x.size(); ++k) {
    if (std::abs(x[k] - x[stored]) <= deadband) continue;
    const double slope = (x[k] - x[stored]) / static_cast<double>(k - stored);
    for (std::size_t i = stored + 1; i < k; ++i) x[i] = x[stored] + slope * static_cast<double>(i - stored);
    stored = k;
  }
}

TEST(NothingFalse, APlayOfASpoolThatWasStoredByDeadbandIsDoubted) {
  PressOptions options = ASeenPress(4);
  options.effects = {{"spool_hysteresis", 0.008, {}}};
  SimulatedLog log = SimulatePress(options);
  const Machine machine = MachineFor(options);
  const Explanation as_recorded = ExplanationOf(log, machine);
  ASSERT_THAT(as_recorded.set, Contains("spool_hysteresis"));
  EXPECT_THAT(as_recorded.doubt.english, Not(HasSubstr("stored at some rows only")));
  StoreByDeadband(0.0008, log.y_v);
  const Explanation x = ExplanationOf(log, machine);
  ASSERT_THAT(x.set, Contains("spool_hysteresis"));
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("y_v was stored at some rows only"));
}

TEST(NothingFalse, APlaySmallerThanTheStepsOfTheReadingsIsDoubted) {
  constexpr double kPlay = 0.003, kStep = 0.004;
  PressOptions options = ASeenPress(4);
  options.effects = {{"spool_hysteresis", kPlay, {}}};
  SimulatedLog log = SimulatePress(options);
  const Machine machine = MachineFor(options);
  const Explanation fine = ExplanationOf(log, machine);
  ASSERT_THAT(fine.set, Contains("spool_hysteresis"));
  EXPECT_THAT(fine.doubt.english, Not(HasSubstr("coarser")));
  for (double& y : log.y_v) y = kStep * std::round(y / kStep);
  const Explanation x = ExplanationOf(log, machine);
  ASSERT_THAT(x.set, Contains("spool_hysteresis"));
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("read in steps coarser"));
}

/// Late by `slow` where the pressure falls and by a quarter of it where it rises, as it moves over some rows.
void LagUnlikeUpAndDown(double slow, SimulatedLog& log) {
  constexpr std::size_t kRows = 5;
  const std::vector<double> p = log.p_A;
  for (std::size_t k = kRows; k + kRows < p.size(); ++k) {
    const double rate = (p[k + kRows] - p[k - kRows]) / (log.t[k + kRows] - log.t[k - kRows]);
    log.p_A[k] -= (rate > 0 ? slow / 4 : slow) * rate;
  }
}

/// Of two effects found one is a twin of what the other is easily taken for.
TEST(NothingFalse, ASensorThatLagsUnlikeUpAndDownIsNotTwoEffectsForSure) {
  const PressOptions options = ASeenPress(5);
  SimulatedLog log = SimulatePress(options);
  LagUnlikeUpAndDown(0.0034, log);
  const Explanation x = ExplanationOf(log, MachineFor(options));
  ASSERT_EQ(x.groups.size(), 2u);
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("have similar signatures"));
}

/// Weak evidence is let through, so that what noise gains is found at all.
ExplainOptions Eager(double min_t) {
  ExplainOptions eager;
  eager.min_gain = 4;
  eager.min_t = min_t;
  eager.trifle = 0;
  return eager;
}

TEST(NothingFalse, NoNameHasAnIntervalThatHoldsZeroWhereNothingIsNeeded) {
  for (const std::uint64_t seed : {81u}) {
    const PressOptions options = ASeenPress(seed);
    const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options), Eager(1.2));
    EXPECT_EQ(x.verdict, Verdict::kAdequate) << seed;
    EXPECT_TRUE(x.final.effects.empty()) << seed;
  }
}

/// All other doubts are put aside.
TEST(NothingFalse, WhatMayStandOutByChanceIsFlaggedWhereNothingIsNeeded) {
  ExplainOptions eager = Eager(2.2);
  eager.doubt_margin = std::numeric_limits<double>::lowest();
  eager.doubt_remainder = std::numeric_limits<double>::max();
  for (const std::uint64_t seed : {63u, 70u}) {
    const PressOptions options = ASeenPress(seed);
    const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options), eager);
    ASSERT_FALSE(x.set.empty()) << seed;
    EXPECT_TRUE(x.partial) << seed;
    EXPECT_THAT(x.doubt.english, HasSubstr("by chance")) << seed;
  }
}

/// A relief valve that opens below what any such valve is set to is described best at the limit.
TEST(NothingFalse, AValueAtTheLimitOfItsLawIsADoubt) {
  PressOptions options = ASeenPress(2);
  options.effects = {{"relief_valve", 2e-12, {{"crack", 95e5}}}};
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  ASSERT_THAT(x.set, Contains("relief_valve"));
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("p_crack of relief_valve comes out at the limit"));
}

/// AR(1) noise of the spool's sensor, whose correlation lasts some rows.
void ColourSpoolNoise(double std, double phi, SimulatedLog& log) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double noise = 0;
  for (double& y : log.y_v) {
    noise = phi * noise + std::sqrt(1 - phi * phi) * normal(random);
    y += std * noise;
  }
}

/// What is slower than the rows of a spool may be motion: the noise cannot be counted, and is told of.
TEST(NothingFalse, ColouredNoiseOfTheSpoolIsToldOfWhereItMayBeTheError) {
  const PressOptions options = ASeenPress(4);
  SimulatedLog log = SimulatePress(options);
  ColourSpoolNoise(0.006, 0.7, log);
  const Explanation x = ExplanationOf(log, MachineFor(options));
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_TRUE(x.set.empty());
  EXPECT_THAT(x.warnings, Contains(Field(&Told::english, HasSubstr("noise of y_v is not white"))));
}

/// Spool noise that the valve integrates is alike in neighbouring equations: further laws gain so much by chance that the leak
/// would not be named for them.
TEST(NothingFalse, EquationsThatAreAlikeTellLess) {
  PressOptions options = ASeenPress(4);
  options.effects = {{"internal_leakage", 4e-12, {}}};
  SimulatedLog log = SimulatePress(options);
  ColourSpoolNoise(0.02, 0, log);
  const Explanation x = ExplanationOf(log, MachineFor(options));
  EXPECT_GT(x.evidence_scale, 2);
  EXPECT_THAT(x.set, ElementsAre("internal_leakage"));
}

/// A press whose spool sensor errs by `error` of the opening.
template <typename Error>
Explanation WithBentSpoolReading(std::uint64_t seed, Error error) {
  const PressOptions options = ASeenPress(seed);
  SimulatedLog log = SimulatePress(options);
  for (double& y : log.y_v) y += error(y);
  return ExplanationOf(log, MachineFor(options));
}

void ExpectNoOtherNameForSure(const Explanation& x, std::uint64_t seed) {
  EXPECT_TRUE(x.partial || x.set.empty() || testing::Matches(Contains("spool_nonlinearity"))(x.set))
      << seed << ": " << testing::PrintToString(x.set);
}

/// At one ram speed a leak looks like a null that follows the pressure, which explained it a little better, but for what another
/// law would still explain.
TEST(NothingFalse, WhatIsNotQuiteTheLawKeepsItsRivals) {
  PressOptions options = RandomMachine(239617693);
  options.seconds = 162;
  options.oil_start = 304.8;
  options.oil_end = 313.6;
  options.motion.speed_min = options.motion.speed_max = 0.073;
  options.effects = {{"external_leakage", 7.76e-12, {}}};
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_THAT(x.set, Contains("external_leakage"));
}

/// Less flow at large openings is what a choked return line does, too.
TEST(NothingFalse, ASpoolSensorThatIsNotLinearIsNoOtherCauseForSure) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Explanation x = WithBentSpoolReading(seed, [](double y) { return 0.09 * (y * y * y - 0.4 * y); });
    EXPECT_NE(x.verdict, Verdict::kAdequate) << seed;
    ExpectNoOtherNameForSure(x, seed);
  }
}

/// Some of these bends are lost in the noise.
TEST(NothingFalse, NorIsOneThatBendsInAnotherWay) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    ExpectNoOtherNameForSure(
        WithBentSpoolReading(seed, [](double y) { return 0.02 * std::sin(std::numbers::pi * y); }), seed);
    ExpectNoOtherNameForSure(WithBentSpoolReading(seed, [](double y) { return -0.05 * y * std::abs(y); }),
                             seed);
    ExpectNoOtherNameForSure(WithBentSpoolReading(seed, [](double y) { return 0.06 * std::pow(y, 5); }),
                             seed);
  }
}

TEST(NothingFalse, AChokedReturnLineThatNoEdgeLooksLikeIsNamed) {
  PressOptions options = ASeenPress(5);
  options.effects = {{"tank_back_pressure", 1.5e12, {}}};
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_THAT(x.set, ElementsAre("tank_back_pressure"));
  EXPECT_FALSE(x.partial) << x.doubt.english;
}

/// A controller as slow as the logger holds its command for a row, and the spool gets there early in it: the line between two
/// readings is late, and the spool seems to be.
TEST(NothingFalse, ASpoolThatMovesUnseenBetweenRowsIsNotLate) {
  PressOptions options = RandomMachine(13);
  options.sample_period = 0.004;
  options.effects = {{"spool_signal_delay", 0.0005, {}}};
  for (double* noise : {&options.noise.p_A, &options.noise.z, &options.noise.y_v}) *noise *= 0.2;
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_EQ(x.verdict, Verdict::kAdequate);
  EXPECT_THAT(x.warnings, Contains(testing::Field(&Told::english, HasSubstr("held from row to row"))));
}

/// One that is later than that, but less than half a row, is not late for sure.
TEST(NothingFalse, ASpoolThatMayMoveUnseenBetweenRowsHasNoVerdict) {
  PressOptions options = RandomMachine(13);
  options.sample_period = options.control_period = 0.004;
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.set, IsEmpty());
  EXPECT_TRUE(x.small_error);
  EXPECT_FALSE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("between two rows"));
}

/// Nor beside another effect, which is named without it.
TEST(NothingFalse, ASpoolThatMovesUnseenBetweenRowsIsNoSecondName) {
  PressOptions options = RandomMachine(13);
  options.sample_period = 0.004;
  options.effects = {{"internal_leakage", 2e-11, {}}, {"spool_signal_delay", 0.001, {}}};
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_THAT(x.set, Contains("internal_leakage"));
  EXPECT_THAT(x.set, Not(Contains("spool_signal_delay")));
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("between two rows"));
}

/// Strokes that leak for a while draw the delay far off before they are left out; its twin must not stand alone then.
TEST(NothingFalse, ADelayThatOddStrokesDrewAwayStaysBesideItsTwin) {
  PressOptions options = RandomMachine(25);
  options.seconds = 90;
  options.effects = {{"pressure_signal_delay", 0.0058, {}}};
  options.imperfections = {{"leaky_stretch", 1.5e-11, {{"begin", 0.4}, {"length", 0.2}}, ""}};
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_THAT(x.set, Contains("pressure_signal_delay"));
}

/// What explains a part of the error only is no name for it: here none may be left, not even what is due to chance.
TEST(NothingFalse, AnEffectThatLeavesMuchOfTheErrorIsNoName) {
  PressOptions options = ASeenPress(6);
  options.effects = {{"internal_leakage", 4e-12, {}}};
  const SimulatedLog log = SimulatePress(options);
  ExplainOptions strict;
  EXPECT_THAT(ExplanationOf(log, MachineFor(options), strict).set, Contains("internal_leakage"));
  strict.doubt_excess = -1;
  strict.most_left = -1;
  const Explanation x = ExplanationOf(log, MachineFor(options), strict);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.set, IsEmpty());
  EXPECT_TRUE(x.partial);
  EXPECT_THAT(x.doubt.english, HasSubstr("more energy than sensor noise"));
}

/// What falls is of negative size, and no delay.
TEST(NothingFalse, AFlowGainThatFallsIsNotDoubtedForTheDistanceOfRows) {
  PressOptions options = ASeenPress(6);
  options.imperfections = {{"Q_vn_drift", -0.04, {}, ""}};
  const Explanation x = ExplanationOf(SimulatePress(options), MachineFor(options));
  EXPECT_THAT(x.set, Contains("Q_vn_drift"));
  EXPECT_FALSE(x.partial) << x.doubt.english;
}

/// Sensors finer than any plant's show that signals do not quite move evenly between rows.
TEST(NothingFalse, AnErrorThatNoSensorOfAPlantWouldShowIsNone) {
  PressOptions options = ASeenPress(13);
  options.control_period = options.sample_period;
  for (double* noise : {&options.noise.p_A, &options.noise.z, &options.noise.y_v}) *noise *= 0.02;
  const SimulatedLog log = SimulatePress(options);
  ExplainOptions strict;
  strict.trifle = 0;
  EXPECT_NE(ExplanationOf(log, MachineFor(options), strict).verdict, Verdict::kAdequate);
  EXPECT_EQ(ExplanationOf(log, MachineFor(options)).verdict, Verdict::kAdequate);
}

/// It is named, however little of the output it is; where it may not be, that is no all-clear.
TEST(NothingFalse, ATrifleOfTheOutputThatAParameterHangsOnIsNone) {
  PressOptions options = ASeenPress(13);
  options.effects = {{"pressure_signal_delay", 0.004, {}}};
  const SimulatedLog log = SimulatePress(options);
  ExplainOptions lenient;
  lenient.trifle = 0.01;
  EXPECT_THAT(ExplanationOf(log, MachineFor(options), lenient).set, Contains("pressure_signal_delay"));
  lenient.min_gain = 1e6;
  const Explanation x = ExplanationOf(log, MachineFor(options), lenient);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_TRUE(x.small_error);
  EXPECT_THAT(x.doubt.english, HasSubstr("hangs on it"));
}

/// The error of an oil column in the line, which the library is to know nothing of: a tenth of the noise energy, and no effect gains
/// enough of it for a name.
TEST(NothingFalse, AnErrorNearTheFloorThatIsNoChanceIsNoAllClear) {
  PressOptions options = RandomMachine(1917422222);
  options.seconds = 106.77;
  options.effects = {{"line_inertance", 2.308e7, {}}};
  ExplainOptions explain;
  explain.exclude = {"line_inertance"};
  const SimulatedLog log = SimulatePress(options);
  const Explanation x = ExplanationOf(log, MachineFor(options), explain);
  EXPECT_LT(x.base.excess_ratio, explain.floor_excess);
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.doubt.english, HasSubstr("a small error is sure"));
  options.effects.clear();
  EXPECT_EQ(ExplanationOf(SimulatePress(options), MachineFor(options)).verdict, Verdict::kAdequate);
}

}  // namespace
}  // namespace hydroscope
