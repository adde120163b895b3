#include "simulator/die_cushion/press.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/delay_line.h"
#include "simulator/die_cushion/controller.h"
#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/motion.h"
#include "simulator/die_cushion/plant.h"
#include "simulator/die_cushion/sensor_imperfections.h"
#include "simulator/die_cushion/valve.h"

namespace hydroscope {
namespace {

/// Options with the seeds drawn, and the periods and the motion that count.
PressOptions Settled(PressOptions options) {
  if (options.control_seed == 0) options.control_seed = StreamSeed(options.seed, "control seed");
  if (options.noise_seed == 0) options.noise_seed = StreamSeed(options.seed, "noise seed");
  const auto list = ResolveImperfections(options.imperfections).value();
  if (const auto* slow = FindImperfection(list, ImperfectionKind::kSlowSampling))
    options.sample_period = slow->size;
  if (const auto* slow = FindImperfection(list, ImperfectionKind::kSlowControl))
    options.sample_period = options.control_period = slow->size;
  if (const auto* calm = FindImperfection(list, ImperfectionKind::kCalmPressure)) {
    options.motion.step_time_min = options.motion.step_time_max = calm->size;
    options.motion.wander = options.motion.dither = 0;
  }
  return options;
}

/// What is logged of a true row with this white noise; false if the row is lost.
bool ReadRow(const PressOptions& options, const std::array<double, 7>& white, SensorImperfections& sensors,
             FaultInjector& faults, PressRow& row) {
  sensors.Distort(row);
  ReadSensors(options.noise, options.quantum, sensors.Noise(white), row);
  const bool sent = sensors.Transport(row);
  return faults.Apply(row) && sent;
}

/// A supply pressure that breathes slowly.
double Breathing(double mean, double amplitude, double period, double t) {
  return mean + amplitude * std::sin(2 * std::numbers::pi * t / period);
}

}  // namespace

struct PressGenerator::State {
  /// Whole numbers of controller cycles per sample and of integration steps per cycle.
  struct Grid {
    Grid(const PressOptions& o, const PressEffectSizes& effects, const PlantLaws& laws, double leakage);
    std::int64_t cycles_per_sample, steps_per_cycle;
    double cycle, step;  // s
  };

  explicit State(const PressOptions& given)
      : options(Settled(given)),
        imperfections(ResolveImperfections(options.imperfections).value()),
        effects(ResolveEffects(given.effects).value()),
        active(effects),
        moments(imperfections, options.seconds, options.seed),
        grid(options, effects, PlantLawsOf(imperfections), moments.most_leakage()),
        motion(options.motion, options.seed),
        set_point(options.machine, options.motion, options.control_seed),
        controller(options.machine, options.motion, grid.cycle, options.control_seed),
        between_samples(StreamSeed(options.noise_seed, "controller readings")),
        valve(options.machine.valve_f0, options.machine.valve_damping, options.machine.valve_gain,
              options.machine.valve_dead_time, grid.step / 2),
        plant(options.machine, effects, grid.step, PlantLawsOf(imperfections)),
        noise(options.noise, options.noise_seed),
        sensors(imperfections, options),
        faults(options.faults),
        lag{FirstOrderLag(LagOf(ImperfectionKind::kPressureLag), grid.step),
            FirstOrderLag(LagOf(ImperfectionKind::kSpoolLag), grid.step),
            FirstOrderLag(LagOf(ImperfectionKind::kPositionLag), grid.step)},
        late_pressure(effects.pressure_delay + LateBy("p_A"), grid.step),
        late_spool(effects.spool_delay + LateBy("y_v"), grid.step),
        late_position(effects.position_delay + LateBy("z"), grid.step),
        total_rows(std::llround(options.seconds / options.sample_period)) {
    truth.options = options;
    plant.Reset(options.motion.rest_pressure);
    valve.Rest(options.machine.y_0);
    edge = valve.position();
    drive.ram[2] = motion.At(0);
    drive.opening[2] = edge - options.machine.y_0;
    PushSensors();
  }

  double OilTemperature(double t) const {
    return options.oil_start + (options.oil_end - options.oil_start) * t / options.seconds;
  }
  void PushSensors() {
    late_pressure.Push(lag[0].Step(plant.p_A()));
    late_spool.Push(lag[1].Step(valve.position()));
    late_position.Push(lag[2].Step(drive.ram[2].z));
  }
  double LagOf(ImperfectionKind kind) const;
  double LateBy(std::string_view channel) const;
  void Move(double t);
  PressRow CleanRow(double t) const;
  double RodPressure() const;
  void Control(double t, double pressure_noise);
  void Integrate(double t);
  void Track(double t);

  PressOptions options;
  std::vector<Imperfection> imperfections;
  PressEffectSizes effects, active;  // asked for, and in force at present
  PlantMoments moments;
  double y_0_shift = 0;
  bool effects_on = true;
  Grid grid;
  RamMotion motion;
  SetPoint set_point;
  PressureController controller;
  RandomStream between_samples;  // noise of readings that only the controller takes
  ServoValve valve;
  PressPlant plant;
  NoiseSource noise;
  SensorImperfections sensors;
  FaultInjector faults;
  FirstOrderLag lag[3];
  DelayLine late_pressure, late_spool, late_position;
  PressPlant::Drive drive;
  double edge = 0;     // position of the metering edge
  double command = 0;  // V
  std::int64_t row = 0, total_rows;
  std::array<double, 7> draw{};  // noise of the latest row
  PressTruth truth;
  std::int64_t stroke_rows = 0;
};

PressGenerator::State::Grid::Grid(const PressOptions& o, const PressEffectSizes& e, const PlantLaws& laws,
                                  double leakage) {
  PressEffectSizes effects = e;
  effects.internal_leakage = std::abs(e.internal_leakage) + leakage;
  const auto parts = [](double whole, double part) {
    return std::max<std::int64_t>(1, std::llround(std::ceil(whole / part - 1e-9)));
  };
  cycles_per_sample = parts(o.sample_period, o.control_period);
  cycle = o.sample_period / static_cast<double>(cycles_per_sample);
  const double z_low = o.motion.z_bottom - o.motion.z_bottom_spread;
  const double stable = 1 / PressPlant::StiffestRate(o.machine, effects, z_low, laws);
  steps_per_cycle = parts(cycle, std::min(o.max_step, stable));
  step = cycle / static_cast<double>(steps_per_cycle);
}

PressRow PressGenerator::State::CleanRow(double t) const {
  PressRow r;
  r.t = t;
  r.p_A = late_pressure.Read() + active.pressure_offset;
  r.p_B = drive.p_B;
  r.p_0 = drive.p_0;
  r.z = late_position.Read();
  r.y_v = late_spool.Read();
  r.U_v = command;
  r.T_oil = OilTemperature(t);
  return r;
}

double PressGenerator::State::RodPressure() const {
  const std::vector<double>& levels = options.motion.rod_pressures;
  if (levels.empty()) return options.machine.p_rod;
  const bool drawing = motion.phase() == PressPhase::kDraw || motion.phase() == PressPhase::kRestBottom;
  const auto next = static_cast<std::size_t>(std::max<std::int64_t>(0, motion.stroke() + (drawing ? 0 : 1)));
  return levels[next / std::max<std::size_t>(1, options.motion.speeds.size()) % levels.size()];
}

double PressGenerator::State::LagOf(ImperfectionKind kind) const {
  double lag = 0;
  for (const Imperfection& one : imperfections)
    if (one.kind == kind || one.kind == ImperfectionKind::kSignalLag) lag += one.size;
  return lag;
}

double PressGenerator::State::LateBy(std::string_view channel) const {
  const auto* early = FindImperfection(imperfections, ImperfectionKind::kOneSignalEarly);
  return early == nullptr || early->channel == ChannelIndex(channel) ? 0 : early->size;
}

/// Parameters that move, and effects that come and go.
void PressGenerator::State::Move(double t) {
  if (imperfections.empty()) return;
  const PlantMoments::Moment now = moments.At(t, OilTemperature(t), motion.stroke());
  drive.K_factor = now.K_factor;
  drive.V0_factor = now.V0_factor;
  drive.gain *= now.gain;
  drive.leakage = now.leakage;
  y_0_shift = now.y_0_shift;
  if (now.effects_on == effects_on) return;
  effects_on = now.effects_on;
  active = effects_on ? effects : PressEffectSizes{};
  plant.SetEffects(active);
}

void PressGenerator::State::Control(double t, double pressure_noise) {
  drive.p_B = Breathing(RodPressure(), 0.6e5, 17, t);
  drive.p_0 = Breathing(options.machine.p_supply, 0.5e5, 23, t);
  drive.gain = ViscosityGain(active, OilTemperature(t));
  Move(t);
  const RamMotion::Point ram = motion.At(t);
  const double wanted = set_point.At(t, grid.cycle, motion);
  command =
      controller.Command(plant.p_A() + active.pressure_offset + pressure_noise, wanted, ram, motion.phase());
}

void PressGenerator::State::Integrate(double t) {
  const double h = grid.step;
  for (std::int64_t k = 0; k < grid.steps_per_cycle; ++k) {
    const double begin = t + h * static_cast<double>(k);
    drive.ram[0] = drive.ram[2];
    drive.opening[0] = drive.opening[2];
    for (int half = 1; half <= 2; ++half) {
      drive.ram[half] = motion.At(begin + h / 2 * half);
      edge = EdgeWithPlay(active, valve.Step(command / 10), edge);
      drive.opening[half] = edge - options.machine.y_0 - y_0_shift;
    }
    if (moments.ripples()) drive.extra_flow = moments.Ripple(begin + h / 2);
    plant.Step(drive);
    PushSensors();
  }
}

void PressGenerator::State::Track(double t) {
  if (motion.phase() != PressPhase::kDraw) return;
  if (truth.strokes.empty() || truth.strokes.back().begin != motion.phase_begin()) {
    truth.strokes.emplace_back();
    StrokeTruth& stroke = truth.strokes.back();
    stroke.begin = motion.phase_begin();
    stroke.end = std::min(motion.phase_end(), options.seconds);
    stroke.speed = std::abs(motion.cruise_speed());
    stroke.z_begin = drive.ram[2].z;
    stroke.oil_temperature = OilTemperature(t);
    stroke_rows = 0;
  }
  StrokeTruth& stroke = truth.strokes.back();
  stroke.z_end = drive.ram[2].z;
  stroke.max_pressure = std::max(stroke.max_pressure, plant.p_A());
  stroke.mean_pressure += (plant.p_A() - stroke.mean_pressure) / static_cast<double>(++stroke_rows);
}

PressGenerator::PressGenerator(const PressOptions& options) : state_(std::make_unique<State>(options)) {}
PressGenerator::~PressGenerator() = default;
PressGenerator::PressGenerator(PressGenerator&&) noexcept = default;
PressGenerator& PressGenerator::operator=(PressGenerator&&) noexcept = default;

bool PressGenerator::NextClean(PressRow& row) {
  State& s = *state_;
  if (s.row == s.total_rows) return false;
  const double t = static_cast<double>(s.row) * s.options.sample_period;
  s.draw = s.noise.Next();
  s.Control(t, s.draw[0]);
  s.Track(t);
  row = s.CleanRow(t);
  for (std::int64_t cycle = 0; cycle < s.grid.cycles_per_sample; ++cycle) {
    const double begin = t + s.grid.cycle * static_cast<double>(cycle);
    if (cycle > 0) s.Control(begin, s.options.noise.p_A * s.between_samples.Normal());
    s.Integrate(begin);
  }
  ++s.row;
  return true;
}

bool PressGenerator::Next(PressRow& row) {
  State& s = *state_;
  while (NextClean(row))
    if (ReadRow(s.options, s.draw, s.sensors, s.faults, row)) return true;
  return false;
}

const std::array<double, 7>& PressGenerator::noise() const { return state_->draw; }
PressPhase PressGenerator::phase() const { return state_->motion.phase(); }

Status PressGenerator::SetEffects(const std::vector<EffectSetting>& settings) {
  State& s = *state_;
  const auto sizes = TRY(ResolveEffects(settings));
  const PressMotion& motion = s.options.motion;
  const double rate =
      PressPlant::StiffestRate(s.options.machine, sizes, motion.z_bottom - motion.z_bottom_spread);
  if (rate * s.grid.step > 1)
    return UsageError(
        "these effects need an integration step below {:.2g} s, but the press runs with {:.2g} s; "
        "switch them on from the beginning",
        1 / rate, s.grid.step);
  const auto delay = [&](DelayLine& line, double before, double now) {
    if (before == now) return;
    const double held = line.Read();
    line = DelayLine(now, s.grid.step);
    line.Push(held);
  };
  delay(s.late_pressure, s.effects.pressure_delay, sizes.pressure_delay);
  delay(s.late_spool, s.effects.spool_delay, sizes.spool_delay);
  delay(s.late_position, s.effects.position_delay, sizes.position_delay);
  s.effects = s.active = sizes;
  s.plant.SetEffects(sizes);
  return {};
}

std::int64_t PressGenerator::total_rows() const { return state_->total_rows; }
const PressTruth& PressGenerator::truth() const { return state_->truth; }

void SimulatedLog::Append(const PressRow& row) {
  t.push_back(row.t);
  p_A.push_back(row.p_A);
  p_B.push_back(row.p_B);
  p_0.push_back(row.p_0);
  z.push_back(row.z);
  y_v.push_back(row.y_v);
  U_v.push_back(row.U_v);
  T_oil.push_back(row.T_oil);
}

PressRow SimulatedLog::Row(std::size_t k) const {
  return {t[k], p_A[k], p_B[k], p_0[k], z[k], y_v[k], U_v[k], T_oil[k]};
}

double VentedReading(const PressOptions& given, double seconds) {
  const PressOptions options = Settled(given);
  const double offset = ResolveEffects(options.effects).value().pressure_offset;
  SensorImperfections sensors(ResolveImperfections(options.imperfections).value(), options);
  NoiseSource noise(options.noise, StreamSeed(options.noise_seed, "vented reading"));
  FaultInjector none({});
  const auto rows = std::max<std::int64_t>(1, std::llround(seconds / options.sample_period));
  double sum = 0;
  for (std::int64_t k = 0; k < rows; ++k) {
    PressRow row;
    row.t = static_cast<double>(k) * options.sample_period;
    row.p_A = offset;
    ReadRow(options, noise.Next(), sensors, none, row);
    sum += row.p_A;
  }
  return sum / static_cast<double>(rows);
}

double TankLinePressure(const PressOptions& options) {
  return options.machine.p_tank + PlantLawsOf(ResolveImperfections(options.imperfections).value()).tank_shift;
}

SimulatedLog SimulatePress(const PressOptions& options) {
  PressGenerator generator(options);
  SimulatedLog log;
  for (PressRow row; generator.Next(row);) log.Append(row);
  log.truth = generator.truth();
  return log;
}

SimulatedLog SimulateClean(const PressOptions& options) {
  PressGenerator generator(options);
  SimulatedLog log;
  for (PressRow row; generator.NextClean(row);) log.Append(row);
  log.truth = generator.truth();
  return log;
}

SimulatedLog AddSensorNoise(const SimulatedLog& clean, const PressOptions& options,
                            std::uint64_t noise_seed) {
  PressOptions reading = clean.truth.options;
  reading.noise = options.noise;
  reading.quantum = options.quantum;
  reading.noise_seed = noise_seed;
  NoiseSource noise(reading.noise, noise_seed);
  SensorImperfections sensors(ResolveImperfections(options.imperfections).value(), reading);
  FaultInjector faults(options.faults);
  SimulatedLog log;
  log.truth = clean.truth;
  for (std::size_t k = 0; k < clean.rows(); ++k) {
    PressRow row = clean.Row(k);
    if (ReadRow(reading, noise.Next(), sensors, faults, row)) log.Append(row);
  }
  return log;
}

}  // namespace hydroscope
