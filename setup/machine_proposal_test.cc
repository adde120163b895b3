#include "setup/machine_proposal.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <random>

#include "setup/column_meaning.h"
#include "setup/press_log_fixture.h"

namespace hydroscope {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// column, unit of a signal of a proposed machine, e.g. "Weg mm".
std::string ColumnOf(const Machine& machine, const std::string& signal) {
  const int index = machine.SignalIndex(signal);
  if (index < 0) return "none";
  return machine.signals[index].column + " " + machine.signals[index].unit;
}

void ExpectColumns(const Machine& machine, const std::map<std::string, std::string>& columns) {
  for (const auto& [signal, column] : columns) EXPECT_EQ(ColumnOf(machine, signal), column) << signal;
}

std::string SiRow(const PressRow& r) {
  return fmt::format("{:.4f},{:.0f},{:.0f},{:.0f},{:.7f},{:.7f},{:.6f},{:.3f}", r.t, r.p_A, r.p_B, r.p_0, r.z,
                     r.y_v, r.U_v, r.T_oil - 273.15);
}

/// A press whose spool follows its command by three rows, both in volts of a card, in this order.
std::string CardLog(bool spool_first) {
  const std::vector<PressRow> rows = PressRows();
  std::string text = "Zeit [s],pA [bar],Weg [mm],AI_0,AI_1\n";
  for (std::size_t i = 3; i < rows.size(); ++i) {
    const double spool = 10 * rows[i - 3].y_v, command = 0.97 * rows[i].U_v;  // which spans less
    text += fmt::format("{:.4f},{:.3f},{:.4f},{:.4f},{:.4f}\n", rows[i].t, rows[i].p_A / 1e5, 1e3 * rows[i].z,
                        spool_first ? spool : command, spool_first ? command : spool);
  }
  return text;
}

/// Inches, °F and what the head of a table writes behind a stroke.
TEST(MachineProposal, UnitsOfOtherCountriesAndOfTablesAreTaken) {
  const std::string inches = PressLog(
      "Time (s),Pressure A (psi),Supply (psi),Position (in),Spool (%),Oil temp (°F)\n",
      [](const PressRow& r) {
        return fmt::format("{:.4f},{:.2f},{:.2f},{:.5f},{:.3f},{:.2f}", r.t, r.p_A / 6894.757,
                           r.p_0 / 6894.757, r.z / 0.0254, 100 * r.y_v, (r.T_oil - 273.15) * 1.8 + 32);
      });
  const std::string table = PressLog("t/s,p_A/MPa,p_0/MPa,z/m,y_v/1,T_oil/K\n", [](const PressRow& r) {
    return fmt::format("{:.4f},{:.5f},{:.5f},{:.6f},{:.5f},{:.2f}", r.t, r.p_A / 1e6, r.p_0 / 1e6, r.z, r.y_v,
                       r.T_oil);
  });
  ExpectColumns(Propose(inches).machine, {{"p_A", "Pressure A (psi) psi"},
                                          {"p_0", "Supply (psi) psi"},
                                          {"z", "Position (in) in"},
                                          {"y_v", "Spool (%) %"},
                                          {"T_oil", "Oil temp (°F) °F"}});
  ExpectColumns(Propose(table).machine, {{"p_A", "p_A/MPa MPa"},
                                         {"p_0", "p_0/MPa MPa"},
                                         {"z", "z/m m"},
                                         {"y_v", "y_v/1 1"},
                                         {"T_oil", "T_oil/K K"}});
}

/// A unit nobody here knows is not taken for the one that the size of the numbers suggests without a word.
TEST(MachineProposal, AUnitThatIsNotKnownIsToBeLookedAt) {
  const MachineProposal proposal =
      Propose(PressLog("t [s],p_A [bar],z [furlong],y_v\n", [](const PressRow& r) {
        return fmt::format("{:.4f},{:.3f},{:.5f},{:.5f}", r.t, r.p_A / 1e5, r.z / 0.0254, r.y_v);
      }));
  const auto position = std::ranges::find(proposal.columns, "z", &ProposedColumn::signal);
  ASSERT_NE(position, proposal.columns.end());
  EXPECT_FALSE(position->sure);
  EXPECT_THAT(position->why.english, HasSubstr("\"furlong\" in the header"));
}

TEST(MachineProposal, TellsTheSpoolFromItsCommandByWhichFollows) {
  ExpectColumns(Propose(CardLog(true)).machine, {{"y_v", "AI_0 1"}, {"U_v", "AI_1 V"}});
  ExpectColumns(Propose(CardLog(false)).machine, {{"y_v", "AI_1 1"}, {"U_v", "AI_0 V"}});
}

TEST(MachineProposal, ASpoolThatOpensFiveFoldIsInAnotherUnit) {
  const std::string rows = PressLog("t,p_A,z,y_v [1],U_v\n", [](const PressRow& r) {
    return fmt::format("{:.4f},{:.0f},{:.7f},{:.5f},{:.6f}", r.t, r.p_A, r.z, 10 * r.y_v, r.U_v);
  });
  const MachineProposal proposal = Propose(rows);
  for (const ProposedColumn& column : proposal.columns)
    if (column.signal == "y_v") {
      EXPECT_FALSE(column.sure);
      EXPECT_THAT(column.why.english, HasSubstr("are no opening of a spool"));
    }
}

TEST(MachineProposal, RecognisesTheExamplePressCompletely) {
  const MachineProposal proposal = Propose(PressLog("t,p_A,p_B,p_0,z,y_v,U_v,T_oil\n", SiRow));
  const Machine& m = proposal.machine;
  EXPECT_EQ(m.model, "die_cushion");
  EXPECT_EQ(m.log.time_column + " " + m.log.time_unit, "t s");
  ExpectColumns(m, {{"p_A", "p_A Pa"},
                    {"p_B", "p_B Pa"},
                    {"p_0", "p_0 Pa"},
                    {"z", "z m"},
                    {"y_v", "y_v 1"},
                    {"U_v", "U_v V"},
                    {"T_oil", "T_oil degC"}});
  for (const ProposedColumn& column : proposal.columns)
    EXPECT_TRUE(column.sure) << column.signal << ": " << column.why.english;
  EXPECT_THAT(proposal.open, IsEmpty());
  EXPECT_THAT(InEnglish(proposal.decided), Contains(HasSubstr("z falls while the pressure is high")));
  ExpectLoads(proposal);
}

TEST(MachineProposal, RecognisesAGermanLogInPlantUnits) {
  const MachineProposal proposal = Propose(PressLog(
      "Zeit [ms];Druck A [bar];Druck B [bar];Systemdruck [bar];Weg [mm];Schieberstellung [%];Ventilspannung "
      "[V];Öltemperatur [°C]\n",
      [](const PressRow& r) {
        std::string line =
            fmt::format("{:.0f};{:.2f};{:.2f};{:.2f};{:.3f};{:.3f};{:.3f};{:.2f}", r.t * 1e3, r.p_A / 1e5,
                        r.p_B / 1e5, r.p_0 / 1e5, r.z * 1e3, r.y_v * 100, r.U_v, r.T_oil - 273.15);
        for (char& c : line)
          if (c == '.') c = ',';
        return line;
      }));
  const Machine& m = proposal.machine;
  EXPECT_EQ(m.model, "die_cushion");
  EXPECT_EQ(m.log.time_column + " " + m.log.time_unit, "Zeit [ms] ms");
  ExpectColumns(m, {{"p_A", "Druck A [bar] bar"},
                    {"p_B", "Druck B [bar] bar"},
                    {"p_0", "Systemdruck [bar] bar"},
                    {"z", "Weg [mm] mm"},
                    {"y_v", "Schieberstellung [%] %"},
                    {"U_v", "Ventilspannung [V] V"},
                    {"T_oil", "Öltemperatur [°C] °C"}});
  ExpectLoads(proposal);
}

TEST(MachineProposal, FindsUnitsByTheSizeOfTheNumbers) {
  const MachineProposal proposal =
      Propose(PressLog("time,pressure_A,pressure_B,position,spool,command,oil_temp\n", [](const PressRow& r) {
        return fmt::format("{:.0f},{:.4f},{:.4f},{:.3f},{:.3f},{:.3f},{:.2f}", r.t * 1e3, r.p_A / 1e6,
                           r.p_B / 1e6, r.z * 1e3, r.y_v * 100, r.U_v, r.T_oil);
      }));
  const Machine& m = proposal.machine;
  EXPECT_EQ(m.log.time_unit, "ms");
  ExpectColumns(
      m, {{"p_A", "pressure_A MPa"}, {"z", "position mm"}, {"y_v", "spool %"}, {"T_oil", "oil_temp K"}});
  ExpectLoads(proposal);
}

TEST(MachineProposal, RecognisesColumnsWithoutNamesByTheirBehaviour) {
  const MachineProposal proposal = Propose(PressLog("", SiRow));
  const Machine& m = proposal.machine;
  EXPECT_EQ(m.model, "die_cushion");
  EXPECT_EQ(m.log.header, false);
  EXPECT_EQ(m.log.time_column + " " + m.log.time_unit, "1 s");
  ExpectColumns(m, {{"p_A", "2 Pa"},
                    {"p_B", "3 Pa"},
                    {"p_0", "4 Pa"},
                    {"z", "5 m"},
                    {"y_v", "6 1"},
                    {"U_v", "7 V"},
                    {"T_oil", "8 degC"}});
  EXPECT_THAT(proposal.text, HasSubstr("<-- check"));
  ExpectLoads(proposal);
}

TEST(MachineProposal, TurnsSignalsThatRunTheOtherWayRound) {
  const MachineProposal proposal = Propose(PressLog("t,p_A,z,y_v\n", [](const PressRow& r) {
    return fmt::format("{:.4f},{:.0f},{:.6f},{:.6f}", r.t, r.p_A, 0.25 - r.z, -r.y_v);
  }));
  const Machine& m = proposal.machine;
  EXPECT_EQ(m.signals[m.SignalIndex("z")].scale, -1);
  EXPECT_GT(m.signals[m.SignalIndex("z")].offset, 0.15);
  EXPECT_EQ(m.signals[m.SignalIndex("y_v")].scale, -1);
  EXPECT_THAT(InEnglish(proposal.decided), Contains(HasSubstr("z rises while the pressure is high")));
  ExpectLoads(proposal);
}

TEST(MachineProposal, SaysWhenAChamberStandsAboveItsSupply) {
  const auto says_so = [](const char* header) {
    const MachineProposal proposal = Propose(PressLog(header, [](const PressRow& r) {
      return fmt::format("{:.3f},{:.0f},{:.0f},{:.0f},{:.5f},{:.4f}", r.t, r.p_A, r.p_B, r.p_0, r.z, r.y_v);
    }));
    return std::ranges::any_of(proposal.decided, [](const Told& line) {
      return line.english.starts_with("p_B stands above p_0 all the time");
    });
  };
  EXPECT_TRUE(says_so("t,p_A,p_0,p_B,z,y_v\n"));
  EXPECT_FALSE(says_so("t,p_A,p_B,p_0,z,y_v\n"));
}

TEST(MachineProposal, MarksThePistonAreaAsToBeFilledIn) {
  const MachineProposal proposal = Propose(PressLog("t,p_A,p_B,p_0,z,y_v,U_v,T_oil\n", SiRow), 0);
  EXPECT_THAT(InEnglish(proposal.open), ElementsAre(HasSubstr("A_A")));
  EXPECT_THAT(proposal.text, HasSubstr("<-- FILL IN the piston area"));
  const auto refused = ParseMachine(proposal.text, "log.toml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, HasSubstr("A_A is missing"));
  std::string filled = proposal.text;
  filled.erase(filled.find("# A_A ="), 2);
  const auto machine = ParseMachine(filled, "log.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  EXPECT_DOUBLE_EQ(machine->Geometry("A_A")->value, 0.0125);
}

TEST(MachineProposal, TakesCommandAndSpoolAloneForAValveSweep) {
  std::string text = "t,U_v,y_v\n";
  for (int i = 0; i < 2000; ++i)
    text += fmt::format("{:.4f},{:.5f},{:.6f}\n", i * 1e-3, 0.5 * std::sin(0.3 * i),
                        0.05 * std::sin(0.3 * i - 0.4));
  const MachineProposal proposal = Propose(text);
  EXPECT_EQ(proposal.machine.model, "valve");
  EXPECT_EQ(ColumnOf(proposal.machine, "U_v"), "U_v V");
  EXPECT_EQ(ColumnOf(proposal.machine, "y_v"), "y_v 1");
  EXPECT_EQ(proposal.machine.signals[0].scale, 1);
  EXPECT_THAT(proposal.open, IsEmpty());
  ExpectLoads(proposal);
}

TEST(MachineProposal, TellsVoltsFromShareOfFullCommandByTheSpool) {
  for (const auto& [per_opening, scale] :
       {std::pair(10.0, 1.0), std::pair(1.0, 10.0), std::pair(100.0, 0.1)}) {
    std::string text = "t,U_v,y_v\n";
    for (int i = 0; i < 2000; ++i)
      text += fmt::format("{:.4f},{:.5f},{:.6f}\n", i * 1e-3, 0.05 * per_opening * std::sin(0.3 * i),
                          0.05 * std::sin(0.3 * i - 0.4));
    EXPECT_EQ(Propose(text).machine.signals[0].scale, scale) << per_opening;
  }
}

TEST(MachineProposal, ProposesABalanceWhereForceAndPressureAreThere) {
  std::string text = "Zeit,Kraft [N],Druck [bar],Weg [mm]\n";
  for (int i = 0; i < 500; ++i)
    text += fmt::format("{:.2f},{:.2f},{:.3f},{:.3f}\n", i * 0.01, 150 + std::sin(0.05 * i),
                        3 + 0.01 * std::sin(0.2 * i), 20 + 10 * std::sin(0.05 * i));
  const MachineProposal proposal = Propose(text);
  EXPECT_EQ(proposal.machine.model, "expressions");
  EXPECT_EQ(proposal.machine.balance.output, "F");
  EXPECT_EQ(proposal.machine.user_effects.size(), 3u);
  ExpectLoads(proposal);
}

TEST(MachineProposal, KeepsEveryColumnOfAnUnknownMachineAndAsksForItsBalance) {
  std::string text = "t,torque (Nm),n-motor\n";
  for (int i = 0; i < 100; ++i) text += fmt::format("{:.3f},{},{}\n", i * 0.001, 5 + i % 7, 100 + i % 3);
  const MachineProposal proposal = Propose(text);
  EXPECT_EQ(proposal.machine.model, "expressions");
  EXPECT_EQ(ColumnOf(proposal.machine, "nmotor"), "n-motor 1");
  EXPECT_THAT(InEnglish(proposal.open), Contains(HasSubstr("[balance]")));
  EXPECT_THAT(proposal.text, HasSubstr("# [balance]"));
}

TEST(MachineProposal, UnitsOfAnUnknownMachineAreTakenFromTheEndOfItsNamesToo) {
  std::string text = "Zeit_s;Drehmoment_Nm;Drehzahl_1/min;Öl_°C;x_min\n";
  for (int i = 0; i < 100; ++i)
    text += fmt::format("{:.3f};{};{};{};{}\n", i * 0.001, 5 + i % 7, 100 + i % 3, 40 + i % 2, i % 11);
  const Machine m = Propose(text).machine;
  ExpectColumns(
      m, {{"Drehmoment", "Drehmoment_Nm Nm"}, {"Drehzahl", "Drehzahl_1/min 1/min"}, {"Oel", "Öl_°C °C"}});
  EXPECT_EQ(ColumnOf(m, "x_min"), "x_min 1") << "the least of something, as likely as minutes";
}

TEST(MachineProposal, NeverTakesACoarseSignalForStuck) {
  const MachineProposal proposal = Propose(PressLog("t,p_A,z,y_v\n", [](const PressRow& r) {
    return fmt::format("{:.4f},{:.0f},{:.3f},{:.6f}", r.t, r.p_A, r.z, r.y_v);
  }));
  const Machine& m = proposal.machine;
  EXPECT_EQ(m.signals[m.SignalIndex("z")].stuck_time, 0);
  EXPECT_GT(m.signals[m.SignalIndex("p_A")].stuck_time, 0);
}

TEST(MachineProposal, ReadsALatin1HeaderAndTakesTheFirstOfTwoNames) {
  const MachineProposal proposal =
      Propose(PressLog("t,p_A,Stellung,y_v,\xd6ltemp,Stellung\n", [](const PressRow& r) {
        return fmt::format("{:.4f},{:.0f},{:.6f},{:.6f},{:.2f},{:.6f}", r.t, r.p_A, r.z, r.y_v,
                           r.T_oil - 273.15, r.z);
      }));
  EXPECT_EQ(ColumnOf(proposal.machine, "z"), "Stellung m");
  EXPECT_EQ(ColumnOf(proposal.machine, "T_oil"), "Öltemp degC");
  ExpectLoads(proposal);
}

TEST(MachineProposal, SaysWhenTheLogIsTooSlow) {
  std::string text = "t,U_v,y_v\n";
  for (int i = 0; i < 100; ++i)
    text += fmt::format("{},{:.3f},{:.4f}\n", i * 0.1, std::sin(i), 0.1 * std::sin(i - 1));
  EXPECT_THAT(InEnglish(Propose(text).open), Contains(HasSubstr("10 rows per second")));
}

TEST(MachineProposal, TakesUnitsFromTheEndOfNames) {
  const MachineProposal proposal =
      Propose(PressLog("t_ms,pA_bar,pB_bar,p0_bar,s_mm,y_v,U_v,T_oil_C\n", [](const PressRow& r) {
        return fmt::format("{:.0f},{:.3f},{:.3f},{:.3f},{:.4f},{:.6f},{:.5f},{:.2f}", r.t * 1e3, r.p_A / 1e5,
                           r.p_B / 1e5, r.p_0 / 1e5, r.z * 1e3, r.y_v, r.U_v, r.T_oil - 273.15);
      }));
  const Machine& m = proposal.machine;
  EXPECT_EQ(m.log.time_column + " " + m.log.time_unit, "t_ms ms");
  ExpectColumns(m, {{"p_A", "pA_bar bar"}, {"p_B", "pB_bar bar"}, {"z", "s_mm mm"}});
  EXPECT_EQ(ColumnOf(m, "y_v"), "y_v 1") << "no volt";
  EXPECT_EQ(ColumnOf(m, "T_oil"), "T_oil_C degC");
  ExpectLoads(proposal);
}

TEST(MachineProposal, TakesCurrentLoopsForAGuess) {
  const auto loop = [](double share) { return 4 + 16 * share; };
  const MachineProposal proposal = Propose(PressLog("t,p_A [mA],z [mA],y_v\n", [&](const PressRow& r) {
    return fmt::format("{:.4f},{:.5f},{:.6f},{:.6f}", r.t, loop(r.p_A / 400e5), loop(r.z / 0.5), r.y_v);
  }));
  EXPECT_EQ(proposal.machine.model, "die_cushion");
  for (const ProposedColumn& column : proposal.columns) {
    if (column.signal != "p_A" && column.signal != "z") continue;
    EXPECT_FALSE(column.sure) << column.signal;
    EXPECT_THAT(column.why.english, HasSubstr("4 ... 20 mA")) << column.signal;
  }
  ExpectLoads(proposal);
}

/// Columns of which neither name nor motion tells what they are, in mA of transmitters.
TEST(MachineProposal, BareCurrentLoopsAreToBeFilledIn) {
  const auto loop = [](double share) { return 4 + 16 * share; };
  const MachineProposal proposal = Propose(PressLog("t,AI_0,AI_1,AI_2\n", [&](const PressRow& r) {
    return fmt::format("{:.4f},{:.4f},{:.4f},{:.4f}", r.t, loop(r.p_A / 400e5), loop(0.5 + r.y_v / 2),
                       loop(0.4));
  }));
  for (const char* name : {"AI_0", "AI_1", "AI_2"}) {
    const SignalSpec& spec = proposal.machine.signals[proposal.machine.SignalIndex(name)];
    EXPECT_DOUBLE_EQ(4 * spec.scale + spec.offset, 0) << name;
    EXPECT_DOUBLE_EQ(20 * spec.scale + spec.offset, 1) << name;
  }
  EXPECT_THAT(proposal.text, HasSubstr("<-- FILL IN its unit, scale and offset"));
  EXPECT_THAT(proposal.text,
              HasSubstr("TO DO BY YOU: [signals], lines marked FILL IN: the columns look like 4 ... 20 mA"));
  // Numbers beyond are none.
  const MachineProposal others = Propose(PressLog("t,AI_0,AI_1\n", [&](const PressRow& r) {
    return fmt::format("{:.4f},{:.4f},{:.4f}", r.t, loop(r.p_A / 400e5), 30 * r.y_v);
  }));
  EXPECT_EQ(others.text.find("4 ... 20 mA"), std::string::npos) << others.text;
}

TEST(MachineProposal, GuessesColumnsWithoutTellingNamesAndSaysSo) {
  const MachineProposal proposal = Propose(PressLog("Time,AI_0,AI_1,AI_2,AI_3,AI_4\n", [](const PressRow& r) {
    return fmt::format("{:.4f},{:.3f},{:.4f},{:.5f},{:.3f},{:.4f}", r.t, r.p_0 / 1e5, r.z * 1e3, r.y_v,
                       r.p_A / 1e5, r.U_v);
  }));
  const Machine& m = proposal.machine;
  EXPECT_EQ(m.model, "die_cushion");
  ExpectColumns(m, {{"z", "AI_1 mm"}, {"y_v", "AI_2 1"}, {"p_A", "AI_3 bar"}});
  for (const ProposedColumn& column : proposal.columns) {
    const bool guessed = column.signal == "z" || column.signal == "y_v" || column.signal == "p_A";
    EXPECT_FALSE(guessed && column.sure) << column.signal;
  }
}

TEST(MachineProposal, TellsSpoolInPerCentFromCommandInVoltsAndOilFromPressure) {
  const MachineProposal proposal = Propose(PressLog(
      "Zeitstempel,AI_03,AI_07,Ist Weg Kissen,AI_11 [%],AO_02,Pumpe,\xd6lwanne\n", [](const PressRow& r) {
        return fmt::format("{:.0f},{:.2f},{:.2f},{:.2f},{:.3f},{:.3f},{:.1f},{:.1f}", r.t * 1e3, r.p_A / 1e5,
                           r.p_B / 1e5, r.z * 1e3, r.y_v * 100, r.U_v, r.p_0 / 1e5, r.T_oil - 273.15);
      }));
  ExpectColumns(proposal.machine, {{"p_A", "AI_03 bar"},
                                   {"p_B", "AI_07 bar"},
                                   {"z", "Ist Weg Kissen mm"},
                                   {"y_v", "AI_11 [%] %"},
                                   {"U_v", "AO_02 V"},
                                   {"p_0", "Pumpe bar"},
                                   {"T_oil", "Ölwanne degC"}});
  ExpectLoads(proposal);
}

TEST(MachineProposal, NoColumnIsASignalWhoseUnitItDoesNotHave) {
  std::string text = "Zeit;Drehzahl [U/min];dp [bar];P [kW];M [kNm]\n";
  for (int k = 0; k < 4000; ++k) {
    const double t = 0.01 * k, speed = 900 * std::sin(2 * t), dp = 150 * std::sin(0.7 * t);
    text += fmt::format("{:.2f};{:.2f};{:.3f};{:.4f};{:.4f}\n", t, speed, dp, dp * speed * 1e-4, dp * 2e-3);
  }
  const Machine m = Propose(text).machine;
  EXPECT_EQ(m.model, "expressions");
  ExpectColumns(m, {{"p_A", "none"},
                    {"z", "none"},
                    {"Drehzahl", "Drehzahl [U/min] U/min"},
                    {"dp", "dp [bar] bar"},
                    {"P", "P [kW] kW"},
                    {"M", "M [kNm] kNm"}});
}

/// Folder of the measured and simulated logs that come with the development data.
std::filesystem::path DataFolder() {
  const char* named = std::getenv("HYDROSCOPE_DATA");
  return named != nullptr ? std::filesystem::path(named)
                          : std::filesystem::path(HYDROSCOPE_SOURCE_DIR).parent_path() / "shared" / "data";
}

TEST(MachineProposal, ProposesForTheDevelopmentLogsWhatTheirMachineFilesSay) {
  const auto folder = DataFolder() / "press";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no development data in " << folder << "; set HYDROSCOPE_DATA";
  const auto press = LoadMachine(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/die_cushion.toml");
  ASSERT_TRUE(press);
  int logs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto head = ReadLogColumns(entry.path().string());
    ASSERT_TRUE(head) << head.error().text;
    const MachineProposal proposal = ProposeMachine(*head, {{{"A_A", 0.0125}}});
    EXPECT_EQ(proposal.machine.model, "die_cushion") << entry.path();
    for (const SignalSpec& signal : press->signals)
      EXPECT_EQ(ColumnOf(proposal.machine, signal.name), signal.column + " " + signal.unit) << entry.path();
    EXPECT_EQ(proposal.machine.geometry, press->geometry);
    EXPECT_EQ(proposal.machine.gate.bounds.size(), press->gate.bounds.size());
    ExpectLoads(proposal);
    ++logs;
  }
  EXPECT_GT(logs, 0);
}

TEST(MachineProposal, OneOfTwoColumnsOfTheSameNameIsToBeChecked) {
  const MachineProposal proposal =
      Propose(PressLog("t,p_A,p_B,p_0,z,y_v,U_v,T_oil,p_A\n",
                       [](const PressRow& r) { return SiRow(r) + fmt::format(",{:.0f}", 0.3 * r.p_A); }));
  for (const ProposedColumn& column : proposal.columns) {
    if (column.signal != "p_A") continue;
    EXPECT_FALSE(column.sure);
    EXPECT_THAT(column.why.english, HasSubstr("2 columns are called 'p_A' (2, 9): column 2 is read"));
  }
  EXPECT_THAT(proposal.text, HasSubstr("2 columns are called 'p_A'"));
}

}  // namespace
}  // namespace hydroscope
