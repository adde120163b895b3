#include "studies/own_machines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/contains.h"
#include "diagnosis/sample_grams.h"
#include "models/machine_kind.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {
namespace {

constexpr double kLastingPart = 0.85;  // from row to row
constexpr double kPeriod = 0.01;       ///< s
constexpr double kArea = 5.2e-4;       ///< m^2
constexpr double kOffset = 1.0;        ///< N

struct Law {
  const char* id;
  const char* expression;
  double (*value)(double p, double v, double x);
};

double Sign(double v) { return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0; }

/// Written twice: for the machine file and, apart from it, for the simulation.
const std::vector<Law>& Laws() {
  static const std::vector<Law> laws = {
      {"coulomb", "sign(ddt(x))", [](double, double v, double) { return Sign(v); }},
      {"viscous", "ddt(x)", [](double, double v, double) { return v; }},
      {"pressure", "p*sign(ddt(x))", [](double p, double v, double) { return p * Sign(v); }},
      {"pressure_squared", "p^2*sign(ddt(x))", [](double p, double v, double) { return p * p * Sign(v); }},
      {"drag", "ddt(x)*abs(ddt(x))", [](double, double v, double) { return v * std::abs(v); }},
      {"pressure_viscous", "p*ddt(x)", [](double p, double v, double) { return p * v; }},
      {"stribeck", "sign(ddt(x))*exp(-abs(ddt(x))/0.006)",
       [](double, double v, double) { return Sign(v) * std::exp(-std::abs(v) / 0.006); }},
      {"spring", "x", [](double, double, double x) { return x; }},
  };
  return laws;
}

const Law& LawOf(const std::string& id) {
  return *std::ranges::find_if(Laws(), [&](const Law& law) { return id == law.id; });
}

/// Samples of one stroke.
struct Course {
  std::vector<double> p, v, x;
};

Course Drawn(std::mt19937_64& random, double direction) {
  std::uniform_real_distribution<double> uniform;
  Course out;
  const double pressure = 1e5 * (1 + 6 * uniform(random));
  const double speed = direction * (0.003 + 0.027 * uniform(random));
  const double swing = 0.3 * uniform(random), phase = 6.28 * uniform(random), drop = 0.1 * uniform(random);
  double x = direction > 0 ? 0.0 : 0.06;
  for (int k = 0; k < 200; ++k) {
    const double t = k * kPeriod;
    out.p.push_back(pressure * (1 - drop * t / 2 + 0.02 * std::sin(5 * t + phase)));
    out.v.push_back(speed * (1 + swing * std::sin(4 * t + phase)));
    out.x.push_back(x);
    x += kPeriod * out.v.back();
  }
  return out;
}

double Rms(const std::vector<Course>& courses, const Law& law) {
  double sum = 0, count = 0;
  for (const Course& c : courses)
    for (std::size_t k = 0; k < c.p.size(); ++k, ++count)
      sum += std::pow(law.value(c.p[k], c.v[k], c.x[k]), 2);
  return std::sqrt(sum / count);
}

Stretch Measured(const Course& course, const std::vector<double>& force, const ModelStructure& model,
                 std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Stretch stretch;
  stretch.samples = static_cast<int>(force.size());
  stretch.period = kPeriod;
  stretch.channel.assign(model.channel_names.size(), std::vector<double>(force.size()));
  for (std::size_t c = 0; c < model.channel_names.size(); ++c)
    for (std::size_t k = 0; k < force.size(); ++k) {
      const std::string& name = model.channel_names[c];
      if (name == "F") stretch.channel[c][k] = force[k];
      if (name == "p") stretch.channel[c][k] = course.p[k] + 50 * normal(random);
      if (name == "x") stretch.channel[c][k] = course.x[k] + 2e-6 * normal(random);
    }
  return stretch;
}

/// Samples `from` ... `to` of a stroke, with what was measured right before and after.
Stretch PartOfStroke(const Stretch& whole, int from, int to) {
  constexpr int kBeyond = 20;  // samples, twice the half width of ddt
  Stretch part = whole;
  part.samples = to - from + 1;
  part.before = std::min(from, kBeyond);
  part.after = std::min(whole.samples - 1 - to, kBeyond);
  part.continues = from > 0;
  for (std::size_t c = 0; c < whole.channel.size(); ++c)
    part.channel[c].assign(whole.channel[c].begin() + from - part.before,
                           whole.channel[c].begin() + to + 1 + part.after);
  return part;
}

/// As the pipeline cuts strokes: stretches of a span, each from the last sample of the one before.
StrokeStretches InSpans(const Stretch& whole, const WindowSamples& window) {
  const int span = window.span * window.block;
  StrokeStretches out = {PartOfStroke(whole, 0, span - 1)};
  for (int last = span - 1; last + span < whole.samples; last += span)
    out.push_back(PartOfStroke(whole, last, last + span));
  return out;
}

std::vector<std::string> DrawnTruth(std::mt19937_64& random) {
  std::vector<std::string> ids;
  for (const Law& law : Laws()) ids.push_back(law.id);
  std::ranges::shuffle(ids, random);
  ids.resize(random() % 4);
  return ids;
}

/// Whether every hidden effect has a group that holds it.
bool AllInSet(const Explanation& x, const std::vector<std::string>& hidden) {
  return x.groups.size() == hidden.size() && std::ranges::all_of(hidden, [&](const auto& id) {
           return std::ranges::any_of(x.groups, [&](const auto& group) { return Contains(group, id); });
         });
}

bool NamesWhatIsNotThere(const Explanation& x, const std::vector<std::string>& hidden) {
  return std::ranges::any_of(x.groups, [&](const auto& group) {
    return std::ranges::none_of(group, [&](const auto& id) { return Contains(hidden, id); });
  });
}

void Count(const Explanation& x, const std::vector<std::string>& hidden, OwnMachinesScore& score) {
  ++score.cases;
  score.unknown += x.verdict == Verdict::kUnknown;
  score.adequate += x.verdict == Verdict::kAdequate;
  score.wrong += NamesWhatIsNotThere(x, hidden);
  const bool all = hidden.empty() ? x.verdict == Verdict::kAdequate : AllInSet(x, hidden);
  score.in_set += all;
  score.exact += all && std::ranges::all_of(
                            x.groups, [&](const auto& group) { return Contains(hidden, group.front()); });
  if (!hidden.empty())
    score.set_size += static_cast<double>(x.set.size()) / static_cast<double>(hidden.size());
}

/// A machine with one law, of those of the machine file that leaves it out.
void CountAbsent(std::mt19937_64& random, OwnMachinesScore& score) {
  const Law& law = Laws()[random() % Laws().size()];
  OwnMachineCase simulated{.hidden = {law.id}};
  simulated.size = std::uniform_real_distribution<double>(1.0, 6.0)(random);
  simulated.seed = random();
  Machine machine = OwnMachine();
  std::erase_if(machine.user_effects, [&](const auto& effect) { return effect.id == law.id; });
  const auto result = ExplainStrokes(OwnMachineStrokes(simulated, machine));
  if (!result) return;
  const Explanation& x = result->explanation;
  ++score.absent;
  score.absent_named += !x.set.empty() && !x.partial;
  score.absent_in_doubt += !x.set.empty() && x.partial;
}

}  // namespace

Machine OwnMachine() {
  Machine machine;
  machine.name = "own_cylinder";
  machine.model = OwnKind().id;
  for (const auto& [name, unit] : {std::pair("F", "N"), std::pair("x", "m"), std::pair("p", "Pa")}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    signal.unit = unit;
    machine.signals.push_back(signal);
  }
  machine.window = {0.05, 1.0, 0.1};
  machine.balance.output = "F";
  machine.balance.unit = "N";
  machine.balance.terms = {{"A", "p", "m2"}, {"c", "1", "N"}};
  for (const Law& law : Laws())
    machine.user_effects.push_back({law.id, law.id, {{std::string("k_") + law.id, law.expression, ""}}});
  return machine;
}

LogStrokes OwnMachineStrokes(const OwnMachineCase& simulated, const Machine& machine) {
  std::mt19937_64 random(simulated.seed);
  std::normal_distribution<double> normal;
  LogStrokes out;
  out.machine = machine;
  const auto model = BuildModel(machine);
  if (!model) return out;
  out.model = *model;
  out.window = WindowSamples::From(machine.window, kPeriod);
  out.window.level_form = out.model->level_form;
  std::vector<Course> courses;
  for (int s = 0; s < simulated.strokes; ++s) courses.push_back(Drawn(random, s % 2 == 0 ? 1.0 : -1.0));
  for (const Course& course : courses) {
    std::vector<double> force;
    const double common = simulated.unmodelled * normal(random);
    double lasting = 0;
    for (std::size_t k = 0; k < course.p.size(); ++k) {
      double f = kArea * course.p[k] + kOffset + common + simulated.noise * normal(random);
      if (simulated.lasting > 0) {
        lasting = kLastingPart * lasting +
                  std::sqrt(1 - kLastingPart * kLastingPart) * simulated.lasting * normal(random);
        f += lasting;
      }
      for (const std::string& id : simulated.hidden)
        f +=
            simulated.size / Rms(courses, LawOf(id)) * LawOf(id).value(course.p[k], course.v[k], course.x[k]);
      force.push_back(f);
    }
    out.stretches.push_back(InSpans(Measured(course, force, *out.model, random), out.window));
  }
  for (const StrokeGram& gram : GramsOf(out.model, out.stretches, out.window)) {
    out.strokes.emplace_back();
    out.strokes.back().gram = gram;
  }
  return out;
}

OwnMachinesScore ScoreOwnMachines(const OwnMachinesOptions& options) {
  OwnMachinesScore score;
  std::mt19937_64 random(options.seed);
  const Machine machine = OwnMachine();
  int with_effects = 0;
  for (int k = 0; k < options.cases; ++k) {
    OwnMachineCase simulated;
    simulated.hidden = DrawnTruth(random);
    simulated.size = std::uniform_real_distribution<double>(1.0, 6.0)(random);
    simulated.unmodelled = k % 3 == 2 ? 0.1 : 0.0;
    simulated.seed = random();
    with_effects += simulated.hidden.empty() ? 0 : 1;
    const auto result = ExplainStrokes(OwnMachineStrokes(simulated, machine));
    if (result) Count(result->explanation, simulated.hidden, score);
  }
  score.set_size /= std::max(1, with_effects);
  for (int k = 0; k < options.cases / 2; ++k) CountAbsent(random, score);
  return score;
}

int RunOwnMachines(const OwnMachinesOptions& options) {
  constexpr double kMostWrong = 0.02, kLeastInSet = 0.85, kMostAbsentNamed = 0.05;
  const OwnMachinesScore score = ScoreOwnMachines(options);
  fmt::print(
      "{} cylinders of their own, 0 ... 3 of 8 effects hidden\n"
      "  hidden effects first          {:>4}\n"
      "  hidden effects in the set     {:>4}\n"
      "  a name that is not there      {:>4}\n"
      "  unknown                       {:>4}\n"
      "  adequate                      {:>4}\n"
      "  effects named per hidden one  {:>4.2f}\n"
      "{} with one law that the machine file lacks\n"
      "  others named in its place     {:>4}\n"
      "  the same, said to be unproven {:>4}\n",
      score.cases, score.exact, score.in_set, score.wrong, score.unknown, score.adequate, score.set_size,
      score.absent, score.absent_named, score.absent_in_doubt);
  const bool right = score.wrong <= kMostWrong * score.cases && score.in_set >= kLeastInSet * score.cases &&
                     score.absent_named <= kMostAbsentNamed * score.absent;
  fmt::print(
      "required: wrong at most {:.0f} %, in the set at least {:.0f} %, named in place of a law that is not there at "
      "most {:.0f} % ({})\n",
      100 * kMostWrong, 100 * kLeastInSet, 100 * kMostAbsentNamed, right ? "yes" : "NO");
  return right ? 0 : 1;
}

}  // namespace hydroscope
