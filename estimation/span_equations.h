#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/told.h"
#include "models/model_structure.h"

namespace hydroscope {

/// The equations one span of samples gives, one column of each matrix per equation, one row per model column.
///
/// Integral form. Integrated once, the balance reads: piston volume = sum theta_i * (integral of base_i) +
/// constant. Sensor noise of the position then enters white and undifferentiated, and the small noise of the
/// pressure meets its full signal, so the errors-in-variables bias that ruins the differenced form is nearly
/// gone. Levels are averaged over blocks; the constant, one per span, is taken out by orthonormal (Helmert)
/// contrasts, which keep white noise white. A short span keeps slow model errors from piling up in the integral.
///
/// Noise. The same block with alternating signs (+ - - +) sees neither level nor slope, only the sensor
/// noise: its outer product estimates what the noise adds to the regressors' Gram, for every column and every
/// nonlinearity, without knowing any noise level. Subtracting it takes out the errors-in-variables bias that
/// is left. Noise that is integrated (of pressure and spool in the valve flow) walks away from the level at random;
/// the model says how much of it there is, and a random walk over B blocks of M samples has the centred
/// energy M (B^2 - 1) / 6 per sample variance, most of it from what came in at the middle.
///
/// Level form. A balance without d/dt needs no integration: its equations are the block means themselves, and
/// none of them is spent on an intercept. Its windows are means over the same time as those of the flow form.
///
/// Flow form. Levels seen through a triangular window's derivative: in the unit of the output, to show and to compare.
struct SpanEquations {
  Eigen::MatrixXd integral;       ///< columns x (blocks - 1), integrated output unit (m^3)
  Eigen::MatrixXd noise;          ///< columns x blocks, same unit: white noise
  Eigen::MatrixXd walk;           ///< columns x any number, same unit: noise that is integrated
  Eigen::MatrixXd flow;           ///< columns x windows, output unit
  std::vector<double> flow_time;  ///< s, centre of each window
  int blocks = 0;
  int equations = 0;  ///< columns of `integral` that hold: blocks - 1, in the level form blocks
  double begin = 0;   ///< s, first new sample
};

/// How blocks, spans and windows count in samples.
struct WindowSamples {
  int block = 10;           ///< samples per block
  int span = 20;            ///< blocks per span
  int half_window = 2;      ///< blocks in each half of the flow window
  int min_span = 5;         ///< blocks below which the rest of a segment is not used
  double period = 0.002;    ///< s
  bool level_form = false;  ///< of ModelStructure
  static WindowSamples From(const WindowSpec& spec, double period);
  /// What From makes larger than `spec` asks for, one sentence each.
  static std::vector<Told> Clamps(const WindowSpec& spec, double period);
  /// Variance of a window of the flow form per variance of a block mean: the difference of two means of h
  /// block levels, h blocks apart, has 2 / (h^3 T_block^2); in the level form the mean of 2 h blocks has 1 /
  /// (2 h).
  double FlowVarianceGain() const;
  /// Variance of a window of the flow form, from the variance `white` of a block mean and the variance `walk`
  /// that a random walk gains per block: means of h blocks, h blocks apart, then differ by 2/3 h walk.
  double FlowNoiseVariance(double white, double walk) const;
};

/// Sign of row `k` of a block of `rows` in the contrast that tells its noise: + - - + over each four rows, of which a line leaves
/// nothing; 0 for those behind the last whole four.
inline int ContrastSign(int k, int rows) {
  if (k >= rows / 4 * 4) return 0;
  return (k & 3) == 0 || (k & 3) == 3 ? 1 : -1;
}
/// By what the sum of the signed rows is multiplied to vary with white noise as the mean of the block does.
inline double ContrastScale(int rows) { return 1.0 / std::sqrt(static_cast<double>(rows) * (rows / 4 * 4)); }

/// Weights of one increment of a block, or what increments have summed to: mean, alternating signs, rise; the last lane is unused.
/// Aligned as memory without AVX is, whichever processor a function that reads them is compiled for.
struct BlockWeights {
  typedef double Lanes __attribute__((vector_size(32), aligned(16)));
  Lanes lanes{};
};
/// Of the increments of a block of `block` samples, one each.
std::vector<BlockWeights> WeightsOfIncrements(int block);
/// Of values in their place, as the level form takes them; they rise by nothing.
std::vector<BlockWeights> WeightsOfValues(int block);

class SpanEquationBuilder {
 public:
  /// The equations have a row for each of the model's columns from `first` on: 0, or one behind the output's.
  SpanEquationBuilder(std::shared_ptr<const ModelStructure> model, WindowSamples window, int first = 0);

  /// Equations of one span. `stretch` holds whole blocks, plus one leading sample if it continues a segment;
  /// its derived channels are filled here. `begin` is the time of its first block's first sample, s. The
  /// result stays valid until the next call.
  const SpanEquations& Build(Stretch& stretch, double begin);
  /// The same of a stretch whose derived channels are filled.
  const SpanEquations& BuildDerived(const Stretch& stretch, double begin);

  const WindowSamples& window() const { return window_; }

 private:
  void FillLevels(const Stretch& stretch, int blocks);
  void FillValues(const Stretch& stretch, int blocks);
  void FillContrasts(int blocks);
  void FillWalk(const Stretch& stretch, int blocks);
  void FillDisturbedRates(const Stretch& stretch, int first, int step, Eigen::MatrixXd& rate_noise);
  void FillFlows(int blocks, bool continues, double begin);

  std::shared_ptr<const ModelStructure> model_;
  std::span<const Column> columns_;  ///< of the model
  bool walks_ = false;               ///< one of them does
  WindowSamples window_;
  std::vector<BlockWeights> weights_;  ///< one per sample of a block
  std::vector<double> increments_;
  std::vector<double> column_state_;
  std::vector<double> last_level_;         ///< level of each column at the last sample of the stretch before
  Eigen::MatrixXd level_;                  ///< columns x (history + blocks), block means
  Stretch copies_;                         ///< of ModelStructure::disturb
  Eigen::VectorXd weights_of_walk_;        ///< of a step at the times of the rates
  Eigen::VectorXd mean_, before_, after_;  ///< of levels, one per column
  int history_ = 0;                        ///< block means kept from the stretch before
  SpanEquations out_;
};

}  // namespace hydroscope
