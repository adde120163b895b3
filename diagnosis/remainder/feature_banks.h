#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "models/model_structure.h"
#include "models/stretch.h"

namespace hydroscope {

/// What is missing goes from log to log (FeatureBank::about).
inline constexpr const char* kOrderOfLogs = "the order of the logs";

/// Functions of the measured signals of one kind.
struct FeatureBank {
  std::string about;  ///< what they are functions of, for people: "p_A", "p_A and z", "time in the log"
  std::vector<int> columns;  ///< base columns they modulate; empty: rates of their own
  std::vector<int> axes;     ///< one or two of the banks' axes; empty: the time within the log
  int count = 0;             ///< features
  bool of_logs = false;      ///< without axes: the order of the logs in place of the time within each
};

/// Columns of one stretch in the form of the balance's own equations: block means of the running integral about their mean over
/// the span (in the level form block means as they are), one column of each matrix per block.
struct BlockColumns {
  Eigen::MatrixXd means;  ///< columns x blocks
  /// The same shape, of rows with alternating signs (SpanEquations::noise): white sensor noise makes products of these what it
  /// makes products of `means`, and motion leaves nothing in them.
  Eigen::MatrixXd noise;
};

struct FeatureRows {
  BlockColumns model;               ///< all columns of the model
  std::vector<BlockColumns> banks;  ///< features, per bank
};

/// Banks of features in which any law that depends on the signals as they are can be written nearly: every
/// term of the base balance with a coefficient that is a piecewise linear function of one signal, of the
/// phase of the stroke, of the time within the log or of the order of several logs (varying-coefficient
/// model, Hastie and Tibshirani 1993), and rates of their own that are piecewise linear functions of one or two signals. No feature holds a
/// signal that only the output reads, whose noise is that of the equation.
class FeatureBanks {
 public:
  /// `strokes` must outlive the banks. Knots lie between the 1 % and the 99 % quantile of each signal.
  FeatureBanks(const ModelStructure& model, std::span<const StrokeStretches> strokes,
               const WindowSamples& window);

  const std::vector<FeatureBank>& banks() const { return banks_; }

  /// Rows of stretch `part` of stroke `stroke`; the stretches of a stroke must be taken in their order. The
  /// result stays valid until the next call.
  const FeatureRows& Rows(std::size_t stroke, std::size_t part);

 private:
  struct Wide;
  /// A signal that features are functions of.
  struct Axis {
    int channel = 0;  ///< of Stretch; -1 = phase of the stroke
    double low = 0, high = 1;
  };
  std::vector<int> AxisChannels() const;
  void ChooseBanks();
  void FillIncrements(const Stretch& stretch);
  void FillPlaces(const Stretch& stretch, std::size_t stroke);
  void FindTimes();
  void FillTrend(const FeatureBank& bank, double time, BlockColumns& rows) const;
  template <typename Visit>
  void SumBlocks(int features, int blocks, BlockColumns& rows, Visit visit) const;

  const ModelStructure& model_;
  std::span<const StrokeStretches> strokes_;
  WindowSamples window_;
  std::vector<BlockWeights> weights_;  ///< one per sample of a block
  std::vector<Axis> axes_;
  int paired_ = 0;  ///< the first so many axes are taken two at a time too
  std::vector<FeatureBank> banks_;
  /// -1 ... 1, of each stroke: its place within its log, and the place of that log among the logs.
  std::vector<double> in_log_, of_log_;
  bool several_logs_ = false;
  Stretch work_;
  int lead_ = 0;                                 ///< samples of the stretch before its first block
  std::vector<double> column_state_;             ///< Column::fill
  std::vector<std::vector<double>> increments_;  ///< [model column][sample]
  std::vector<std::vector<double>> place_;       ///< [axis][sample], 0 ... 1 between its outer knots
  double done_ = 0;                              ///< samples of the stroke before this stretch
  FeatureRows out_;
};

}  // namespace hydroscope
