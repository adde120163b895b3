#include <fmt/format.h>

#include <functional>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;

/// A row of a simulated log: t, p_A, p_B, p_0, z, y_v, U_v, T_oil in SI and °C.
struct Row {
  double t = 0, p_A = 0, p_B = 0, p_0 = 0, z = 0, y_v = 0, U_v = 0, T_oil = 0;
};

class InitCommand : public CommandLine {
 protected:
  std::vector<Row> Rows(int seconds = 40) {
    std::ifstream in(Simulate("si.csv", seconds, 3));
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line.substr(0, 5), "t,p_A");
    std::vector<Row> rows;
    while (std::getline(in, line)) {
      Row r;
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &r.t, &r.p_A, &r.p_B, &r.p_0, &r.z,
                      &r.y_v, &r.U_v, &r.T_oil) == 8)
        rows.push_back(r);
    }
    return rows;
  }
  std::string Log(const std::string& header, const std::vector<Row>& rows,
                  const std::function<std::string(const Row&)>& write) {
    std::string text = header + "\n";
    for (const Row& row : rows) text += write(row) + "\n";
    WriteText(File("log.csv"), text);
    return File("log.csv");
  }
  /// Proposes a machine for the log and checks the log with it; returns what init inferred.
  nlohmann::json ExpectStrokes(const std::string& log, int at_least) {
    const Ran init =
        Run({"init", log, "--area", "125", "--out", File("m.toml"), "--force", "--json", File("init.json")});
    EXPECT_EQ(init.exit_code, 0) << init.out << init.err;
    const Ran check = Run({"check", log, "-m", File("m.toml"), "--json", "-"});
    EXPECT_TRUE(check.exit_code == 0 || check.exit_code == 4) << check.err << ReadText(File("m.toml"));
    const nlohmann::json json = check.Json();
    EXPECT_TRUE(json.is_object() && json["strokes"].get<int>() >= at_least)
        << json.dump(1) << ReadText(File("m.toml"));
    return nlohmann::json::parse(ReadText(File("init.json")));
  }
  static nlohmann::json ColumnOf(const nlohmann::json& init, const std::string& signal) {
    for (const nlohmann::json& column : init["columns"])
      if (column["signal"] == signal) return column;
    return nullptr;
  }
};

TEST_F(InitCommand, UnderstandsDayNumbersOfASpreadsheet) {
  const std::string log = Log("Zeit,p_A,p_B,p_0,z,y_v,U_v,T_oil", Rows(), [](const Row& r) {
    return fmt::format("{:.11f},{:.0f},{:.0f},{:.0f},{:.6f},{:.6f},{:.5f},{:.2f}", 45123.5 + r.t / 86400,
                       r.p_A, r.p_B, r.p_0, r.z, r.y_v, r.U_v, r.T_oil);
  });
  EXPECT_EQ(ColumnOf(ExpectStrokes(log, 4), "time")["unit"], "d");
}

TEST_F(InitCommand, UnderstandsUnitsAtTheEndOfNames) {
  const std::string log = Log("t_ms,pA_bar,pB_bar,p0_bar,s_mm,y_v,U_v,T_oil_C", Rows(), [](const Row& r) {
    return fmt::format("{:.0f},{:.3f},{:.3f},{:.3f},{:.4f},{:.6f},{:.5f},{:.2f}", r.t * 1e3, r.p_A / 1e5,
                       r.p_B / 1e5, r.p_0 / 1e5, r.z * 1e3, r.y_v, r.U_v, r.T_oil);
  });
  const nlohmann::json init = ExpectStrokes(log, 4);
  EXPECT_EQ(ColumnOf(init, "p_A")["column"], "pA_bar");
  EXPECT_EQ(ColumnOf(init, "p_A")["unit"], "bar");
  EXPECT_EQ(ColumnOf(init, "z")["column"], "s_mm");
  EXPECT_EQ(ColumnOf(init, "z")["unit"], "mm");
  EXPECT_EQ(ColumnOf(init, "T_oil")["unit"], "degC");
  EXPECT_EQ(ColumnOf(init, "time")["unit"], "ms");
  EXPECT_EQ(ColumnOf(init, "y_v")["unit"], "1") << "no volt";
}

TEST_F(InitCommand, TakesCurrentLoopsForAGuess) {
  const auto loop = [](double share) { return 4 + 16 * share; };
  const std::string log = Log("t,p_A [mA],p_B [mA],p_0 [mA],z [mA],y_v", Rows(), [&](const Row& r) {
    return fmt::format("{:.3f},{:.5f},{:.5f},{:.5f},{:.6f},{:.6f}", r.t, loop(r.p_A / 400e5),
                       loop(r.p_B / 400e5), loop(r.p_0 / 400e5), loop(r.z / 0.5), r.y_v);
  });
  const nlohmann::json init = ExpectStrokes(log, 4);
  for (const char* signal : {"p_A", "z"}) {
    EXPECT_EQ(ColumnOf(init, signal)["sure"], false) << signal;
    EXPECT_THAT(ColumnOf(init, signal)["why"].get<std::string>(), HasSubstr("4 ... 20 mA")) << signal;
  }
}

TEST_F(InitCommand, GuessesColumnsWithoutTellingNamesAndSaysSo) {
  const std::string log = Log("Time,AI_0,AI_1,AI_2,AI_3,AI_4,AI_5,AI_6", Rows(), [](const Row& r) {
    return fmt::format("{:.3f},{:.2f},{:.3f},{:.3f},{:.5f},{:.3f},{:.3f},{:.4f}", r.t, r.T_oil, r.p_0 / 1e5,
                       r.z * 1e3, r.y_v, r.p_A / 1e5, r.p_B / 1e5, r.U_v);
  });
  const nlohmann::json init = ExpectStrokes(log, 4);
  for (const auto& [signal, column] :
       {std::pair("p_A", "AI_4"), std::pair("z", "AI_2"), std::pair("y_v", "AI_3")}) {
    EXPECT_EQ(ColumnOf(init, signal)["column"], column) << init.dump(1);
    EXPECT_EQ(ColumnOf(init, signal)["sure"], false);
    EXPECT_FALSE(ColumnOf(init, signal)["why"].get<std::string>().empty());
  }
}

TEST_F(InitCommand, TakesSlowRowsForSlowRows) {
  for (const int every : {100, 500}) {  // 5 and 1 Hz
    const std::vector<Row> all = Rows(300);
    std::vector<Row> rows;
    for (std::size_t k = 0; k < all.size(); k += static_cast<std::size_t>(every)) rows.push_back(all[k]);
    const std::string log = Log("t,p_A,z,y_v", rows, [](const Row& r) {
      return fmt::format("{:.3f},{:.0f},{:.6f},{:.6f}", r.t, r.p_A, r.z, r.y_v);
    });
    const Ran init = Run({"init", log, "--area", "125", "--out", File("m.toml"), "--force", "--json", "-"});
    EXPECT_EQ(ColumnOf(init.Json(), "time")["unit"], "s") << every << init.out;
  }
}

TEST_F(InitCommand, ACheckThatFindsNoStrokeIsNoSuccess) {
  const std::string log = Log("t,p_A,z,y_v", Rows(), [](const Row& r) {
    return fmt::format("{:.3f},{:.0f},{:.6f},{:.6f}", r.t, r.p_A, r.z, -std::abs(r.y_v));
  });
  const Ran check = Run({"check", log, "-m", kMachine, "--json", "-"});
  EXPECT_EQ(check.Json()["strokes"], 0);
  EXPECT_EQ(check.exit_code, 4);
}

}  // namespace
}  // namespace hydroscope
