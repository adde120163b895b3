// One short test per way in which a machine file can be wrong: the message must name line, key and way out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "models/machine.h"

namespace hydroscope {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// What ParseMachine says of a file that must be refused; "accepted" if it is not.
std::string RefusalOfPress(const std::string& text) {
  const auto machine = ParseMachine(text, "press.toml");
  if (machine) return "accepted";
  EXPECT_EQ(machine.error().kind, ErrorKind::kBadInput);
  return machine.error().text;
}

/// A correct die cushion of 8 lines, with `more` from line 9 on.
std::string CushionWith(const std::string& more) {
  return "[signals]\n"
         "p_A = { column = \"pA\", unit = \"bar\" }\n"
         "z = { column = \"pos\", unit = \"mm\" }\n"
         "y_v = \"spool\"\n"
         "\n"
         "[geometry]\n"
         "A_A = 0.0125\n"
         "dp_nom = { value = 35, unit = \"bar\" }\n" +
         more;
}

/// The die cushion with `from` replaced by `to`.
std::string CushionChanged(const std::string& from, const std::string& to) {
  std::string text = CushionWith("");
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

TEST(MachineFileDamage, TheUndamagedFileIsAccepted) {
  EXPECT_EQ(RefusalOfPress(CushionWith("")), "accepted");
}

TEST(MachineFileDamage, AMissingFileIsNamed) {
  const auto machine = LoadMachine("/nowhere/press.toml");
  ASSERT_FALSE(machine);
  EXPECT_EQ(machine.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(machine.error().text,
              HasSubstr("`hydroscope init LOG --out /nowhere/press.toml` proposes one"));
}

TEST(MachineFileDamage, AFolderIsNoMachineFile) {
  EXPECT_FALSE(LoadMachine(std::filesystem::temp_directory_path().string()));
}

TEST(MachineFileDamage, ALogIsNotReadAsAMachineFile) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "huge.toml";
  std::ofstream(path) << std::string(5 << 20, '#');
  const auto machine = LoadMachine(path.string());
  std::filesystem::remove(path);
  ASSERT_FALSE(machine);
  EXPECT_THAT(machine.error().text, HasSubstr("is it a log?"));
}

TEST(MachineFileDamage, BrokenTomlNamesTheLine) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[gate\n")), AllOf(StartsWith("press.toml:9:"), HasSubstr("TOML")));
}

TEST(MachineFileDamage, ADuplicateSignalIsNamed) {
  EXPECT_THAT(RefusalOfPress("[signals]\nz = \"a\"\nz = \"b\"\n"),
              AllOf(StartsWith("press.toml:3:"), HasSubstr("'z'")));
}

TEST(MachineFileDamage, TextThatIsNoUtf8IsRefused) {
  EXPECT_THAT(RefusalOfPress("[machine]\nname = \"\xff\xfe\"\n"), StartsWith("press.toml:2:"));
}

TEST(MachineFileDamage, AnUnknownSectionSuggestsTheNearest) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[estimater]\n")),
              AllOf(StartsWith("press.toml:9:"), HasSubstr("\"estimater\""),
                    HasSubstr("did you mean \"estimator\"?")));
}

TEST(MachineFileDamage, AnUnknownKeySuggestsTheNearest) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[gate]\nmin_stoke = 1\n")),
              AllOf(StartsWith("press.toml:10: [gate]"), HasSubstr("\"min_stoke\""),
                    HasSubstr("did you mean \"min_stroke\"?")));
}

TEST(MachineFileDamage, AnUnknownKeyOfASignalSuggestsTheNearest) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("{ column = \"pA\"", "{ scael = 2, column = \"pA\"")),
              AllOf(StartsWith("press.toml:2: [signals.p_A]"), HasSubstr("did you mean \"scale\"?")));
}

TEST(MachineFileDamage, AnUnknownModelListsTheModels) {
  EXPECT_THAT(RefusalOfPress("[machine]\nmodel = \"die_cusion\"\n"),
              AllOf(StartsWith("press.toml:2: [machine] model = \"die_cusion\""), HasSubstr("\"valve\""),
                    HasSubstr("did you mean \"die_cushion\"?")));
}

TEST(MachineFileDamage, AnUnknownUnitSuggestsTheNearestUnit) {
  EXPECT_THAT(
      RefusalOfPress(CushionChanged("unit = \"bar\" }\nz", "unit = \"barr\" }\nz")),
      AllOf(StartsWith("press.toml:2: [signals.p_A] unit = \"barr\""), HasSubstr("did you mean \"bar\"?")));
}

TEST(MachineFileDamage, AUnitOfAnotherQuantityIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("value = 35, unit = \"bar\"", "value = 35, unit = \"mm\"")),
              AllOf(StartsWith("press.toml:8: [geometry.dp_nom] unit = \"mm\""),
                    HasSubstr("same quantity as Pa"), HasSubstr("MPa")));
}

TEST(MachineFileDamage, ASignalOfTheWrongQuantityIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("unit = \"mm\"", "unit = \"bar\"")),
              AllOf(StartsWith("press.toml:3: [signals] z ="), HasSubstr("position of the cushion"),
                    HasSubstr("\"bar\"")));
}

TEST(MachineFileDamage, TextInPlaceOfANumberIsRefused) {
  EXPECT_THAT(
      RefusalOfPress(CushionWith("[gate]\nmin_stroke = \"long\"\n")),
      AllOf(StartsWith("press.toml:10: [gate] min_stroke = \"long\" (text)"), HasSubstr("number in s")));
}

TEST(MachineFileDamage, ANumberInPlaceOfTextIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[machine]\nname = 7\n")),
              AllOf(StartsWith("press.toml:10: [machine] name = 7"), HasSubstr("text in quotes")));
}

TEST(MachineFileDamage, ANumberInPlaceOfTrueOrFalseIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[log]\nheader = 1\n")),
              AllOf(StartsWith("press.toml:10: [log] header = 1"), HasSubstr("true or false")));
}

TEST(MachineFileDamage, AFractionInPlaceOfAWholeNumberIsRefused) {
  EXPECT_THAT(
      RefusalOfPress(CushionWith("[estimator]\nmoving_average = 3.5\n")),
      AllOf(StartsWith("press.toml:10: [estimator] moving_average = 3.5"), HasSubstr("whole number")));
}

TEST(MachineFileDamage, InfinityIsNoNumberOfAMachine) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("A_A = 0.0125", "A_A = inf")),
              AllOf(StartsWith("press.toml:7: [geometry] A_A = inf"), HasSubstr("finite")));
}

TEST(MachineFileDamage, AValueInPlaceOfASectionIsRefused) {
  EXPECT_THAT(RefusalOfPress("window = 3\n" + CushionWith("")),
              AllOf(StartsWith("press.toml:1: window = 3"), HasSubstr("section [window]")));
}

TEST(MachineFileDamage, ANegativeUncertaintyIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("value = 35,", "value = 35, std = -1,")),
              AllOf(StartsWith("press.toml:8: [geometry.dp_nom] std = -1"), HasSubstr("not less than 0")));
}

TEST(MachineFileDamage, AnAreaOfZeroIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("0.0125", "0")),
              AllOf(StartsWith("press.toml:7: [geometry] A_A = 0"), HasSubstr("greater than 0 m2")));
}

TEST(MachineFileDamage, AKnownValueThatTheModelDoesNotUseIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("dp_nm = 3\n")),
              AllOf(StartsWith("press.toml:9: [geometry]"), HasSubstr("did you mean \"dp_nom\"?")));
}

TEST(MachineFileDamage, AMinimumAboveTheMaximumIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("unit = \"mm\"", "unit = \"mm\", min = 5, max = 4")),
              AllOf(StartsWith("press.toml:3: [signals.z] min = 5"), HasSubstr("not above max")));
}

TEST(MachineFileDamage, AScaleOfZeroIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("unit = \"mm\"", "unit = \"mm\", scale = 0")),
              AllOf(StartsWith("press.toml:3: [signals.z] scale = 0"), HasSubstr("other than 0")));
}

TEST(MachineFileDamage, ASignalWithoutColumnIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("column = \"pos\", ", "")),
              AllOf(StartsWith("press.toml:3: [signals.z]"), HasSubstr("column is missing")));
}

TEST(MachineFileDamage, ASignalNameMustFitIntoExpressions) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("y_v =", "\"y-v\" =")),
              AllOf(StartsWith("press.toml:4: [signals]"), HasSubstr("\"y-v\"")));
}

TEST(MachineFileDamage, AMissingSignalOfTheModelIsNamedWithItsMeaning) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("y_v =", "y =")),
              AllOf(StartsWith("press.toml:1: [signals] y_v is missing"), HasSubstr("spool position"),
                    HasSubstr("did you mean \"y\"?")));
}

TEST(MachineFileDamage, ASignalSpeltInTheWrongCaseIsNotTakenForANewOne) {
  EXPECT_THAT(RefusalOfPress(CushionWith("").insert(10, "t_oil = { column = \"T\", unit = \"degC\" }\n")),
              AllOf(StartsWith("press.toml:2: [signals] t_oil"), HasSubstr("spelling T_oil")));
}

TEST(MachineFileDamage, AMissingPistonAreaIsNamedWithItsMeaning) {
  EXPECT_THAT(RefusalOfPress(CushionChanged("A_A = 0.0125", "")),
              AllOf(StartsWith("press.toml:6: [geometry] A_A is missing"), HasSubstr("piston area")));
}

TEST(MachineFileDamage, MissingSignalsAreNamed) {
  EXPECT_THAT(RefusalOfPress("[geometry]\nA_A = 1\n"), HasSubstr("section [signals] is missing"));
}

TEST(MachineFileDamage, AGateOnAnUnknownSignalSuggestsTheNearest) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[gate]\nconditions = { \"ddt(zz)\" = { max = 0 } }\n")),
              AllOf(StartsWith("press.toml:10: [gate.conditions] \"zz\""), HasSubstr("did you mean \"z\"?")));
}

TEST(MachineFileDamage, AGateConditionWithoutLimitIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[gate]\nconditions = { z = { unit = \"mm\" } }\n")),
              AllOf(StartsWith("press.toml:10:"), HasSubstr("min or max is missing")));
}

TEST(MachineFileDamage, ARateMustHaveAUnitPerSecond) {
  EXPECT_THAT(
      RefusalOfPress(CushionWith("[gate]\nconditions = { \"ddt(z)\" = { max = -4, unit = \"mm\" } }\n")),
      AllOf(StartsWith("press.toml:10:"), HasSubstr("m/s")));
}

TEST(MachineFileDamage, ASpanShorterThanTwoBlocksIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[window]\nblock = 0.3\n")),
              AllOf(StartsWith("press.toml:9: [window]"), HasSubstr("span")));
}

TEST(MachineFileDamage, AForgettingFactorAboveOneIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[estimator]\nforgetting_factor = 1.5\n")),
              AllOf(StartsWith("press.toml:10: [estimator] forgetting_factor = 1.5"), HasSubstr("0 to 1")));
}

TEST(MachineFileDamage, AnUnknownEstimatorFormListsTheForms) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[estimator]\nform = \"exponetial\"\n")),
              AllOf(StartsWith("press.toml:10:"), HasSubstr("\"directional\""),
                    HasSubstr("did you mean \"exponential\"?")));
}

TEST(MachineFileDamage, MonitorLimitsInTheWrongOrderAreRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[monitor.K]\nunit = \"GPa\"\nwarn_low = 0.8\nalarm_low = 1.0\n")),
              AllOf(StartsWith("press.toml:11: [monitor.K] warn_low"), HasSubstr("alarm_low <= warn_low")));
}

TEST(MachineFileDamage, AMonitorLimitInTheWrongUnitIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[monitor.K]\nunit = \"l/min\"\n")),
              AllOf(StartsWith("press.toml:10: [monitor.K] unit = \"l/min\""), HasSubstr("Pa")));
}

TEST(MachineFileDamage, AValveSignalMustExist) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[valve]\noutput = \"y_w\"\n")),
              AllOf(HasSubstr("[valve] signal y_w"), HasSubstr("did you mean \"y_v\"?")));
}

TEST(MachineFileDamage, RowsWithoutTimeNeedASamplePeriod) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[log]\ntime = \"\"\n")),
              AllOf(StartsWith("press.toml:10:"), HasSubstr("sample_period")));
}

TEST(MachineFileDamage, WithoutHeaderColumnsAreNumbers) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[log]\nheader = false\ntime = 1\n")),
              AllOf(StartsWith("press.toml:2: [signals.p_A] column = \"pA\""), HasSubstr("column number")));
}

TEST(MachineFileDamage, WithoutHeaderTheTimeColumnIsANumberToo) {
  EXPECT_THAT(RefusalOfPress("[log]\nheader = false\n[signals]\np_A = 2\nz = 3\ny_v = 4\n"),
              AllOf(StartsWith("press.toml:1: [log] time"), HasSubstr("column number")));
}

TEST(MachineFileDamage, SeparatorAndDecimalSignMustDiffer) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[log]\nseparator = \",\"\ndecimal = \",\"\n")),
              AllOf(StartsWith("press.toml:11: [log] decimal"), HasSubstr("separator")));
}

TEST(MachineFileDamage, ABalanceForABuiltInModelIsRefused) {
  EXPECT_THAT(RefusalOfPress("[machine]\nmodel = \"valve\"\n[balance]\noutput = \"F\"\nterms = { A = \"1\" "
                             "}\n[signals]\nF = \"F\"\n"),
              AllOf(StartsWith("press.toml:2: [machine] model"), HasSubstr("\"expressions\"")));
}

TEST(MachineFileDamage, ExpressionsNeedABalance) {
  EXPECT_THAT(RefusalOfPress("[machine]\nmodel = \"expressions\"\n[signals]\nF = \"F\"\n"),
              HasSubstr("[balance]"));
}

TEST(MachineFileDamage, ABalanceWithoutTermsIsRefused) {
  EXPECT_THAT(RefusalOfPress("[signals]\nF = \"F\"\n[balance]\noutput = \"F\"\n"),
              AllOf(StartsWith("press.toml:3: [balance]"), HasSubstr("terms is missing")));
}

TEST(MachineFileDamage, ABalanceIsComputedInSi) {
  EXPECT_THAT(
      RefusalOfPress(
          "[signals]\nF = { column = \"F\", unit = \"kN\" }\n[balance]\noutput = \"F\"\nunit = \"kN\"\n"
          "terms = { c = \"1\" }\n"),
      AllOf(StartsWith("press.toml:5: [balance] unit = \"kN\""), HasSubstr("SI unit \"N\"")));
}

TEST(MachineFileDamage, TwoEffectsOfOneNameAreRefused) {
  EXPECT_THAT(
      RefusalOfPress(CushionWith(
          "[[effect]]\nid = \"a\"\nterms = { k = \"z\" }\n[[effect]]\nid = \"a\"\nterms = { k = \"z\" }\n")),
      AllOf(StartsWith("press.toml:13: [effect] id = \"a\""), HasSubstr("no other effect")));
}

TEST(MachineFileDamage, AnEffectNeedsDoubleBrackets) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[effect]\nid = \"a\"\n")),
              AllOf(StartsWith("press.toml:9:"), HasSubstr("[[effect]]")));
}

TEST(MachineFileDamage, AnEmptyExpressionIsRefused) {
  EXPECT_THAT(RefusalOfPress(CushionWith("[[effect]]\nid = \"a\"\nterms = { k = \"\" }\n")),
              AllOf(StartsWith("press.toml:11: [effect.terms] k"), HasSubstr("expression")));
}

TEST(MachineFileDamage, AnEffectAddedTwiceIsRefused) {
  EXPECT_THAT(RefusalOfPress("[machine]\neffects = [\"a\", \"a\"]\n" + CushionWith("")),
              AllOf(StartsWith("press.toml:2: [machine] effects"), HasSubstr("only once")));
}

TEST(MachineFileDamage, SeveralMistakesAreReportedTogetherInTheOrderOfTheFile) {
  const std::string text =
      RefusalOfPress(CushionWith("[gate]\nstroke_gap = 0\n[machine]\nname = 1\n[window]\nblck = 1\n"));
  EXPECT_THAT(text, StartsWith("press.toml:10:"));
  EXPECT_LT(text.find("press.toml:10:"), text.find("press.toml:12:"));
  EXPECT_LT(text.find("press.toml:12:"), text.find("press.toml:14:"));
}

TEST(MachineFileDamage, AFloodOfMistakesIsCutShort) {
  std::string more = "[window]\n";
  for (int i = 0; i < 40; ++i) more += "key" + std::to_string(i) + " = 1\n";
  EXPECT_THAT(RefusalOfPress(CushionWith(more)),
              AllOf(HasSubstr("... and 30 more"), Not(HasSubstr("\"key35\""))));
}

}  // namespace
}  // namespace hydroscope
