#pragma once

#include <cmath>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "diagnosis/drift/class_offset.h"
#include "diagnosis/drift/operating_class.h"
#include "diagnosis/drift/temperature_model.h"
#include "diagnosis/drift/watched_model.h"

namespace hydroscope::drift {

/// A stroke's deviation from the reference, ready for the tests.
struct Deviation {
  bool judged = false;       ///< false: a kind of stroke the reference knows nothing about, the rest is empty
  int operating_class = -1;  ///< -1: none of its own, judged by what classes differ by
  Eigen::VectorXd value;     ///< SI, each quantity alone, offset of the class taken out
  Eigen::VectorXd std;       ///< SI, sampling
  Eigen::VectorXd reference;     ///< SI, expected value at this oil temperature
  Eigen::VectorXd curve_doubt;   ///< SI, std of the temperature curves here, the same for all strokes
  Eigen::VectorXd offset_doubt;  ///< SI, std of the class's offsets, the same for all its strokes
  /// SI, std of how the class changes beyond the temperatures it was learned at.
  Eigen::VectorXd outside_doubt;
  Eigen::VectorXd doubt;  ///< SI, all three
  Eigen::VectorXd score;  ///< offsets taken out, divided by the class's scatter
  Eigen::MatrixXd information;
  bool outside = false;  ///< oil temperature outside the range learned
};

/// The healthy machine as learned in commissioning and frozen: parameters over oil temperature and operating
/// classes. Never changed afterwards; learning again gives a new version.
class Reference {
 public:
  static constexpr std::uint32_t kFormat = 4;

  /// Learns from commissioning strokes, in their order. Errors: too few strokes, or the strokes do not tell the parameters.
  static Result<Reference> Learn(const WatchedModel& model, std::span<const StrokeEvidence> strokes,
                                 int version);
  /// Adds a class that commissioning did not see from strokes of it, its offsets relative to the frozen curves.
  void AddClass(const WatchedModel& model, std::span<const StrokeEvidence> strokes);

  /// Deviation of a stroke. A stroke of no learned class is judged if commissioning saw DriftThresholds::least_classes classes
  /// and its speed and pressures lie among theirs: how the classes differ then says what it may deviate by.
  Deviation Judge(const WatchedModel& model, const StrokeEvidence& stroke) const;

  /// The stroke as it would have been without deviations of these sizes.
  StrokeEvidence Without(const WatchedModel& model, const StrokeEvidence& stroke,
                         const Eigen::VectorXd& sizes) const;

  int version() const { return version_; }
  std::int64_t first_sequence() const { return first_; }
  std::int64_t last_sequence() const { return last_; }
  const std::vector<TemperatureModel>& curves() const { return curves_; }
  const OperatingClasses& classes() const { return classes_; }
  /// Strokes of commissioning in class `index`.
  bool ClassLearned(int index) const { return index >= 0 && !offsets_[index].empty(); }
  /// Whether enough classes were learned to tell what they differ by.
  bool ComparesClasses() const { return !spread_.empty() && std::isfinite(spread_.front().std); }
  /// Typical value of a quantity, to make relative sizes absolute.
  double typical(int quantity) const { return typical_[quantity]; }

  void Save(ByteWriter& out) const;
  bool Restore(ByteReader& in);

 private:
  struct Expected {
    Eigen::VectorXd values, stds, theta;
    Eigen::MatrixXd jacobian;
    bool outside = false;
  };
  const Expected& At(const WatchedModel& model, double temperature) const;
  std::vector<StrokeEvidence> WithoutClassMeans(const WatchedModel& model,
                                                std::span<const StrokeEvidence> strokes) const;
  void LearnClasses(const WatchedModel& model, std::span<const StrokeEvidence> strokes);
  double ChangeOutside(int index, double temperature) const;
  std::vector<std::vector<ClassDeviation>> DeviationsOf(const WatchedModel& model,
                                                        std::span<const StrokeEvidence> strokes) const;
  Score ScoreOf(const WatchedModel& model, const StrokeEvidence& stroke) const;

  int version_ = 0;
  std::int64_t first_ = 0, last_ = 0;
  Eigen::VectorXd theta_, typical_;
  std::vector<TemperatureModel> curves_;  ///< per quantity
  OperatingClasses classes_;
  std::vector<OffsetSpread> spread_;               ///< per quantity, between classes
  std::vector<double> scatter_;                    ///< per quantity, of all classes together
  std::vector<std::vector<ClassOffset>> offsets_;  ///< per class, per quantity; empty = not learned
  std::vector<TemperatureRange> ranges_;           ///< per class, of the oil while it was learned
  std::vector<double> difference_;                 ///< per quantity, SI, what classes differ by, if told
  mutable std::map<int, Expected> expected_;       ///< by oil temperature in steps of 0.1 K
};

}  // namespace hydroscope::drift
