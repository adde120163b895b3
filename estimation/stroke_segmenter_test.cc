#include "estimation/stroke_segmenter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "machines/die_cushion/balance.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

constexpr double kGatePeriod = 0.002;

/// Only what the gate needs: z falls at `speed` inside the strokes, y_v is open throughout.
Machine TestMachine() {
  Machine machine;
  machine.name = "test";
  for (const char* name : {"p_A", "z", "y_v", "T_oil"}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    machine.signals.push_back(signal);
  }
  machine.geometry["A_A"] = {0.0125, 0};
  machine.geometry["dp_nom"] = {35e5, 0};
  machine.gate.bounds = {{"y_v", false, 0.02, std::nullopt}, {"z", true, std::nullopt, -0.004}};
  return machine;
}

enum Signal { kPressure, kZ, kY, kOil };

/// Motion of a machine that moves down for some time, rests, moves down again ...
class Motion {
 public:
  Motion() { block_.signal.resize(4), block_.quality.resize(4); }
  Motion& Draw(double seconds) { return Move(seconds, -0.05); }
  Motion& Rest(double seconds) { return Move(seconds, 0.0); }
  Motion& Flag(Signal signal, std::size_t row, Quality flag) {
    block_.quality[signal][row] |= flag;
    return *this;
  }
  /// Later rows are `by` s later, the first of them flagged in every channel.
  Motion& Step(std::size_t row, double by, Quality flag) {
    for (std::size_t k = row; k < block_.rows(); ++k) block_.time[k] += by;
    for (auto& quality : block_.quality) quality[row] |= flag;
    return *this;
  }
  SampleBlock& block() { return block_; }
  std::size_t rows() const { return block_.rows(); }

 private:
  Motion& Move(double seconds, double speed) {
    for (int k = 0; k < std::lround(seconds / kGatePeriod); ++k) {
      z_ += speed * kGatePeriod;
      block_.time.push_back(static_cast<double>(block_.rows()) * kGatePeriod);
      const double values[] = {80e5 + 1e5 * random_.Normal(), z_ + 1e-5 * random_.Normal(),
                               0.2 + 1e-3 * random_.Normal(), 313.15};
      for (int s = 0; s < 4; ++s) {
        block_.signal[s].push_back(values[s]);
        block_.quality[s].push_back(quality::kGood);
      }
    }
    return *this;
  }

  SampleBlock block_;
  double z_ = 0.2;
  RandomStream random_{7};
};

/// Everything the segmenter said.
struct Heard {
  struct Piece {
    double begin;
    bool continues;
    int samples, before, after;
    std::vector<double> pressure, position, spool;
    std::vector<double> known;  ///< pressures, those beyond the ends too
    bool operator==(const Piece&) const = default;
  };
  std::vector<Piece> pieces;
  std::vector<StrokeSummary> strokes;
  StrokeCounters totals;
  std::int64_t discarded = 0, discard_calls = 0;
};

Heard Hear(const SampleBlock& all, std::size_t rows_per_block, const Machine& machine = TestMachine(),
           const WindowSamples& window = {}) {
  Heard heard;
  const auto model = *BuildModel(machine);
  StrokeSegmenter segmenter(
      machine, model, window,
      {[&](Stretch& s, double begin) {
         const auto copy = [&](int c) { return std::vector<double>(s[c], s[c] + s.samples); };
         heard.pieces.push_back(
             {begin, s.continues, s.samples, s.before, s.after, copy(kPressureA), copy(kPosition),
              copy(kSpool),
              std::vector<double>(s[kPressureA] - s.before, s[kPressureA] + s.samples + s.after)});
       },
       [&](const StrokeSummary& summary) { heard.strokes.push_back(summary); },
       [&] { ++heard.discard_calls; }});
  SampleBlock part;
  for (std::size_t at = 0; at < all.rows(); at += rows_per_block) {
    const std::size_t count = std::min(rows_per_block, all.rows() - at);
    part.Resize(all.signal.size(), count);
    for (std::size_t k = 0; k < count; ++k) {
      part.time[k] = all.time[at + k];
      for (std::size_t s = 0; s < all.signal.size(); ++s) {
        part.signal[s][k] = all.signal[s][at + k];
        part.quality[s][k] = all.quality[s][at + k];
      }
    }
    segmenter.Process(part);
  }
  segmenter.Finish();
  heard.totals = segmenter.totals();
  heard.discarded = segmenter.discarded_strokes();
  return heard;
}

Heard Hear(Motion& rows) { return Hear(rows.block(), 1024); }

std::int64_t Flagged(const Heard& heard, Quality flag) {
  return heard.totals.flagged[std::countr_zero(flag)];
}

TEST(StrokeSegmenter, DoesNotDependOnHowRowsAreCutIntoBlocks) {
  Motion rows;
  rows.Rest(0.5).Draw(1.3).Rest(0.6).Draw(0.77).Rest(0.1).Draw(0.6).Rest(0.5).Draw(0.2).Rest(1.0);
  rows.Flag(kPressure, 500, quality::kSpike)
      .Flag(kOil, 600, quality::kMissing)
      .Step(1000, 0.05, quality::kGap);
  const Heard whole = Hear(rows.block(), rows.rows());
  ASSERT_GE(whole.strokes.size(), 2u);
  for (std::size_t size : {1, 7, 1024}) {
    const Heard cut = Hear(rows.block(), size);
    EXPECT_EQ(cut.pieces, whole.pieces) << size;
    ASSERT_EQ(cut.strokes.size(), whole.strokes.size());
    for (std::size_t k = 0; k < cut.strokes.size(); ++k) {
      EXPECT_EQ(cut.strokes[k].begin, whole.strokes[k].begin);
      EXPECT_EQ(cut.strokes[k].end, whole.strokes[k].end);
      EXPECT_EQ(cut.strokes[k].conditions, whole.strokes[k].conditions);
      EXPECT_EQ(cut.strokes[k].counters.used, whole.strokes[k].counters.used);
      EXPECT_EQ(cut.strokes[k].counters.flagged, whole.strokes[k].counters.flagged);
    }
  }
}

TEST(StrokeSegmenter, FindsTheStrokesWithTheirTimesAndSpeeds) {
  Motion rows;
  rows.Rest(0.5).Draw(1.0).Rest(0.5).Draw(2.0).Rest(0.5);
  const Heard heard = Hear(rows);
  ASSERT_EQ(heard.strokes.size(), 2u);
  EXPECT_NEAR(heard.strokes[0].begin, 0.5, 0.05);
  EXPECT_NEAR(heard.strokes[0].end, 1.5, 0.05);
  EXPECT_NEAR(heard.strokes[1].begin, 2.0, 0.05);
  EXPECT_NEAR(heard.strokes[1].end, 4.0, 0.05);
  EXPECT_EQ(heard.strokes[0].index, 0);
  EXPECT_EQ(heard.strokes[1].index, 1);
  EXPECT_NEAR(heard.strokes[1].conditions[0], 0.05, 0.002);  // speed
  EXPECT_NEAR(heard.strokes[1].conditions[1], 80e5, 0.1e5);  // pressure
  EXPECT_NEAR(heard.strokes[1].conditions[2], 80e5, 1e5);    // its largest
  EXPECT_NEAR(heard.strokes[1].oil_temperature, 313.15, 1e-9);
}

TEST(StrokeSegmenter, EveryRowIsCountedOnce) {
  Motion rows;
  rows.Rest(0.5).Draw(1.0).Rest(0.5).Draw(1.0).Rest(0.3);
  const Heard heard = Hear(rows);
  EXPECT_EQ(heard.totals.samples, static_cast<std::int64_t>(rows.rows()));
  std::int64_t used = 0;
  for (const auto& piece : heard.pieces) used += piece.samples - (piece.continues ? 1 : 0);
  EXPECT_EQ(heard.totals.used, used);
  EXPECT_GT(used, 800);
  EXPECT_LE(used, heard.totals.gated);
}

TEST(StrokeSegmenter, PiecesOfASegmentShareOneSample) {
  Motion rows;
  rows.Rest(0.5).Draw(1.5).Rest(0.5);
  const Heard heard = Hear(rows);
  ASSERT_GE(heard.pieces.size(), 3u);
  EXPECT_FALSE(heard.pieces[0].continues);
  for (std::size_t k = 1; k < heard.pieces.size(); ++k) {
    ASSERT_TRUE(heard.pieces[k].continues);
    EXPECT_EQ(heard.pieces[k].pressure.front(), heard.pieces[k - 1].pressure.back());
    EXPECT_EQ(heard.pieces[k].position.front(), heard.pieces[k - 1].position.back());
    EXPECT_NEAR(heard.pieces[k].begin, heard.pieces[k - 1].begin + 0.4, 1e-9);
  }
}

TEST(StrokeSegmenter, PiecesKnowWhatWasMeasuredBeyondTheirEndsUpToABadValue) {
  constexpr std::size_t kBad = 900;
  Motion rows;
  rows.Rest(0.5).Draw(1.0).Rest(0.1).Draw(1.0).Rest(0.5);
  rows.Flag(kPressure, kBad, quality::kSpike);
  const Heard heard = Hear(rows);
  ASSERT_GE(heard.pieces.size(), 4u);
  const auto& p = rows.block().signal[kPressure];
  int cut_short = 0;
  for (const Heard::Piece& piece : heard.pieces) {
    const auto first =
        static_cast<std::size_t>(std::lround(piece.begin / kGatePeriod)) - piece.continues - piece.before;
    const std::size_t last = first + piece.known.size() - 1;
    EXPECT_EQ(piece.known, std::vector<double>(p.begin() + first, p.begin() + last + 1)) << piece.begin;
    EXPECT_TRUE(last < kBad || first > kBad) << piece.begin;
    if (piece.before == 20 && piece.after == 20) continue;
    ++cut_short;
    EXPECT_TRUE(kBad - last <= 20 || first - kBad <= 20) << piece.begin;
  }
  EXPECT_EQ(cut_short, 2);
}

TEST(StrokeSegmenter, ABadValueEndsTheSegmentAndIsCounted) {
  for (Quality flag : {quality::kMissing, quality::kSpike, quality::kStuck, quality::kOutOfRange}) {
    Motion rows;
    rows.Rest(0.5).Draw(1.5).Rest(0.5);
    rows.Flag(kPressure, 600, flag);
    rows.block().signal[kPressure][600] = std::numeric_limits<double>::quiet_NaN();
    const Heard heard = Hear(rows);
    ASSERT_EQ(heard.strokes.size(), 1u) << flag;  // the stroke goes on, the segment does not
    EXPECT_EQ(Flagged(heard, flag), 1);
    int segments = 0;
    for (const auto& piece : heard.pieces) {
      segments += !piece.continues;
      for (double p : piece.pressure) EXPECT_TRUE(std::isfinite(p));
      const double end = piece.begin + (piece.samples - (piece.continues ? 1.5 : 0.5)) * kGatePeriod;
      EXPECT_FALSE(piece.begin <= 1.2 && end > 1.2)
          << "the piece from " << piece.begin << " s holds the bad row";
    }
    EXPECT_EQ(segments, 2);
  }
}

TEST(StrokeSegmenter, ABadValueInAChannelTheModelDoesNotNeedIsCountedOnly) {
  Motion good, bad;
  good.Rest(0.5).Draw(1.5).Rest(0.5);
  bad.Rest(0.5).Draw(1.5).Rest(0.5);
  bad.Flag(kOil, 600, quality::kMissing);
  const Heard a = Hear(good), b = Hear(bad);
  EXPECT_EQ(a.pieces, b.pieces);
  EXPECT_EQ(Flagged(b, quality::kMissing), 1);
}

TEST(StrokeSegmenter, AGapRestartsTheBlockGridAtTheRowBehindIt) {
  Motion rows;
  rows.Rest(0.5).Draw(1.5).Rest(0.5);
  rows.Step(603, 0.1, quality::kGap);
  const Heard heard = Hear(rows);
  ASSERT_EQ(heard.strokes.size(), 1u);
  EXPECT_EQ(Flagged(heard, quality::kGap), 4);  // once per channel
  bool found = false;
  for (const auto& piece : heard.pieces)
    found = found || (!piece.continues && std::abs(piece.begin - (603 * kGatePeriod + 0.1)) < 1e-9);
  EXPECT_TRUE(found);
}

/// A row that repeats another one is no row: nothing begins with it.
TEST(StrokeSegmenter, NoSegmentBeginsWithACopiedRow) {
  Motion rows;
  rows.Rest(0.5).Draw(1.5).Rest(0.5);
  rows.Step(603, 0, quality::kDuplicate);
  const Heard heard = Hear(rows);
  ASSERT_EQ(heard.strokes.size(), 1u);
  bool found = false;
  for (const auto& piece : heard.pieces)
    found = found || (!piece.continues && std::abs(piece.begin - 604 * kGatePeriod) < 1e-9);
  EXPECT_TRUE(found);
}

TEST(StrokeSegmenter, ALongGapAndAClockJumpEndTheStroke) {
  for (double by : {2.0, 3600.0, -3600.0}) {
    Motion rows;
    rows.Rest(0.5).Draw(2.0).Rest(0.5);
    rows.Step(700, by, by > 10 ? quality::kClockJump : by > 0 ? quality::kGap : quality::kTimeBackwards);
    const Heard heard = Hear(rows);
    ASSERT_EQ(heard.strokes.size(), 2u) << by;
    EXPECT_NEAR(heard.strokes[0].end, 1.4, 0.05);
    EXPECT_NEAR(heard.strokes[1].begin, 1.4 + by, 0.05);
    for (const auto& stroke : heard.strokes) EXPECT_LT(std::abs(stroke.end - stroke.begin), 1.2) << by;
  }
}

TEST(StrokeSegmenter, AShortPauseDoesNotEndAStrokeALongOneDoes) {
  Motion close, apart;
  close.Rest(0.5).Draw(1.0).Rest(0.15).Draw(1.0).Rest(0.5);
  apart.Rest(0.5).Draw(1.0).Rest(0.40).Draw(1.0).Rest(0.5);
  EXPECT_EQ(Hear(close).strokes.size(), 1u);
  EXPECT_EQ(Hear(apart).strokes.size(), 2u);
}

TEST(StrokeSegmenter, AShortStrokeIsDiscardedAndCounted) {
  Motion rows;
  rows.Rest(0.5).Draw(0.2).Rest(0.5).Draw(1.0).Rest(0.5);
  const Heard heard = Hear(rows);
  ASSERT_EQ(heard.strokes.size(), 1u);
  EXPECT_EQ(heard.discarded, 1);
  EXPECT_EQ(heard.discard_calls, 1);
  EXPECT_NEAR(heard.strokes[0].begin, 1.2, 0.05);
  EXPECT_EQ(heard.strokes[0].index, 0);
  EXPECT_EQ(heard.totals.used, heard.strokes[0].counters.used);  // nothing of the short one
}

TEST(StrokeSegmenter, AStrokeThatLastsTooLongIsCutIntoEpisodes) {
  Machine machine = TestMachine();
  machine.gate.max_stroke = 1.0;
  Motion rows;
  rows.Rest(0.5).Draw(3.5).Rest(0.5);
  const Heard heard = Hear(rows.block(), 1024, machine);
  ASSERT_EQ(heard.strokes.size(), 4u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(heard.strokes[i].end - heard.strokes[i].begin, 1.0, 0.03);
    EXPECT_NEAR(heard.strokes[i + 1].begin, heard.strokes[i].end, 1e-9);
  }
  EXPECT_EQ(heard.totals.gated, Hear(rows).totals.gated) << "no row is lost where an episode ends";
}

TEST(StrokeSegmenter, ALogWithoutConditionsIsCutIntoEpisodesFromItsFirstRowToItsLast) {
  Machine machine = TestMachine();
  machine.gate.bounds.clear();
  machine.gate.max_stroke = 0.5;
  Motion rows;
  rows.Rest(1.0).Draw(1.0);
  const Heard heard = Hear(rows.block(), 1024, machine);
  EXPECT_EQ(heard.strokes.size(), 4u);
  EXPECT_EQ(heard.totals.gated, 1000);
}

/// Motion in motion with a fifth signal, a counter that goes on every `cycle` rows.
SampleBlock Counted(Motion& rows, std::size_t cycle) {
  SampleBlock block = rows.block();
  block.signal.emplace_back();
  block.quality.emplace_back(block.rows(), quality::kGood);
  for (std::size_t k = 0; k < block.rows(); ++k)
    block.signal.back().push_back(41.0 + static_cast<double>(k / cycle));
  return block;
}

Machine MachineWithCounter() {
  Machine machine = TestMachine();
  machine.signals.push_back(machine.signals.back());
  machine.signals.back().name = machine.episode_marker = "cycle";
  return machine;
}

TEST(StrokeSegmenter, AStrokeEndsAndTheNextBeginsWhereTheMarkerChanges) {
  Motion rows;
  rows.Draw(4.0);
  const std::size_t cycle = 503;  // in the middle of blocks
  const Machine machine = MachineWithCounter();
  SampleBlock block = Counted(rows, cycle);
  block.signal.back()[700] = std::numeric_limits<double>::quiet_NaN();  // no reading is no change
  block.quality.back()[700] = quality::kMissing;
  const Heard heard = Hear(block, 1024, machine);
  ASSERT_EQ(heard.strokes.size(), 4u);
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_NEAR(heard.strokes[i].begin, static_cast<double>(i * cycle) * kGatePeriod, 1e-9) << i;
  EXPECT_EQ(heard.totals.samples, 2000);
  for (const std::size_t size : {1, 7, 503})
    EXPECT_EQ(Hear(block, size, machine).pieces, heard.pieces) << size;
  Machine without = machine;
  without.episode_marker = "";
  EXPECT_EQ(Hear(block, 1024, without).strokes.size(), 1u);
}

TEST(StrokeSegmenter, AMarkerThatChangesOnAFlaggedRowEndsTheStrokeThere) {
  Motion rows;
  rows.Draw(2.0);
  rows.Flag(kOil, 503, quality::kSpike);
  const Heard heard = Hear(Counted(rows, 503), 1024, MachineWithCounter());
  ASSERT_EQ(heard.strokes.size(), 2u);
  EXPECT_NEAR(heard.strokes[1].begin, 503 * kGatePeriod, 1e-9);
}

TEST(StrokeSegmenter, RatesOfTheGateAreTakenOverTheWindowOfFlows) {
  Motion rows;
  rows.Draw(3.0);
  for (std::size_t k = 0; k < rows.rows(); ++k)  // stops and goes three times a second
    rows.block().signal[kZ][k] += 0.004 * std::sin(2 * std::acos(-1.0) * 3 * rows.block().time[k]);
  WindowSamples wide;
  wide.half_window = 16;  // 0.32 s
  const Heard narrow = Hear(rows.block(), 1024), steady = Hear(rows.block(), 1024, TestMachine(), wide);
  EXPECT_LT(narrow.totals.gated, 0.8 * static_cast<double>(rows.rows()));
  EXPECT_GT(steady.totals.gated, 0.95 * static_cast<double>(rows.rows()));
}

/// A force balance of the user's own whose expressions do not read the oil temperature.
Machine OwnMachine() {
  const auto machine = ParseMachine(R"toml(
[machine]
name = "own"
[log]
time = { column = "t", unit = "s" }
[signals]
p_A = { column = "p", unit = "Pa" }
z = { column = "z", unit = "m" }
y_v = { column = "y", unit = "1" }
T_oil = { column = "T", unit = "K", required = false }
[gate]
conditions = { "ddt(z)" = { max = -0.004 } }
[balance]
output = "p_A"
unit = "Pa"
terms = { a = "y_v" }
)toml",
                                    "own.toml");
  EXPECT_TRUE(machine) << (machine ? "" : machine.error().text);
  return machine.value_or(Machine{});
}

TEST(StrokeSegmenter, TheOilTemperatureIsKeptAlsoWhereNoExpressionReadsIt) {
  Motion rows;
  rows.Rest(0.5).Draw(1.0).Rest(0.5);
  rows.Flag(kOil, 400, quality::kMissing);
  rows.block().signal[kOil][400] = std::numeric_limits<double>::quiet_NaN();
  std::vector<StrokeSummary> strokes;
  const Machine machine = OwnMachine();
  StrokeSegmenter segmenter(
      machine, *BuildModel(machine), WindowSamples{},
      {[](Stretch&, double) {}, [&](const StrokeSummary& s) { strokes.push_back(s); }, [] {}});
  segmenter.Process(rows.block());
  segmenter.Finish();
  ASSERT_EQ(strokes.size(), 1u);
  EXPECT_NEAR(strokes[0].oil_temperature, 313.15, 1e-9);
}

TEST(WindowSamples, SayWhatTheyTakeLargerThanAskedFor) {
  const WindowSpec asked{.block = 0.02, .span = 0.56, .half_width = 0.04};
  EXPECT_TRUE(WindowSamples::Clamps(asked, 0.002).empty());
  const auto said = WindowSamples::Clamps(asked, 0.05);
  ASSERT_EQ(said.size(), 3u);
  EXPECT_EQ(
      said[0].english,
      "rows are far apart: block = 0.02 s of [window] is taken as 0.2 s, since a block holds at least four rows");
  EXPECT_EQ(
      said[0].german,
      "Die Zeilen liegen weit auseinander: block = 0,02 s aus [window] gilt als 0,2 s, denn ein Block hat "
      "mindestens vier Zeilen");
}

TEST(StrokeSegmenter, TheGateMayLookAtASignalTheModelDoesNotRead) {
  Machine machine = TestMachine();
  machine.gate.bounds = {{"T_oil", false, 300.0, std::nullopt}, {"z", true, std::nullopt, -0.004}};
  Motion rows;
  rows.Rest(0.5).Draw(1.0).Rest(0.5);
  rows.Flag(kOil, 400, quality::kMissing);
  const Heard heard = Hear(rows.block(), 1024, machine);
  EXPECT_EQ(heard.strokes.size(), 1u);
  const auto begins = [](const Heard::Piece& piece) { return !piece.continues; };
  EXPECT_EQ(std::count_if(heard.pieces.begin(), heard.pieces.end(), begins), 2);
}

TEST(StrokeSegmenter, ALogThatEndsInsideAStrokeKeepsTheWholeBlocksOfIt) {
  Motion rows;
  rows.Rest(0.5).Draw(1.0);
  const Heard heard = Hear(rows);
  ASSERT_EQ(heard.strokes.size(), 1u);
  EXPECT_NEAR(heard.strokes[0].end, 1.5, 0.021);
}

}  // namespace
}  // namespace hydroscope
