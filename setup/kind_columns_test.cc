#include "setup/kind_columns.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "setup/machine_proposal.h"

namespace hydroscope {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// A log of `header` with 400 rows, 1 ms apart; `row` gives what follows the time.
LogColumns LogOf(const std::string& header, const std::function<std::string(double t)>& row) {
  const auto path =
      std::filesystem::path(::testing::TempDir()) /
      fmt::format("kind_{}.csv", ::testing::UnitTest::GetInstance()->current_test_info()->name());
  {
    std::ofstream file(path, std::ios::binary);
    file << header << "\n";
    for (int i = 0; i < 400; ++i) file << fmt::format("{:.3f},{}\n", 0.001 * i, row(0.001 * i));
  }
  const auto head = ReadLogColumns(path.string());
  std::filesystem::remove(path);
  if (!head) ADD_FAILURE() << head.error().text;
  return head ? *head : LogColumns{};
}

double Wave(double t, double middle, double size) { return middle + size * std::sin(20 * t); }

std::string PumpRow(double t) {
  return fmt::format("{:.3f},{:.6f},{:.0f},{:.0f},{:.6f}", Wave(t, 361, 5), Wave(t, 1e-3, 2e-4),
                     Wave(t, 2e7, 1e5), Wave(t, 3.4e6, 1e5), Wave(t, 4e-3, 1e-3));
}

/// "column unit" of a signal; "none" if it is not there.
std::string ColumnOfSignal(const MachineProposal& proposal, const std::string& signal) {
  const int index = proposal.machine.SignalIndex(signal);
  if (index < 0) return "none";
  const SignalSpec& spec = proposal.machine.signals[static_cast<std::size_t>(index)];
  return spec.column + " " + spec.unit;
}

TEST(KindColumns, APumpIsRecognisedByTheNamesOfItsColumns) {
  const MachineProposal proposal = ProposeMachine(LogOf("t,n,Q,p_s,p_c,x_p", PumpRow), {});
  EXPECT_EQ(proposal.machine.model, "pump");
  EXPECT_EQ(ColumnOfSignal(proposal, "shaft_speed"), "n rad/s");
  EXPECT_EQ(ColumnOfSignal(proposal, "load_flow"), "Q m3/s");
  EXPECT_EQ(ColumnOfSignal(proposal, "outlet_pressure"), "p_s Pa");
  EXPECT_EQ(ColumnOfSignal(proposal, "control_position"), "x_p m");
  EXPECT_EQ(proposal.machine.states.shaft, "shaft_speed") << "the ripple of the pistons is taken out";
  EXPECT_THAT(InEnglish(proposal.open), Contains(HasSubstr("D_max")));
  EXPECT_THAT(proposal.text, HasSubstr("# <-- FILL IN the value: D_max"));
}

TEST(KindColumns, AUnitOfTheHeaderIsBelieved) {
  const std::string header = "t [s],n [1/min],Q [l/min],p_s [V],p [kW],x_p [mm]";
  const MachineProposal proposal = ProposeMachine(LogOf(header, PumpRow), {});
  EXPECT_EQ(ColumnOfSignal(proposal, "shaft_speed"), "n [1/min] rpm") << "a shaft makes revolutions";
  EXPECT_EQ(ColumnOfSignal(proposal, "outlet_pressure"), "p_s [V] Pa");
  EXPECT_THAT(proposal.text, HasSubstr("V in the header: write scale and unit of the sensor  <-- check"));
  const auto power = LogOf("t [s],n [rpm],Q [l/min],P [kW],p_c [bar],x_p [mm]", PumpRow);
  EXPECT_EQ(KindByColumnNames(power), nullptr) << "a power is no pressure";
}

TEST(KindColumns, AnArmIsNoDieCushionThoughItHasPressuresAndSpools) {
  const auto log = LogOf("t,q_1,q_2,p_11,p_12,p_21,p_22,y_1,y_2,p_s", [](double t) {
    return fmt::format("{:.5f},{:.5f},{:.0f},{:.0f},{:.0f},{:.0f},{:.4f},{:.4f},{:.0f}", Wave(t, 0.3, 0.4),
                       Wave(t, -1.6, 0.4), Wave(t, 9e6, 2e6), Wave(t, 6e6, 3e6), Wave(t, 8e6, 1e6),
                       Wave(t, 1e7, 1e6), Wave(t, 0, 0.4), Wave(t, 0, 0.4), Wave(t, 1.9e7, 1e4));
  });
  const MachineProposal proposal = ProposeMachine(log, {});
  EXPECT_EQ(proposal.machine.model, "manipulator");
  EXPECT_EQ(proposal.machine.signals.size(), 9u);
}

TEST(KindColumns, ColumnsOfADieCushionByNameAreOneWhateverElseIsThere) {
  const auto log = LogOf("t,U,x_p,p_1,p_2,p_A,z,y_v", [](double t) {
    return fmt::format("{:.3f},{:.4f},{:.0f},{:.0f},{:.0f},{:.5f},{:.4f}", Wave(t, 0, 3), Wave(t, 0.4, 0.1),
                       Wave(t, 3e6, 1e6), Wave(t, 5e6, 1e6), Wave(t, 9e6, 2e6), Wave(t, 0.1, 0.05),
                       Wave(t, 0, 0.4));
  });
  EXPECT_EQ(KindByColumnNames(log)->id, "flexible_axis");
  EXPECT_EQ(ProposeMachine(log, {}).machine.model, "die_cushion");
}

TEST(KindColumns, UnitsAreThoseInWhichSizesArePlausibleForTheMachine) {
  const auto cylinder = LogOf("t,z_set,I_v,z", [](double t) {
    return fmt::format("{:.4f},{:.3f},{:.4f}", Wave(t, 0, 0.9), Wave(t, 0, 12), Wave(t, 0, 0.8));
  });
  const MachineProposal proposal = ProposeMachine(cylinder, {});
  EXPECT_EQ(ColumnOfSignal(proposal, "z"), "z mm") << "a rod that noise excites does not move by metres";
  EXPECT_EQ(ColumnOfSignal(proposal, "I_v"), "I_v mA");
  const auto pump = LogOf("t,n,Q,p_s,p_c [bar],x_p_mm", [](double t) {
    return fmt::format("{:.1f},{:.3f},{:.3f},{:.3f},{:.4f}", Wave(t, 1500, 10), Wave(t, 60, 5),
                       Wave(t, 200, 1), Wave(t, 34, 1), Wave(t, 4, 1));
  });
  const MachineProposal plant = ProposeMachine(pump, {});
  EXPECT_EQ(ColumnOfSignal(plant, "shaft_speed"), "n rpm");
  EXPECT_EQ(ColumnOfSignal(plant, "load_flow"), "Q l/min");
  EXPECT_EQ(ColumnOfSignal(plant, "control_pressure"), "p_c [bar] bar");
  EXPECT_EQ(ColumnOfSignal(plant, "control_position"), "x_p_mm mm");
}

TEST(KindColumns, AKindThatIsChosenIsTakenAndAsksForWhatIsNotThere) {
  const auto log = LogOf("t,AI_0,AI_1,AI_2,AI_3,AI_4", PumpRow);
  EXPECT_NE(ProposeMachine(log, {}).machine.model, "pump");
  const MachineProposal proposal = ProposeMachine(log, {{{"D_max", 4.6e-6}}, "pump"});
  EXPECT_EQ(proposal.machine.model, "pump");
  EXPECT_TRUE(proposal.machine.signals.empty());
  EXPECT_EQ(proposal.machine.geometry.at("D_max").value, 4.6e-6);
  EXPECT_EQ(ProposeMachine(log, {{}, "die_cushion"}).machine.model, "die_cushion")
      << "without pressure and spool";
}

TEST(KindColumns, AMachineOfOnesOwnKeepsTheNamesOfColumnsAndIsCutIntoPieces) {
  const auto log = LogOf("t,load [kN],jack pressure [bar]", [](double t) {
    return fmt::format("{:.4f},{:.4f}", Wave(t, 2, 0.5), Wave(t, 40, 10));
  });
  const MachineProposal proposal = ProposeMachine(log, {{}, "expressions"});
  EXPECT_EQ(ColumnOfSignal(proposal, "load"), "load [kN] kN");
  EXPECT_EQ(ColumnOfSignal(proposal, "jack_pressure"), "jack pressure [bar] bar");
  EXPECT_EQ(proposal.machine.gate.max_stroke, 0.5) << "what is judged by strokes left out needs several";
}

TEST(KindColumns, WhatWasDecidedAndWhatIsOpenIsToldInGermanToo) {
  for (const MachineKind* kind : KindsToChoose()) {
    const MachineProposal proposal =
        ProposeMachine(LogOf("t,n,Q,p_s,p_c,x_p", PumpRow), {{}, std::string(kind->id)});
    for (const std::vector<Told>* list : {&proposal.decided, &proposal.open})
      for (const Told& line : *list) EXPECT_FALSE(line.german.empty()) << kind->id << ": " << line.english;
  }
}

}  // namespace
}  // namespace hydroscope
