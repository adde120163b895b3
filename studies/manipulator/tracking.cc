#include <fmt/format.h>

#include "studies/manipulator/benchmark.h"
#include "studies/manipulator/identification.h"

namespace hydroscope {
namespace {

constexpr double kGoal = 0.5;        // rms error of what is identified over that of the datasheet
constexpr double kPathSeconds = 27;  // twice round, and the first side again
constexpr std::array<double, 3> kCoulomb = {0, 800, 1500};  // N

TrackingError Follow(const ManipulatorTruth& truth, const ControllerModel& model, std::uint64_t seed) {
  ManipulatorOptions options;
  options.truth = truth;
  options.motion = ParallelogramMotion();
  options.model = model;
  options.seconds = kPathSeconds;
  options.seed = seed;
  return SimulateManipulator(options).tracking;
}

void PrintTrackingRow(const char* what, const TrackingError& e) {
  fmt::print("  {:<46} {:>5.2f} mm {:>6.2f} mm  {:.4f} s\n", what, 1e3 * e.rms, 1e3 * e.largest,
             e.largest / e.largest_speed);
}

}  // namespace

bool PrintTracking(const ManipulatorBenchmarkOptions& options) {
  bool halved = true;
  fmt::print("\ntip on the parallelogram                           rms     max |e|  max|e|/max|v|\n");
  fmt::print("published, datasheet and CAD                       6.50 mm  16.80 mm  0.0229 s\n");
  fmt::print("published, identified                              3.30 mm   6.80 mm  0.0095 s\n");
  for (const double coulomb : kCoulomb) {
    ManipulatorTruth truth = PublishedManipulator();
    for (CylinderTruth& c : truth.cylinders) c.F_c = coulomb;
    const ControllerModel datasheet = DatasheetModel(truth);
    const ControllerModel identified =
        Identify(truth, DrawnMotion(options.seed), options.seconds, options.seed).model;
    const TrackingError from = Follow(truth, datasheet, options.seed),
                        to = Follow(truth, identified, options.seed);
    fmt::print("Coulomb friction {:.0f} N in the machine\n", coulomb);
    PrintTrackingRow("datasheet and CAD, friction b as identified", from);
    PrintTrackingRow("identified", to);
    ControllerModel viscous = identified, edges = identified, modulus = identified, rigid = identified;
    viscous.F_c = {};
    PrintTrackingRow("identified, Coulomb friction not compensated", Follow(truth, viscous, options.seed));
    edges.edges = datasheet.edges;
    PrintTrackingRow("identified, edges of the datasheet", Follow(truth, edges, options.seed));
    modulus.K = datasheet.K;
    PrintTrackingRow("identified, bulk modulus of the datasheet", Follow(truth, modulus, options.seed));
    rigid.rigid = datasheet.rigid;
    PrintTrackingRow("identified, rigid bodies of the CAD", Follow(truth, rigid, options.seed));
    halved = halved && to.rms <= kGoal * from.rms;
  }
  const ControllerModel model =
      Identify(PublishedManipulator(), DrawnMotion(options.seed), options.seconds, options.seed).model;
  const ControllerGains gains = GainsOf(model, {});
  fmt::print(
      "gains from the identified values: k_p {:g} 1/s, k_v {:.3g}, {:.3g} N m s, k_f "
      "{:.3g}, {:.3g} m2/(s N), k_x {:g} m\n",
      gains.k_p, gains.k_v[0], gains.k_v[1], gains.k_f[0], gains.k_f[1], gains.k_x);
  return halved;
}

}  // namespace hydroscope
