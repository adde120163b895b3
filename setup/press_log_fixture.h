#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "setup/machine_proposal.h"

namespace hydroscope {

/// One row of a press in SI.
struct PressRow {
  double t, p_A, p_B, p_0, z, y_v, U_v, T_oil;
};

/// Twelve seconds of a press: strokes of 1 s under pressure, 1 s back, with sensor noise.
inline std::vector<PressRow> PressRows() {
  std::mt19937 generator(7);
  std::normal_distribution<double> noise;
  std::vector<PressRow> rows;
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.002 * (i + 1), phase = std::fmod(t, 2.0);
    const bool stroke = phase < 1;
    const double opening = stroke ? 0.3 + 0.1 * std::sin(9 * t) : -0.3;
    rows.push_back({t, (stroke ? 180e5 : 20e5) + 2e5 * noise(generator), 60e5 + 2e5 * noise(generator),
                    210e5 + 1e5 * noise(generator),
                    (stroke ? 0.2 - 0.15 * phase : 0.05 + 0.15 * (phase - 1)) + 1e-4 * noise(generator),
                    opening + 1e-3 * noise(generator), 10 * opening + 1e-2 * noise(generator),
                    313 + 0.05 * noise(generator)});
  }
  return rows;
}

/// A log with `header` whose rows `write` makes from those of the press.
inline std::string PressLog(const std::string& header,
                            const std::function<std::string(const PressRow&)>& write) {
  std::string text = header;
  for (const PressRow& row : PressRows()) text += write(row) + "\n";
  return text;
}

/// What is proposed for a log with this text.
inline MachineProposal Propose(const std::string& text, double area = 0.0125) {
  const auto path = std::filesystem::path(::testing::TempDir()) /
                    fmt::format("{}.csv", ::testing::UnitTest::GetInstance()->current_test_info()->name());
  std::ofstream(path, std::ios::binary) << text;
  const auto head = ReadLogColumns(path.string());
  std::filesystem::remove(path);
  if (!head) {
    ADD_FAILURE() << head.error().text;
    return {};
  }
  ProposalOptions options;
  if (area > 0) options.known["A_A"] = area;
  return ProposeMachine(*head, options);
}

/// The proposed text loads, and as the very machine that was proposed.
inline void ExpectLoads(const MachineProposal& proposal) {
  const auto machine = ParseMachine(proposal.text, "log.toml");
  ASSERT_TRUE(machine) << machine.error().text << "\n" << proposal.text;
  EXPECT_EQ(*machine, proposal.machine) << proposal.text;
}

}  // namespace hydroscope
