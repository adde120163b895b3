#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "simulator/die_cushion/motion.h"
#include "simulator/die_cushion/press_options.h"
#include "simulator/die_cushion/sensors.h"

namespace hydroscope {

/// What really happened in one drawing phase.
struct StrokeTruth {
  double begin = 0, end = 0;                   ///< s, from the ram's first to its last movement downwards
  double speed = 0;                            ///< m/s, constant part, positive
  double z_begin = 0, z_end = 0;               ///< m
  double oil_temperature = 0;                  ///< K at begin
  double mean_pressure = 0, max_pressure = 0;  ///< Pa, true p_A
};

/// The truth behind a log.
struct PressTruth {
  PressOptions options;              ///< every true parameter and effect, seeds resolved
  std::vector<StrokeTruth> strokes;  ///< drawing phases, the last one possibly cut by the end of the log
};

/// A log in memory, column-wise, SI (T_oil in K; files carry degC).
struct SimulatedLog {
  std::vector<double> t;      ///< s
  std::vector<double> p_A;    ///< Pa
  std::vector<double> p_B;    ///< Pa
  std::vector<double> p_0;    ///< Pa
  std::vector<double> z;      ///< m
  std::vector<double> y_v;    ///< 1
  std::vector<double> U_v;    ///< V
  std::vector<double> T_oil;  ///< K
  PressTruth truth;

  std::size_t rows() const { return t.size(); }
  void Append(const PressRow& row);
  PressRow Row(std::size_t index) const;
};

/// Produces a log row by row in constant memory. `options` must pass Validate().
class PressGenerator {
 public:
  explicit PressGenerator(const PressOptions& options);
  ~PressGenerator();
  PressGenerator(PressGenerator&&) noexcept;
  PressGenerator& operator=(PressGenerator&&) noexcept;

  /// The next row as the sensors show it, faults included; false at the end. Rows lost to a dropout are skipped.
  bool Next(PressRow& row);
  /// The same without noise, quantisation and faults (delays and offsets of the effects stay). Use one of the two.
  bool NextClean(PressRow& row);
  /// Noise of the latest row, in the order of kPressChannels: what Next adds to the row of NextClean.
  const std::array<double, 7>& noise() const;
  /// Phase of the ram at the latest row.
  PressPhase phase() const;
  /// Other effects from the next row on. Refused: effects so stiff that the integration step, chosen at the
  /// beginning, is too long for them.
  Status SetEffects(const std::vector<EffectSetting>& effects);
  /// Rows the log has when none is lost.
  std::int64_t total_rows() const;
  const PressTruth& truth() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The whole log in memory. The controller acts on the very readings that are logged.
SimulatedLog SimulatePress(const PressOptions& options);
/// The noise-free log of the same run: the machine moves exactly as in SimulatePress(options).
SimulatedLog SimulateClean(const PressOptions& options);
/// Another reading of a noise-free log: noise of `options.noise` drawn with `noise_seed`, quantisation,
/// faults. With the noise seed of the run itself (truth.options.noise_seed) the result equals SimulatePress.
SimulatedLog AddSensorNoise(const SimulatedLog& clean, const PressOptions& options, std::uint64_t noise_seed);

/// What the pressure sensor of chamber A reads on average over `seconds` with its line vented to the air, Pa.
double VentedReading(const PressOptions& options, double seconds);
/// What a good gauge on the tank line shows, Pa.
double TankLinePressure(const PressOptions& options);

/// A machine with geometry, oil, valve, speeds and set points drawn from wide, plausible ranges, able to run.
PressOptions RandomMachine(std::uint64_t seed);
/// Four cylinders of one press: the same ram, parameters spread by some percent, own set points and noise.
std::array<PressOptions, 4> FourCushions(const PressOptions& options);
/// The same for any number; the first four are those of FourCushions.
std::vector<PressOptions> Cushions(const PressOptions& options, int count);

}  // namespace hydroscope
