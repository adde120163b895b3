#include "simulator/test_cylinder/test_cylinder.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/machines/machines.h"
#include "cli/machines/simulated_log.h"
#include "cli/study_command.h"
#include "studies/test_cylinder_benchmark.h"

namespace hydroscope {
namespace {

struct TestCylinderArguments {
  SimulatedLogFiles files;
  std::string valve = "19";
  double noise_factor = 1;
  TestCylinderOptions options;
};

nlohmann::json TestCylinderTruthJson(const TestCylinderOptions& o) {
  const TestCylinderTruth truth = TruthOf(o);
  return {{"parameters",
           {{"f_h", truth.f_h},
            {"zeta_h", truth.zeta_h},
            {"f_sv", truth.f_sv},
            {"K_sv", truth.K_sv},
            {"T_d", truth.T_d}}},
          {"excitation", o.excitation},
          {"noise", {{"z", o.noise}, {"disturbance", o.disturbance}}},
          {"effects",
           {{"coulomb", o.coulomb},
            {"sensor_delay", o.sensor_delay},
            {"saturation", o.saturation},
            {"trapped_air", o.trapped_air},
            {"specimen", o.specimen},
            {"leakage", o.leakage},
            {"square_root_valve", o.square_root_valve},
            {"leak_share", o.leak_share}}},
          {"drift",
           {{"f_h", o.drift.f_h},
            {"zeta_h", o.drift.zeta_h},
            {"f_sv", o.drift.f_sv},
            {"K_sv", o.drift.K_sv},
            {"from", o.drift.from}}},
          {"seed", o.seed},
          {"seconds", o.seconds},
          {"sample_period", o.sample_period}};
}

Status WriteTestCylinder(const TestCylinderArguments& a, const CLI::App& app) {
  TestCylinderOptions o = a.options;
  if (a.valve == "38") {
    if (app.count("--K-sv") == 0) o.K_sv = kGainOf38;
    if (app.count("--zeta-h") == 0) o.zeta_h = kZetaWith38;
  }
  o.noise *= a.noise_factor;
  o.disturbance *= a.noise_factor;
  TRY(Validate(o));
  return WriteSimulated(a.files, FormatTestCylinder(SimulateTestCylinder(o)), TestCylinderTruthJson(o));
}

}  // namespace

void AddSimulateTestCylinder(CLI::App& simulate, int& exit_code) {
  CLI::App* app = simulate.add_subcommand(
      "test-cylinder", "A servo-hydraulic test cylinder in closed position control: a log as CSV");
  app->option_defaults()->always_capture_default();
  auto a = std::make_shared<TestCylinderArguments>();
  TestCylinderOptions& o = a->options;
  AddFiles(*app, a->files);
  app->add_option("--seconds", o.seconds, "Length in s");
  app->add_option("--seed", o.seed, "Seed of excitation, disturbance and noise");
  app->add_option("--valve", a->valve, "Published valve: 19 or 38 l/min")->check(CLI::IsMember({"19", "38"}));
  app->add_option("--f-h", o.f_h, "Natural frequency of the oil column, Hz");
  app->add_option("--zeta-h", o.zeta_h, "Its damping (38 l/min: 1.0012)");
  app->add_option("--f-sv", o.f_sv, "Corner frequency of the valve, Hz");
  app->add_option("--K-sv", o.K_sv, "Flow gain of the valve, m3/(s A) (38 l/min: 0.023)");
  app->add_option("--leak-share", o.leak_share, "Share of the damping that leakage causes");
  app->add_option("--excitation", o.excitation, "Standard deviation of the current, A");
  app->add_option("--noise", a->noise_factor,
                  "Noise of the reading (2 um) and disturbance of the valve (0.5 mA), times")
      ->check(CLI::Range(0.0, 1e5));
  app->add_option("--trapped-air", o.trapped_air, "Share of the chambers' volume");
  app->add_option("--specimen", o.specimen, "Stiffness of the specimen, N/m");
  app->add_option("--leakage", o.leakage, "Leakage that appears across the piston, m3/(s Pa)");
  app->add_option("--sensor-delay", o.sensor_delay, "Delay of the position's reading, s");
  app->add_option("--saturation", o.saturation, "Current above which the valve does not follow, A; 0 = none");
  app->add_option("--coulomb", o.coulomb, "Coulomb friction, N");
  app->add_flag("--square-root-valve", o.square_root_valve,
                "Flow with the root of the pressure left over the edges");
  app->add_option("--drift-f-h", o.drift.f_h, "Share per s by which the natural frequency changes");
  app->add_option("--drift-zeta-h", o.drift.zeta_h, "... the damping");
  app->add_option("--drift-f-sv", o.drift.f_sv, "... the valve's corner frequency");
  app->add_option("--drift-K-sv", o.drift.K_sv, "... the flow gain");
  app->add_option("--drift-from", o.drift.from, "... from this time on, s");
  app->add_option("--sample-period", o.sample_period, "Of log and controller, s");
  app->footer(
      "Examples:\n"
      "  hydroscope simulate test-cylinder --out cylinder.csv --truth cylinder.json\n"
      "  hydroscope simulate test-cylinder --out exchanged.csv --valve 38 --seed 2\n"
      "  hydroscope simulate test-cylinder --out air.csv --trapped-air 0.003 --seed 3\n"
      "  hydroscope simulate test-cylinder --out worn.csv --seconds 3600 --drift-K-sv=-1e-4 --drift-from 2400");
  RunsAs(*app, exit_code, [a, app] { return WriteTestCylinder(*a, *app); });
}

void AddBenchmarkTestCylinder(CLI::App& benchmark, int& exit_code) {
  const auto [app, o] = AddStudy(
      benchmark, "test-cylinder",
      "Test cylinder in closed loop: our figures beside the published ones, and what changed between two records",
      RunTestCylinderBenchmark, exit_code);
  app->add_option("--seeds", o->seeds, "Records of each valve")->check(CLI::PositiveNumber);
  app->add_option("--changes", o->changes, "Pairs of records of each change")->check(CLI::PositiveNumber);
  AddJobs(*app, o->threads);
  app->add_option("--seed", o->seed, "Seed of the first record");
  app->footer("Example:\n  hydroscope benchmark test-cylinder --seeds 10 --changes 3");
}

}  // namespace hydroscope
