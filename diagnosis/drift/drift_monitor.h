#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/bytes.h"
#include "core/records/alarm_records.h"
#include "diagnosis/drift/change_analysis.h"
#include "diagnosis/drift/cumulative_sum.h"
#include "diagnosis/drift/reference.h"
#include "diagnosis/drift/rules.h"
#include "diagnosis/drift/slow_trend.h"

namespace hydroscope::drift {

/// Whether a stroke was judged, and why not.
enum class JudgementReason {
  kJudged,
  kTooCold,   ///< oil below the minimum temperature
  kNewClass,  ///< a kind of stroke commissioning did not see; being learned
  kUnusable,  ///< its equations tell nothing (bad signals, no excitation)
};
Told JudgementTold(JudgementReason reason);

/// One quantity of one stroke against the reference.
struct QuantityJudgement {
  double deviation = 0;  ///< SI, this stroke alone
  double std = 0;        ///< SI, sampling
  double doubt = 0;      ///< SI, std of the reference
  double reference = 0;  ///< SI, healthy value at this oil temperature
  double statistic = 0;  ///< of the cumulative-sum test, signed
};

struct Judgement {
  std::int64_t sequence = 0;
  double time = 0;             ///< s
  double oil_temperature = 0;  ///< K
  int operating_class = -1;
  JudgementReason reason = JudgementReason::kJudged;
  std::vector<QuantityJudgement> quantities;  ///< empty unless judged
};

/// A quantity's part in a finding, as it stands now.
struct FindingPart {
  std::string quantity, unit;
  double size = 0, std = 0;  ///< SI, change since before
  double reference = 0;      ///< SI
  double limit = 0;          ///< SI, size below which it counts as gone
  bool alarm = false;        ///< beyond the alarm change, surely
  bool share = false;        ///< Quantity::share
  Told title = {};           ///< Quantity::title
  bool relative = true;      ///< Quantity::relative
  bool reversed =
      false;  ///< it has gone to the other side of healthy since; size and std are from before that

  /// Its interval does not hold zero.
  bool moved() const;
};

enum class FindingState { kSuspected, kNamed, kUndecided, kGone };

/// What comparing the strokes before and after a change says of it.
struct FindingExplanation {
  Told text;              ///< one or two sentences
  bool settled = false;   ///< it names the cause, or names none: more strokes would say the same
  bool described = true;  ///< false: an error is left that no effect explains
  AlarmCause cause = {};  ///< as far as the comparison carries it; not sought if it was not done
  /// Where it names a cause that the finding's rule is not about, or sees another change: what the finding is called, and what
  /// to do in place of `guidance`.
  Told cause_title = {}, advice = {};
};

/// Something changed at the machine: what, since when, by how much, and what it means.
struct DriftFinding {
  std::int64_t number = 0;  ///< 1, 2, ... per axis
  FindingState state = FindingState::kSuspected;
  std::string rule;  ///< id of the rule, "" if none fits (yet)
  Told name, guidance;
  RuleSeverity severity = RuleSeverity::kWarning;
  ChangeTime since;            ///< stroke numbers
  std::int64_t found = 0;      ///< stroke at which the test said so
  std::int64_t last = 0;       ///< latest stroke it rests on
  double oil_temperature = 0;  ///< K, at that stroke
  std::vector<FindingPart> parts;
  std::vector<std::string> rivals;  ///< quantities that would explain the same
  bool alarm = false;               ///< one part is beyond its alarm change
  int quiet = 0;                    ///< strokes it has been small for
  FindingExplanation compared;      ///< of the strokes before and after; its text is "" before that was done
  std::int64_t explained = 0;       ///< strokes since the change that this rests on
  /// One was open when this was named that the model does not describe, or with a further effect only.
  bool beside_another = false;

  /// Its quantities are read off a model that holds.
  bool described() const { return compared.described && !beside_another; }
  /// Nor does any of them tell by how much the machine changed: what is left is that the model does not describe it.
  bool nameless() const;
};

/// What the numbers of a finding count: one, and several.
struct CountedIn {
  Told one{"stroke", "Hub"}, several{"strokes", "Hübe"};
  bool compared =
      true;  ///< those before and after a change are compared with one another, once there are enough
};
/// Strokes; of models with states episodes.
CountedIn CountedInOf(const MachineKind& kind);
CountedIn ValveChecksCounted();

/// "since stroke 48210 (48190 to 48230)".
Told SinceText(const DriftFinding& finding, const CountedIn& counted = {});
/// What changed, "Oil column softer"; of a change that the model does not describe, what comes nearest, if that moved.
Told NameText(const DriftFinding& finding);
/// "K -10.00 +- 0.60 % (12000 -> 10800 bar); would explain as much: V0".
Told SizesText(const DriftFinding& finding);
/// All of it in one sentence: "since stroke 48210: Oil column softer; K -10.00 +- 0.60 % (12000 -> 10800 bar)".
std::string FindingText(const DriftFinding& finding, const CountedIn& counted = {});

/// Slow drift of one quantity towards a limit.
struct SlowDrift {
  std::string quantity, unit;
  TrendFigures figures;
  double limit = 0;   ///< SI, deviation
  TimeToLimit reach;  ///< strokes
};

/// Watches one axis against its frozen reference, stroke by stroke. Deterministic; time and strokes come as
/// arguments. A deviation passes: temperature and class (Reference) -> cumulative sums (CumulativeSum) ->
/// change time and cause (change_analysis) -> rule. What an open finding explains is taken out before the
/// tests go on, so that a second fault is found beside the first.
class DriftMonitor {
 public:
  static constexpr std::uint32_t kFormat = 7;
  static constexpr std::size_t kRemembered = 160;  ///< strokes

  DriftMonitor(WatchedModel model, const RuleBook& rules, Reference reference);

  Judgement Add(const StrokeEvidence& stroke);
  /// Findings that are not gone; a gone one is listed once, by the stroke that cleared it.
  const std::vector<DriftFinding>& findings() const { return findings_; }
  /// What comparing strokes said of a finding; `strokes` since the change.
  void TakeExplanation(std::int64_t number, const FindingExplanation& explanation, std::int64_t strokes);
  /// Slow drifts that would reach their alarm change.
  std::vector<SlowDrift> SlowDrifts() const;
  const Reference& reference() const { return reference_; }
  const WatchedModel& model() const { return model_; }
  const RuleBook& rules() const { return *rules_; }
  /// Whether changes of a quantity are found: the rules name it, or they name none of this machine.
  bool watched(int quantity) const { return watched_[static_cast<std::size_t>(quantity)]; }
  /// Of a quantity's changes, those that count.
  const DriftSize& sizes(int quantity) const { return sizes_[static_cast<std::size_t>(quantity)]; }

  void Save(ByteWriter& out) const;
  /// The monitor as saved; nullopt if the bytes are damaged, of another version or of another model.
  static std::optional<DriftMonitor> Restored(WatchedModel model, const RuleBook& rules, ByteReader& in);

 private:
  bool RestoreRest(ByteReader& in);
  void LearnClass(const StrokeEvidence& stroke);
  void Test(const StrokeEvidence& stroke, const Deviation& deviation, Judgement& judgement);
  void Explain(const Deviation& deviation, double oil_temperature);
  void Follow(const Deviation& deviation, const StrokeEvidence& stroke);
  void Name(DriftFinding& finding, const std::vector<Moved>& moved, const Eigen::VectorXd& doubt);
  bool StandsBesideAnother(const DriftFinding& finding) const;
  bool NamedByRule(const std::vector<Moved>& moved) const;
  void Restart(std::int64_t sequence);
  std::vector<int> ExplainedQuantities() const;

  WatchedModel model_;
  const RuleBook* rules_;
  Reference reference_;
  std::vector<DriftSize> sizes_;
  std::vector<bool> watched_;
  std::vector<CumulativeSum> tests_;
  std::vector<SlowTrend> trends_;
  std::deque<JudgedStroke> strokes_;  ///< what open findings leave unexplained
  std::vector<DriftFinding> findings_;
  Eigen::VectorXd explained_;     ///< SI, sizes of open findings
  Eigen::VectorXd recent_score_;  ///< of the last strokes, nothing taken out, exponentially forgotten
  Eigen::MatrixXd recent_information_;
  Eigen::VectorXd doubt_;    ///< at the last judged stroke
  Eigen::VectorXd healthy_;  ///< reference values at the last judged stroke
  std::int64_t found_ = 0;   ///< findings so far
  std::map<int, std::vector<StrokeEvidence>> new_classes_;
  OperatingClasses candidates_;
};

}  // namespace hydroscope::drift
