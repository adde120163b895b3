#include "page/first_run/log_proposal.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "setup/log_columns.h"

namespace hydroscope {
namespace {

/// Columns of a press whose spool goes to and fro.
LogColumns PressColumns() {
  const auto path = std::filesystem::path(::testing::TempDir()) / "log_proposal.csv";
  std::ofstream file(path);
  file << "t,p_A,p_0,z,y_v\n";
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.002 * k, open = std::sin(3 * t);
    file << fmt::format("{},{},{},{},{}\n", t, 1e7 + 1e6 * open, 2.1e7, 0.1 - 0.05 * std::sin(3 * t - 1.5),
                        0.4 * open);
  }
  file.close();
  auto columns = ReadLogColumns(path.string());
  std::filesystem::remove(path);
  if (!columns) ADD_FAILURE() << columns.error().text;
  return columns ? *columns : LogColumns{};
}

TEST(LogProposal, AGateDrawnOnThePageIsTheOneThatTheFileWillHave) {
  ColumnMapping mapping;
  mapping.model = "die_cushion";
  mapping.geometry["A_A"] = 0.0125;
  mapping.gate = {{"z", false, 0.07, {}}};
  const MachineProposal proposal = ProposeMapped(PressColumns(), mapping);
  const auto written = ParseMachine(proposal.text, "press.toml");
  ASSERT_TRUE(written) << written.error().text;
  EXPECT_EQ(proposal.machine.gate, written->gate);
  EXPECT_EQ(proposal.machine.gate.bounds.size(), 2u);  // and off the spool's null
}

}  // namespace
}  // namespace hydroscope
