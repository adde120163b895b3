#include "diagnosis/states/staircase.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

StateCandidate SetOf(const std::vector<std::string>& added) {
  StateCandidate set;
  set.added = added;
  set.fit.noise = Eigen::VectorXd::Ones(1);
  return set;
}

TEST(Staircase, LeadsToTheSetFoundThoughTheBestOfASizeHoldsAnotherEffect) {
  const std::vector<std::vector<StateCandidate>> levels = {
      {SetOf({})},
      {SetOf({"drag"}), SetOf({"root_flow"})},
      {SetOf({"drag", "dead_zone"}), SetOf({"root_flow", "lag"})},
      {SetOf({"root_flow", "dead_zone", "lag"})}};
  std::vector<std::string> added;
  for (const auto& [id, error] : StaircaseTo(levels.back().front(), levels)) added.push_back(id);
  EXPECT_EQ(added, (std::vector<std::string>{"", "root_flow", "lag", "dead_zone"}));
  added.clear();
  for (const auto& [id, error] :
       StaircaseTo(SetOf({"drag", "dead_zone"}), {levels[0], {SetOf({"lag"})}, levels[2]}))
    added.push_back(id);
  EXPECT_EQ(added, (std::vector<std::string>{"", "drag + dead_zone"}));
}

}  // namespace
}  // namespace hydroscope
