#include "studies/manipulator/identification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "diagnosis/drift/rules.h"
#include "models/machine_kind.h"
#include "models/state_model.h"

namespace hydroscope {
namespace {

TEST(ManipulatorIdentification, FindsSixBaseParametersByTheRankOfTheRecord) {
  const ManipulatorTruth truth = PublishedManipulator();
  const IdentifiedManipulator found = Identify(truth, DrawnMotion(1), 40, 1);
  ASSERT_TRUE(found.fit.solved()) << found.fit.failed;
  EXPECT_EQ(found.fit.base.rank, 20);
  const Machine machine = ManipulatorMachine(truth);
  const LinearForm form = LinearFormOf(machine);
  EXPECT_EQ(BaseParameterText(form, found.fit.base, 0), "mx_1 + 1.6 m_2");
  EXPECT_EQ(BaseParameterText(form, found.fit.base, 2), "J_1 + 2.56 m_2");
  ASSERT_EQ(found.fit.base.unseen.size(), 1u);
  EXPECT_EQ(form.parameters[static_cast<std::size_t>(found.fit.base.unseen[0])], "m_1");
}

TEST(ManipulatorIdentification, FindsTheTruthWithinAPercent) {
  const ManipulatorTruth truth = PublishedManipulator();
  const IdentifiedManipulator found = Identify(truth, DrawnMotion(1), 40, 1);
  std::map<std::string, double> truths;
  for (const auto& [name, value] : TrueParameters(truth)) truths[name] = value;
  for (std::size_t k = 0; k < found.fit.parameters.size(); ++k) {
    const std::string& name = found.fit.parameters[k];
    const double is = name.starts_with("1/") ? 1 / truths[name.substr(2)] : truths[name];
    EXPECT_NEAR(found.fit.value[static_cast<Eigen::Index>(k)] / is, 1, name.starts_with("F_c") ? 0.03 : 0.01)
        << name;
  }
}

/// The model with the true parameters, and an effect of the library with its own, runs along the simulated log.
void ExpectEquationsOf(const ManipulatorTruth& truth, const std::vector<std::string>& effects,
                       const std::map<std::string, double>& of_effects) {
  ManipulatorOptions options;
  options.truth = truth;
  options.seconds = 8;
  options.noise = {0, 0, 0};
  const auto model = BuildStateModel(ManipulatorMachine(options.truth), effects);
  ASSERT_TRUE(model) << model.error().text;
  std::map<std::string, double> truths = of_effects;
  for (const auto& [name, value] : TrueParameters(options.truth)) truths[name] = value;
  const Episode episode = EpisodeOf(SimulateManipulator(options));
  StateSimulator simulator(*model);
  Eigen::VectorXd theta((*model)->parameter_count());
  for (int p = 0; p < theta.size(); ++p)
    theta[p] = truths.at((*model)->parameters[static_cast<std::size_t>(p)].spec.name);
  simulator.SetParameters(theta);
  Eigen::VectorXd at_rest = Eigen::VectorXd::Zero((*model)->states());
  for (int i = 0; i < at_rest.size(); ++i)
    if (const int output = (*model)->measured_by[static_cast<std::size_t>(i)]; output >= 0)
      at_rest[i] = episode.signal(0, (*model)->outputs[static_cast<std::size_t>(output)]);
  StateRun run;
  simulator.Run(episode, 0, episode.rows() - 1, simulator.Initial(episode, at_rest), nullptr, run);
  ASSERT_FALSE(run.diverged);
  for (int j = 0; j < run.outputs.cols(); ++j) {
    const auto measured = episode.signal.col((*model)->outputs[static_cast<std::size_t>(j)]);
    const double variation = measured.maxCoeff() - measured.minCoeff();
    EXPECT_LT((measured - run.outputs.col(j)).cwiseAbs().maxCoeff(), 0.02 * variation) << j;
  }
}

/// Its states are the truth of the simulator: the model runs along the simulated log but for noise.
TEST(ManipulatorIdentification, HasTheEquationsOfTheSimulatedArm) {
  ExpectEquationsOf(PublishedManipulator(), {}, {});
}

TEST(ManipulatorIdentification, HasTheWornEdgesOfTheSimulatedArm) {
  constexpr double kRadius = 0.03;
  for (const char* effect : {"worn_edge_PB_1", "worn_edge_BT_2"}) {
    SCOPED_TRACE(effect);
    ManipulatorTruth truth = PublishedManipulator();
    ASSERT_TRUE(HideEffect(std::string(effect) + "=0.03", truth));
    ExpectEquationsOf(truth, {effect}, {{"r", kRadius}});
  }
}

TEST(ManipulatorRules, WatchParametersThatTheArmHas) {
  const auto rules =
      drift::LoadRules(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/manipulator_rules.toml");
  ASSERT_TRUE(rules) << rules.error().text;
  for (const drift::WatchSpec& watch : rules->watches)
    EXPECT_NE(FindParameter(*FindKind("manipulator"), watch.quantity), nullptr) << watch.quantity;
}

TEST(ManipulatorFile, IsThatOfTheSimulatedArm) {
  const auto file = LoadMachine(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/manipulator.toml");
  ASSERT_TRUE(file) << file.error().text;
  const Machine simulated = ManipulatorMachine(PublishedManipulator());
  for (const auto& [name, known] : simulated.geometry) {
    ASSERT_TRUE(file->Geometry(name)) << name;
    EXPECT_NEAR(file->Geometry(name)->value, known.value, 1e-9 * std::abs(known.value)) << name;
  }
}

}  // namespace
}  // namespace hydroscope
