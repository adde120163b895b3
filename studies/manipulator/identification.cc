#include "studies/manipulator/identification.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <mutex>

#include "core/constants.h"
#include "studies/parallel.h"

namespace hydroscope {
namespace {

constexpr double kLeastHeld = 0.93, kMostHeld = 0.97;  // of all intervals

/// Truth of a column of the linear form.
double TrueColumn(const std::map<std::string, double>& truth, const std::string& name) {
  return name.starts_with("1/") ? 1 / truth.at(name.substr(2)) : truth.at(name);
}

struct ParameterScore {
  int held = 0, cases = 0;
  double squares = 0, worst = 0;
};

}  // namespace

IdentifiedManipulator Identify(const ManipulatorTruth& truth, const ManipulatorMotion& motion, double seconds,
                               std::uint64_t seed) {
  ManipulatorOptions options;
  options.truth = truth;
  options.motion = motion;
  options.model = DatasheetModel(truth);
  options.seconds = seconds;
  options.seed = seed;
  const Machine machine = ManipulatorMachine(truth);
  const Episode episode = EpisodeOf(SimulateManipulator(options));
  IdentifiedManipulator out;
  out.fit = FitLinearForm(LinearFormOf(machine), machine, std::span(&episode, 1));
  out.model =
      out.fit.solved() ? WithIdentified(options.model, out.fit.parameters, out.fit.value) : options.model;
  return out;
}

bool PrintIdentification(const ManipulatorBenchmarkOptions& options) {
  std::map<std::string, ParameterScore> scores;
  std::vector<std::string> order, base_texts;
  std::mutex mutex;
  double worst_condition = 0;
  int failed = 0;
  ProgressBar progress("identification", "machines");
  ForEachCase(
      options.cases, progress,
      [&](int number) {
        const std::uint64_t seed = options.seed * 1000 + number;
        const ManipulatorTruth truth = DrawnManipulator(seed);
        const IdentifiedManipulator found = Identify(truth, DrawnMotion(seed), options.seconds, seed);
        std::map<std::string, double> truths;
        for (const auto& [name, value] : TrueParameters(truth)) truths[name] = value;
        const std::lock_guard lock(mutex);
        failed += !found.fit.solved();
        if (!found.fit.solved()) return;
        worst_condition = std::max(worst_condition, found.fit.base.condition);
        if (number == 0) {
          const Machine machine = ManipulatorMachine(truth);
          order = found.fit.parameters;
          for (std::size_t k = 0; k < order.size(); ++k)
            base_texts.push_back(BaseParameterText(LinearFormOf(machine), found.fit.base, k));
        }
        for (std::size_t k = 0; k < found.fit.parameters.size(); ++k) {
          const auto at = static_cast<Eigen::Index>(k);
          const std::string& name = found.fit.parameters[k];
          const double is = TrueColumn(truths, name), error = found.fit.value[at] - is;
          ParameterScore& score = scores[name];
          ++score.cases;
          score.held += std::abs(error) <= kNormal95 * found.fit.std[at];
          score.squares += std::pow(error / is, 2);
          score.worst = std::max(score.worst, std::abs(error / is));
        }
      },
      options.threads);
  fmt::print(
      "{} drawn machines, {:g} s each, by rank revealing QR: {}\n\nparameter   held   rms error  worst\n",
      options.cases, options.seconds, fmt::join(base_texts, ", "));
  int held = 0, all = 0;
  for (const std::string& name : order) {
    const ParameterScore& s = scores[name];
    held += s.held;
    all += s.cases;
    fmt::print("{:<10} {:>3}/{:<3} {:>8.3f} % {:>6.2f} %\n", name, s.held, s.cases,
               100 * std::sqrt(s.squares / s.cases), 100 * s.worst);
  }
  fmt::print(
      "95 % intervals hold the truth in {} of {} ({:.1f} %); scaled condition at most {:.1f}; {} not fitted\n",
      held, all, 100.0 * held / std::max(all, 1), worst_condition, failed);
  return failed == 0 && held >= kLeastHeld * all && held <= kMostHeld * all;
}

}  // namespace hydroscope
