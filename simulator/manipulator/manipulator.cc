#include "simulator/manipulator/manipulator.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/finite_number.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

constexpr std::array<const char*, 4> kEdgeNames = {"PA", "AT", "PB", "BT"};

std::vector<ManipulatorEffectInfo> ListedEffects() {
  std::vector<ManipulatorEffectInfo> list = {{"payload", "kg", 80, "a mass more at the tip"}};
  for (int i = 1; i <= kJoints; ++i) {
    list.push_back({fmt::format("stribeck_friction_{}", i), "N", 3000,
                    fmt::format("friction of cylinder {} is larger by this near "
                                "standstill, gone beyond some 10 mm/s",
                                i)});
    for (const char* edge : kEdgeNames)
      list.push_back({fmt::format("worn_edge_{}_{}", edge, i), "1", 0.03,
                      fmt::format("edge {} of valve {} is rounded by this share of full "
                                  "opening: it leaks about the null",
                                  edge, i)});
    list.push_back({fmt::format("joint_play_{}", i), "m", 0.002,
                    fmt::format("clearance between cylinder {} and its joint", i)});
  }
  return list;
}

ManipulatorReadings Read(const ManipulatorState& x, const ManipulatorNoise& noise, RandomStream& random) {
  ManipulatorReadings r;
  for (std::size_t i = 0; i < kJoints; ++i) {
    r.q[i] = x.q[i] + noise.q * random.Normal();
    r.p_1[i] = x.p_1[i] + noise.p * random.Normal();
    r.p_2[i] = x.p_2[i] + noise.p * random.Normal();
    r.spool[i] = x.spool[i] + noise.spool * random.Normal();
  }
  r.p_s = x.p_s + noise.p * random.Normal();
  return r;
}

}  // namespace

const std::vector<ManipulatorEffectInfo>& ManipulatorEffects() {
  static const std::vector<ManipulatorEffectInfo> list = ListedEffects();
  return list;
}

Status HideEffect(const std::string& text, ManipulatorTruth& truth) {
  const std::size_t equals = text.find('=');
  const std::string id = text.substr(0, equals);
  const auto& list = ManipulatorEffects();
  const auto info = std::find_if(list.begin(), list.end(), [&](const auto& e) { return e.id == id; });
  if (info == list.end()) {
    std::string known;
    for (const auto& e : list) known += (known.empty() ? "" : ", ") + e.id;
    return UsageError("effect '{}' is not known; the manipulator has {}", id, known);
  }
  double size = info->typical_size;
  if (equals != std::string::npos) {
    const auto given = FiniteNumber(std::string_view(text).substr(equals + 1));
    if (!given || *given < 0)
      return UsageError("effect '{}': the size must be a number of {}, 0 or more", text, info->unit);
    size = *given;
  }
  if (id == "payload") {
    truth.payload = size;
    return {};
  }
  CylinderTruth& cylinder = truth.cylinders[static_cast<std::size_t>(id.back() - '1')];
  if (id.starts_with("stribeck")) cylinder.F_stribeck = size;
  if (id.starts_with("joint_play")) cylinder.play = size;
  for (std::size_t e = 0; e < kEdgeNames.size(); ++e)
    if (id.starts_with(fmt::format("worn_edge_{}", kEdgeNames[e]))) cylinder.worn[e] = size;
  return {};
}

Status Validate(const ManipulatorOptions& o) {
  if (!(o.seconds >= 1 && o.seconds <= 3600))
    return UsageError("--seconds must be 1 to 3600, not {}", o.seconds);
  const double steps = o.sample_period / ManipulatorController::kPeriod;
  if (!(steps > 0.5 && std::abs(steps - std::round(steps)) < 1e-6 && o.sample_period <= 0.1))
    return UsageError("--sample-period must be a multiple of the controller's {} s, at most 0.1 s, not {}",
                      ManipulatorController::kPeriod, o.sample_period);
  return {};
}

ManipulatorLog SimulateManipulator(const ManipulatorOptions& o) {
  constexpr double kSettled = 3;  // s
  ManipulatorPlant plant(o.truth, BeginningOf(o.truth, o.motion));
  ManipulatorController controller(o.truth, o.model, o.rates);
  RandomStream random(StreamSeed(o.seed, "manipulator sensors"));
  const auto every = static_cast<long>(std::lround(o.sample_period / ManipulatorController::kPeriod));
  const auto count = static_cast<long>(std::lround(o.seconds / ManipulatorController::kPeriod));
  ManipulatorLog log;
  double squares = 0;
  long judged = 0;
  TipPosition before{};
  for (long k = 0; k < count; ++k) {
    const double time = static_cast<double>(k) * ManipulatorController::kPeriod;
    const ManipulatorReadings readings = Read(plant.state(), o.noise, random);
    if (k % every == 0) log.rows.push_back({time, readings});
    const TipReference reference = ReferenceAt(o.truth, o.motion, time);
    const TipPosition tip = TipOf(o.truth, plant.state().q[0], plant.state().q[1]);
    if (time >= kSettled) {
      const double error = std::hypot(reference.position.x - tip.x, reference.position.y - tip.y);
      const double speed = std::hypot(tip.x - before.x, tip.y - before.y) / ManipulatorController::kPeriod;
      squares += error * error;
      ++judged;
      log.tracking.largest = std::max(log.tracking.largest, error);
      if (judged > 1) log.tracking.largest_speed = std::max(log.tracking.largest_speed, speed);
    }
    before = tip;
    plant.Run(controller.Command(readings, reference), ManipulatorController::kPeriod);
  }
  log.tracking.rms = std::sqrt(squares / static_cast<double>(std::max(1L, judged)));
  return log;
}

std::vector<std::pair<std::string, double>> TrueParameters(const ManipulatorTruth& truth) {
  const ControllerModel model = TrueModel(truth);
  std::vector<std::pair<std::string, double>> out;
  constexpr std::array<const char*, 6> kRigid = {"mx_1", "my_1", "J_1", "mx_2", "my_2", "J_2"};
  for (std::size_t k = 0; k < kRigid.size(); ++k) out.emplace_back(kRigid[k], model.rigid[k]);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto add = [&](const char* name, double value) {
      out.emplace_back(fmt::format("{}_{}", name, i + 1), value);
    };
    add("b", model.b[i]);
    add("F_c", model.F_c[i]);
    add("K", model.K[i]);
    for (std::size_t e = 0; e < kEdgeNames.size(); ++e)
      add(fmt::format("C_{}", kEdgeNames[e]).c_str(), model.edges[i][e]);
  }
  return out;
}

void AppendManipulatorLine(const ManipulatorRow& row, std::string& text) {
  const auto end = std::back_inserter(text);
  const ManipulatorReadings& r = row.readings;
  fmt::format_to(end, FMT_COMPILE("{:.4f},{:.7f},{:.7f}"), row.time, r.q[0], r.q[1]);
  for (const double p : {r.p_1[0], r.p_2[0], r.p_1[1], r.p_2[1]})
    fmt::format_to(end, FMT_COMPILE(",{:.0f}"), p);
  fmt::format_to(end, FMT_COMPILE(",{:.6f},{:.6f},{:.0f}\n"), r.spool[0], r.spool[1], r.p_s);
}

}  // namespace hydroscope
