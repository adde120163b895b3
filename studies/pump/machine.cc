#include "studies/pump/machine.h"

#include <fmt/format.h>

#include "pipeline/shaft_rows.h"

namespace hydroscope {
namespace {

constexpr char kPumpSignalsText[] = R"toml(shaft_speed = { column = "n", unit = "rad/s" }
load_flow = { column = "Q", unit = "m3/s" }
outlet_pressure = { column = "p_s", unit = "Pa" }
)toml";
constexpr char kControlSignals[] = R"toml(control_pressure = { column = "p_c", unit = "Pa" }
control_position = { column = "x_p", unit = "m" }
)toml";
constexpr char kPumpSizes[] = R"toml([episodes]
shaft = "shaft_speed"
[geometry]
D_max = { value = 4.6e-6, unit = "m3" }
X_p = { value = 12, unit = "mm" }
A_p = { value = 1.77, unit = "cm2" }
A_v = { value = 0.5, unit = "cm2" }
m_p = { value = 1.5, unit = "kg" }
m_v = { value = 0.1, unit = "kg" }
b_p = { value = 1200, unit = "N s/m" }
b_v = { value = 300, unit = "N s/m" }
V_c = { value = 0.02, unit = "l" }
E = { value = 12000, unit = "bar" }
p_t = { value = 2, unit = "bar" }
)toml";
/// Equations 15 to 19 of the paper with absolute states, the flow of the operating point counted once; preload as set.
constexpr char kLinearStates[] = R"toml(W_0 = { value = 360, unit = "rad/s" }
x_0 = { value = 5, unit = "mm" }
F_0 = { value = 1017, unit = "N" }
[states]
p_c = { ddt = "E/V_c*(K_q*x_v - C_l*p_c - A_p*v_p)", unit = "Pa", near = "K_p*x_0/A_p" }
p_s = { ddt = "E/V_t*(shaft_speed*D_max*(1 - x_0/X_p) - W_0*D_max/X_p*(x_p - x_0) - K_q*x_v - A_v*v_v - load_flow)", unit = "Pa", near = "outlet_pressure" }
x_p = { ddt = "v_p", unit = "m", near = "x_0" }
x_v = { ddt = "v_v", unit = "m" }
v_p = { ddt = "(A_p*p_c - K_p*x_p - b_p*v_p)/m_p", initial = 0, unit = "m/s" }
v_v = { ddt = "(A_v*p_s - K_v*x_v - b_v*v_v - F_0)/m_v", initial = 0, unit = "m/s" }
[outputs]
outlet_pressure = "p_s"
[parameters]
K_v = { start = 2e5, min = 2e4, max = 2e6, unit = "N/m" }
K_q = { start = 0.5, min = 0.05, max = 5, unit = "m2/s" }
C_l = { start = 2e-11, min = 2e-12, max = 2e-10, unit = "m3/(s Pa)" }
K_p = { start = 1.5e5, min = 1.5e4, max = 1.5e6, unit = "N/m" }
V_t = { start = 3e-3, min = 3e-4, max = 3e-2, unit = "m3" }
)toml";

Machine Parsed(const std::string& text) {
  const auto machine = ParseMachine(text, "pump");
  if (!machine) fmt::print(stderr, "{}\n", machine.error().text);
  return machine.value_or(Machine{});
}

}  // namespace

Machine PumpFile(bool control) {
  return Parsed(fmt::format("[machine]\nname = \"pump\"\nmodel = \"pump\"\n[signals]\n{}{}{}",
                            kPumpSignalsText, control ? kControlSignals : "", kPumpSizes));
}

Machine LinearPumpFile() {
  return Parsed(fmt::format("[machine]\nname = \"published pump\"\n[signals]\n{}{}{}", kPumpSignalsText,
                            kPumpSizes, kLinearStates));
}

Episode PumpEpisode(const PumpLog& log, const Machine& machine) {
  Episode episode;
  episode.time = log.t;
  episode.signal.resize(static_cast<Eigen::Index>(log.t.size()),
                        static_cast<Eigen::Index>(machine.signals.size()));
  const std::vector<double>* columns[] = {&log.speed, &log.flow, &log.p_s, &log.p_c, &log.x_p};
  for (Eigen::Index s = 0; s < episode.signal.cols(); ++s)
    episode.signal.col(s) = Eigen::Map<const Eigen::VectorXd>(columns[s]->data(), episode.signal.rows());
  std::vector<int> outputs;
  for (const OutputSpec& o : machine.states.outputs) outputs.push_back(machine.SignalIndex(o.signal));
  return AtShaftAngles(episode, machine.SignalIndex(machine.states.shaft), outputs, machine.log.hold);
}

Eigen::VectorXd PumpParameters(const PumpOptions& options) {
  const std::vector<PumpSize> sizes = TrueParameters(options);
  Eigen::VectorXd p(static_cast<Eigen::Index>(sizes.size()));
  for (std::size_t k = 0; k < sizes.size(); ++k) p[k] = sizes[k].second;
  return p;
}

double PumpFit(const StateFit& fit) { return 100 * (1 - fit.noise[0] / fit.scale[0]); }

}  // namespace hydroscope
