#include "studies/manipulator/machine.h"

#include <fmt/format.h>

#include <cstdio>

namespace hydroscope {
namespace {

constexpr std::array<const char*, 6> kRigidNames = {"mx_1", "my_1", "J_1", "mx_2", "my_2", "J_2"};
constexpr std::array<const char*, 4> kEdgesInOrder = {"C_PA", "C_AT", "C_PB", "C_BT"};

/// In SI.
std::string KnownLine(const std::string& name, double value) { return fmt::format("{} = {}\n", name, value); }

}  // namespace

Machine ManipulatorMachine(const ManipulatorTruth& truth, const ControllerModel* known) {
  std::string text =
      "[machine]\nname = \"arm\"\nmodel = \"manipulator\"\n[log]\nhold = \"linear\"\n[signals]\n";
  for (const char* name : {"q_1", "q_2"})
    text += fmt::format("{0} = {{ column = \"{0}\", unit = \"rad\" }}\n", name);
  for (const char* name : {"p_11", "p_12", "p_21", "p_22", "p_s"})
    text += fmt::format("{0} = {{ column = \"{0}\", unit = \"Pa\" }}\n", name);
  for (const char* name : {"y_1", "y_2"})
    text += fmt::format("{0} = {{ column = \"{0}\", unit = \"1\" }}\n", name);
  text += "[geometry]\n" + KnownLine("a_1", truth.links[0].length) + KnownLine("a_2", truth.links[1].length) +
          KnownLine("p_t", truth.p_t);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const CylinderTruth& c = truth.cylinders[i];
    const auto of = [&](const char* name, double value) {
      text += KnownLine(fmt::format("{}_{}", name, i + 1), value);
    };
    of("l1", c.l_1);
    of("l2", c.l_2);
    of("q0", c.q_0);
    of("x0", c.x_0);
    of("S", c.stroke);
    of("A1", c.A_1);
    of("A2", c.A_2);
    of("V", c.V_0);
  }
  for (std::size_t k = 0; known != nullptr && k < kRigidNames.size(); ++k)
    text += KnownLine(kRigidNames[k], known->rigid[k]);
  const auto machine = ParseMachine(text, "manipulator");
  if (!machine) std::fprintf(stderr, "%s\n", machine.error().text.c_str());
  return machine.value_or(Machine{});
}

Episode EpisodeOf(const ManipulatorLog& log) {
  Episode episode;
  episode.signal.resize(static_cast<Eigen::Index>(log.rows.size()), 9);
  for (std::size_t k = 0; k < log.rows.size(); ++k) {
    const ManipulatorReadings& r = log.rows[k].readings;
    episode.time.push_back(log.rows[k].time);
    episode.signal.row(k) << r.q[0], r.q[1], r.p_1[0], r.p_2[0], r.p_1[1], r.p_2[1], r.p_s, r.spool[0],
        r.spool[1];
  }
  return episode;
}

ControllerModel WithIdentified(ControllerModel model, const std::vector<std::string>& names,
                               const Eigen::VectorXd& values) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    const double value = values[k];
    const std::string& name = names[k];
    for (std::size_t r = 0; r < kRigidNames.size(); ++r)
      if (name == kRigidNames[r]) model.rigid[r] = value;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::string joint = fmt::format("_{}", i + 1);
      if (name == "b" + joint) model.b[i] = value;
      if (name == "F_c" + joint) model.F_c[i] = value;
      if (name == "K" + joint) model.K[i] = value;
      if (name == "1/K" + joint) model.K[i] = 1 / value;
      for (std::size_t e = 0; e < kEdgesInOrder.size(); ++e)
        if (name == kEdgesInOrder[e] + joint) model.edges[i][e] = value;
    }
  }
  return model;
}

}  // namespace hydroscope
