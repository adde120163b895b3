#include "cli/plain_numbers.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <set>
#include <sstream>

#include "cli/commands.h"
#include "host/output.h"

namespace hydroscope {
namespace {

/// Every option of every command whose value is a number, with the words that lead to it: "fit --seed".
void ForEachNumber(CLI::App& app, const std::string& path,
                   const std::function<void(const std::string&, CLI::Option&)>& visit) {
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    ForEachNumber(*command, path + command->get_name() + " ", visit);
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (type.starts_with("FLOAT") || type.starts_with("INT") || type.starts_with("UINT"))
      visit(path + option->get_name(), *option);
  }
}

/// Whether the option takes this value, from the command line on: nothing runs.
bool Takes(CLI::Option& option, const std::string& value) {
  option.clear();
  option.add_result(value);
  try {
    option.run_callback();
    return true;
  } catch (const CLI::ParseError&) {
    return false;
  }
}

class PlainNumbers : public testing::Test {
 protected:
  PlainNumbers() { AddCommands(app_, exit_code_); }
  void ForEach(const std::function<void(const std::string&, CLI::Option&)>& visit) {
    ForEachNumber(app_, "", visit);
  }

 private:
  CLI::App app_;
  int exit_code_ = 0;
};

TEST_F(PlainNumbers, NoOptionTakesWhatIsNoNumber) {
  int options = 0;
  ForEach([&](const std::string& name, CLI::Option& option) {
    ++options;
    for (const char* value : {"",      " ",     "abc", "3x",   "3 s",
                              "3s",    "1.2.3", "--3", "+-3",  "-",
                              "nan",   "-nan",  "inf", "-inf", "infinity",
                              "1e999", "0x10",  "1e",  "3 4",  "99999999999999999999999x"})
      EXPECT_FALSE(Takes(option, value)) << name << " '" << value << "'";
    const bool whole = !option.get_type_name().starts_with("FLOAT");
    for (const char* value : {"1.5", "1e3", "99999999999999999999999", "-99999999999999999999999"})
      EXPECT_FALSE(whole && Takes(option, value)) << name << " '" << value << "'";
  });
  EXPECT_GT(options, 150);
}

/// Whether simulating with this option is wrong use and writes nothing.
bool SimulationRefuses(const std::string& option, const std::string& value) {
  const std::string log = testing::TempDir() + "plain_numbers.csv",
                    words = option + " " + value + " --out " + log;
  std::vector<std::string> split = {"hydroscope"};
  for (std::istringstream in(words); in >> split.emplace_back();) continue;
  split.pop_back();
  std::filesystem::remove(log);
  std::vector<const char*> argv;
  for (const std::string& word : split) argv.push_back(word.c_str());
  return RunCommandLine(static_cast<int>(argv.size()), argv.data()) == kWrongUse &&
         !std::filesystem::exists(log);
}

/// Of the simulations the parser leaves some limits to the simulator.
bool Refuses(const std::string& name, CLI::Option& option, const std::string& value) {
  return !Takes(option, value) || (name.starts_with("simulate ") && SimulationRefuses(name, value));
}

TEST_F(PlainNumbers, OnlyWhatMayBeNegativeIs) {
  const std::set<std::string> may = {"simulate press --clock-drift", "benchmark thirty-runs --viscosity",
                                     "benchmark example-log --y_0"};
  ForEach([&](const std::string& name, CLI::Option& option) {
    if (name.starts_with("simulate test-cylinder --drift-") && !name.ends_with("from")) return;
    EXPECT_NE(Refuses(name, option, "-1"), may.contains(name)) << name;
  });
}

TEST_F(PlainNumbers, NoQuantityIsEndless) {
  ForEach([&](const std::string& name, CLI::Option& option) {
    if (!option.get_type_name().starts_with("FLOAT")) return;
    EXPECT_TRUE(Refuses(name, option, "1e300")) << name;
  });
}

}  // namespace
}  // namespace hydroscope
