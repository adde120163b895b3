#include "machines/die_cushion/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/quantile.h"
#include "machines/die_cushion/balance.h"
#include "machines/die_cushion/library.h"
#include "models/smooth_rate.h"

namespace hydroscope {
namespace {

/// How a die cushion is asked for strokes, and how it answers.
struct CushionPractice {
  double warm_up = 3600;        ///< s of waiting that warming the oil costs
  double rod_change = 30;       ///< s that another pressure in chamber B costs, each time
  double step_time = 0.05;      ///< s, time constant of a pressure step
  double usable_opening = 0.8;  ///< pressures are raised so that less is enough
  double slowest = 1e-3;        ///< m/s, below which nobody runs a ram, ...
  double lowest = 5e5;          ///< ... Pa, nor holds a cushion, if the machine file does not say so
  double rare = 0.05;           ///< share of what was recorded, at either end, that is not asked for again
  double shortest = 0.01;       ///< m, of a stroke
  double rod = 60e5, supply = 210e5;  ///< Pa, of chamber B and supply, where they are not measured
  double oil = 313.15;                ///< K, where it is not measured
};
constexpr CushionPractice kPractice{};

constexpr double kNoisySensors = 3;  ///< of pressure, position and spool, each in every played row
constexpr double kMostDraws = 1e5;   ///< of their noise; longer strokes begin again with the first

constexpr std::array<StrokeSetting, kCushionSettings> kSettings = {{
    {.key = "ram_speed", .si = "m/s", .levels = "speeds", .unit_key = "speed_unit"},
    {.key = "pressure", .si = "Pa", .levels = "pressures", .unit_key = "pressure_unit"},
    {.key = "rod_pressure", .si = "Pa", .levels = "rod_pressures"},
    {.key = "warm_up", .si = "K", .range = false, .levels = "warm_up"},
}};

/// Median over the stretches of what a channel reads at their beginning; `none` where it is not measured.
double Typical(std::span<const StrokeStretches> strokes, int channel, double none) {
  std::vector<double> values;
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& stretch : stroke)
      if (!stretch.channel[channel].empty() && stretch[channel][0] != 0)
        values.push_back(stretch[channel][0]);
  return Median(std::move(values), none);
}

/// Median over the stretches of the standard deviation of a channel's white noise.
double NoiseOf(std::span<const StrokeStretches> strokes, int channel) {
  std::vector<double> variances;
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& stretch : stroke)
      variances.push_back(WhiteNoiseVariance(stretch[channel], stretch.samples));
  return std::sqrt(Median(std::move(variances), 0));
}

/// From ... to.
struct Levels {
  double low = 0, high = 0;
};

class CushionExperimenter final : public Experimenter {
 public:
  CushionExperimenter(const Machine& machine, std::span<const StrokeStretches> recorded)
      : piston_area_(CushionGeometryOf(machine).piston_area),
        rod_(Typical(recorded, kPressureB, kPractice.rod)),
        supply_(Typical(recorded, kSupplyPressure, kPractice.supply)),
        oil_(Typical(recorded, kOilTemperature, kPractice.oil)),
        p_noise_(NoiseOf(recorded, kPressureA)),
        z_noise_(NoiseOf(recorded, kPosition)),
        y_noise_(NoiseOf(recorded, kSpool)) {
    std::vector<double> speeds, pressures;
    double top = 0, bottom = std::numeric_limits<double>::infinity(), period = 0;
    for (const StrokeStretches& stroke : recorded)
      for (const Stretch& stretch : stroke) {
        period = stretch.period;
        const double *z = stretch[kPosition], *p = stretch[kPressureA];
        speeds.push_back((z[0] - z[stretch.samples - 1]) / ((stretch.samples - 1) * stretch.period));
        pressures.insert(pressures.end(), p, p + stretch.samples);
        top = std::max(top, z[0]);
        bottom = std::min(bottom, z[stretch.samples - 1]);
      }
    stroke_ = std::max(kPractice.shortest, top - bottom);
    const auto allowed = [&](CushionSetting setting, double low, double high) {
      const ExperimentSpec::Limits limits = machine.experiment.Of(kSettings[setting].key);
      const double from = limits.min.value_or(low);
      return Levels{from, std::max(from, limits.max.value_or(high))};
    };
    const auto as_recorded = [&](CushionSetting setting, double least, const std::vector<double>& values) {
      return allowed(setting, std::max(least, Quantile(values, kPractice.rare, 0)),
                     Quantile(values, 1 - kPractice.rare, 0));
    };
    speed_ = as_recorded(kRamSpeed, kPractice.slowest, speeds);
    pressure_ = as_recorded(kCushionPressure, kPractice.lowest, pressures);
    rods_ = allowed(kRodPressure, rod_, rod_);
    warm_up_ = machine.experiment.Of(kSettings[kWarmUp].key).max.value_or(0);
    for (const GateBound& bound : machine.gate.bounds)
      if (bound.signal == kCushionChannels[kSpool] && !bound.rate && bound.min)
        min_opening_ = std::max(min_opening_, *bound.min);
    const double draws = kNoisySensors * stroke_ / speed_.low / period;  // of the longest stroke
    normals_.resize(static_cast<std::size_t>(draws > 1 ? std::min(draws, kMostDraws) : 1));
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (double& draw : normals_) draw = normal(random);
  }

  std::vector<StrokeSeries> Candidates() const override {
    std::vector<StrokeSeries> out;
    for (const auto& pressures : PressureProfiles())
      for (const auto& speeds : SpeedSeries())
        for (const auto& rods : RodSeries())
          for (const auto& warm_up : WarmUps()) out.push_back({speeds, pressures, rods, warm_up});
    return out;
  }

  /// Every speed at every pressure of chamber B, at the beginning of the series and at the end of the shortest one: what
  /// drifts goes on.
  std::vector<UnrecordedStroke> StrokesOf(const StrokeSeries& series, double begin,
                                          int fewest) const override {
    const double end = begin + ShortestSeries(fewest);
    std::vector<UnrecordedStroke> out;
    for (const double rod : series[kRodPressure].empty() ? std::vector{rod_} : series[kRodPressure])
      for (const double speed : series[kRamSpeed]) {
        out.push_back({{{speed}, series[kCushionPressure], {rod}, {}}, begin});
        out.push_back({{{speed}, series[kCushionPressure], {rod}, series[kWarmUp]}, end});
      }
    return out;
  }

  /// The spool stands where the base balance wants it. Pressures that would open it too far are raised; spans in which the
  /// gate would shut are left out.
  StrokeStretches Play(const ModelStructure& model, const Eigen::VectorXd& theta,
                       const UnrecordedStroke& played, const StrokeSampling& sampling,
                       PlayedNoise sensors) const override {
    const double period = sampling.period, speed = played.levels[kRamSpeed].front();
    const std::vector<double>& pressures = played.levels[kCushionPressure];
    const std::vector<double>& warmer = played.levels[kWarmUp];
    const int samples = static_cast<int>(stroke_ / speed / period), span = sampling.span_samples;
    const double least = std::pow(piston_area_ * speed / (kPractice.usable_opening * std::abs(theta[0])), 2);
    std::size_t drawn = 0;
    const auto noise = [&](double std) {
      return sensors == PlayedNoise::kNone ? 0.0 : std * normals_[drawn++ % normals_.size()];
    };
    StrokeStretches out;
    double p = std::max(least, pressures.front());
    for (int first = 0; first + span <= samples; first += span) {
      Stretch stretch;
      stretch.period = period;
      stretch.samples = span;
      stretch.begin = played.begin + first * period;
      stretch.channel.assign(model.channel_names.size(), std::vector<double>(span, 0.0));
      bool open = true;
      for (int k = 0; k < span; ++k) {
        const std::size_t phase = pressures.size() * static_cast<std::size_t>(first + k) / samples;
        const double rate = (std::max(least, pressures[phase]) - p) / kPractice.step_time;
        p += rate * period;
        const double z = stroke_ - speed * (first + k) * period, root = std::sqrt(p);
        // A dz/dt = theta1 root y + (theta2 + theta3 z) dp/dt + theta4 root, solved for y.
        const double y =
            (-piston_area_ * speed - (theta[1] + theta[2] * z) * rate - theta[3] * root) / (theta[0] * root);
        open = open && y > min_opening_ && y < 1.0;
        stretch.channel[kPressureA][k] = p + noise(p_noise_);
        stretch.channel[kPosition][k] = z + noise(z_noise_);
        stretch.channel[kSpool][k] = y + noise(y_noise_);
        stretch.channel[kPressureB][k] = played.levels[kRodPressure].front();
        stretch.channel[kSupplyPressure][k] = supply_;
        stretch.channel[kOilTemperature][k] = oil_ + (warmer.empty() ? 0.0 : warmer.front());
      }
      if (open) out.push_back(std::move(stretch));
    }
    return out;
  }

  double Seconds(const StrokeSeries& series, int strokes) const override {
    double seconds = 0;
    for (const double speed : series[kRamSpeed])
      seconds += strokes * stroke_ / speed / static_cast<double>(series[kRamSpeed].size());
    return seconds;
  }

  double Price(const StrokeSeries& series, double seconds) const override {
    return seconds + (series[kWarmUp].empty() ? 0 : kPractice.warm_up) +
           kPractice.rod_change * static_cast<double>(series[kRodPressure].size());
  }

 private:
  std::vector<std::vector<double>> PressureProfiles() const {
    const double low = pressure_.low, high = pressure_.high;
    const auto at = [&](double share) { return low + share * (high - low); };
    return {{low, high},
            {high, low, high},
            {low, high, low, high},
            {low, high, low, high, low, high, low, high},
            {low, at(0.5), high, at(0.5), low},
            {low, at(0.1), at(0.3), at(0.6), high},
            {low, at(0.2), low, at(0.2), low, at(0.5)},
            {low, high, high},
            {high},
            {at(0.5)},
            {low}};
  }
  std::vector<std::vector<double>> SpeedSeries() const {
    const double slow = speed_.low, fast = speed_.high, middle = 0.5 * (slow + fast);
    return {{slow, fast}, {slow, middle, fast}, {slow}, {middle}, {fast}};
  }
  std::vector<std::vector<double>> RodSeries() const {
    if (rods_.high <= rods_.low) return {{}};
    return {{}, {rods_.low, rods_.high}};
  }
  std::vector<std::vector<double>> WarmUps() const {
    if (warm_up_ <= 0) return {{}};
    return {{}, {warm_up_}};
  }
  /// s, at a middling speed, upwards as downwards.
  double ShortestSeries(int strokes) const {
    return strokes * 2 * stroke_ / (0.5 * (speed_.low + speed_.high));
  }

  double piston_area_;                  ///< m^2
  double rod_, supply_, oil_;           ///< Pa, Pa, K, as recorded, medians
  double p_noise_, z_noise_, y_noise_;  ///< Pa, m, 1: std of the sensor noise as recorded, white part
  double stroke_ = 0;                   ///< m
  Levels speed_, pressure_, rods_;      ///< m/s, Pa, Pa
  double warm_up_ = 0;                  ///< K; 0 = the oil is not warmed
  double min_opening_ = 0;              ///< spool position below which the gate shuts
  std::vector<double> normals_;         ///< noise of every played stroke, in standard deviations
};

std::unique_ptr<Experimenter> ExperimenterOn(const Machine& machine,
                                             std::span<const StrokeStretches> recorded) {
  return std::make_unique<CushionExperimenter>(machine, recorded);
}

Told SeriesText(const StrokeSeries& series, int strokes, double seconds) {
  const auto list = [&](CushionSetting setting, double factor, const char* between) {
    std::string text;
    for (double v : series[setting]) text += fmt::format("{}{:.0f}", text.empty() ? "" : between, v * factor);
    return text;
  };
  std::vector<Told> parts = {Tell("Record {} strokes at {} mm/s ram speed{}",
                                  "{} Hübe bei {} mm/s Stößelgeschwindigkeit{} aufzeichnen", strokes,
                                  list(kRamSpeed, 1e3, ", "),
                                  series[kRamSpeed].size() > 1 ? Tell(" in turn", " nacheinander") : Told{})};
  parts.push_back(series[kCushionPressure].size() == 1
                      ? Tell("holding {} bar cushion pressure", "mit {} bar Kissendruck",
                             list(kCushionPressure, 1e-5, ""))
                      : Tell("stepping the cushion pressure {} bar within each stroke",
                             "den Kissendruck in jedem Hub in Stufen von {} bar",
                             list(kCushionPressure, 1e-5, " -> ")));
  if (!series[kRodPressure].empty())
    parts.push_back(Tell("with {} bar in chamber B, changed after each round of speeds",
                         "mit {} bar in Kammer B, geändert nach jeder Runde von Geschwindigkeiten",
                         Told(list(kRodPressure, 1e-5, " and "), list(kRodPressure, 1e-5, " und "))));
  if (!series[kWarmUp].empty())
    parts.push_back(Tell("the oil warming by {} K on the way", "das Öl dabei um {} K wärmer werdend",
                         list(kWarmUp, 1, "")));
  return Tell("{} ({:.0f} s of drawing)", "{} ({:.0f} s Ziehen)", Joined(parts), seconds);
}

}  // namespace

const ExperimentRules kCushionExperiment = {.settings = kSettings, .on = ExperimenterOn, .text = SeriesText};

}  // namespace hydroscope
