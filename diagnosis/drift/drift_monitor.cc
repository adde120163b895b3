#include "diagnosis/drift/drift_monitor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/contains.h"
#include "core/units.h"
#include "diagnosis/drift/drift_thresholds.h"
#include "models/machine_kind.h"

namespace hydroscope::drift {
namespace {

bool Usable(const StrokeEvidence& stroke) {
  return stroke.equations.equations > 0 && stroke.equations.h.allFinite() && stroke.equations.g.allFinite() &&
         stroke.equations.h(0, 0) > 0;
}

/// How far the sizes followed are behind what the newest strokes say, by quantity: what is still moving runs ahead of a mean.
Eigen::VectorXd BehindNewest(const std::deque<JudgedStroke>& strokes, const std::vector<int>& quantities,
                             int size) {
  Eigen::VectorXd behind = Eigen::VectorXd::Zero(size), score = behind;
  if (static_cast<int>(strokes.size()) < kDriftThresholds.newest) return behind;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (auto stroke = strokes.end() - kDriftThresholds.newest; stroke != strokes.end(); ++stroke) {
    score += stroke->score;
    information += stroke->information;
  }
  for (const Moved& m : FitTogether(score, information, quantities))
    if (std::abs(m.size) > kDriftThresholds.behind * m.std) behind[m.quantity] = m.size;
  return behind;
}

}  // namespace

Told JudgementTold(JudgementReason reason) {
  switch (reason) {
    case JudgementReason::kJudged:
      return Tell("judged against the reference", "an der Referenz gemessen");
    case JudgementReason::kTooCold:
      return Tell("oil colder than minimum_temperature of the rules file",
                  "Öl kälter als minimum_temperature der Regeldatei");
    case JudgementReason::kNewClass:
      return Tell(
          "a tool, speed or pressure that commissioning did not see; being learned",
          "ein Werkzeug, eine Geschwindigkeit oder ein Druck, die beim Lernen nicht vorkamen; werden gelernt");
    case JudgementReason::kUnusable:
      return Tell("they tell nothing: bad signals, or nothing moved",
                  "sie sagen nichts: schlechte Signale, oder nichts hat sich bewegt");
  }
  return {};
}

DriftMonitor::DriftMonitor(WatchedModel model, const RuleBook& rules, Reference reference)
    : model_(std::move(model)), rules_(&rules), reference_(std::move(reference)) {
  const int n = model_.size();
  // Rules that know nothing of this machine must not make it look sound: then all of it is watched, by the default sizes.
  const bool strange =
      std::none_of(model_.quantities().begin(), model_.quantities().end(),
                   [&](const auto& quantity) { return rules_->Find(quantity.name) != nullptr; });
  for (int q = 0; q < n; ++q) {
    const WatchSpec* watch = rules_->Find(model_.quantities()[q].name);
    watched_.push_back(strange || watch != nullptr);
    sizes_.push_back(watch != nullptr ? watch->Sizes(reference_.typical(q))
                                      : WatchSpec{}.Sizes(reference_.typical(q)));
  }
  tests_.resize(n);
  trends_.resize(n);
  explained_ = doubt_ = healthy_ = recent_score_ = Eigen::VectorXd::Zero(n);
  recent_information_ = Eigen::MatrixXd::Zero(n, n);
}

Judgement DriftMonitor::Add(const StrokeEvidence& stroke) {
  std::erase_if(findings_, [](const DriftFinding& f) { return f.state == FindingState::kGone; });
  Judgement judgement{stroke.sequence, stroke.time, stroke.oil_temperature, -1, JudgementReason::kJudged, {}};
  if (!Usable(stroke)) {
    judgement.reason = JudgementReason::kUnusable;
  } else if (stroke.oil_temperature < rules_->minimum_temperature) {
    judgement.reason = JudgementReason::kTooCold;
  } else {
    const Deviation deviation = reference_.Judge(model_, stroke);
    judgement.operating_class = deviation.operating_class;
    if (!deviation.judged) {
      judgement.reason = JudgementReason::kNewClass;
      LearnClass(stroke);
    } else {
      Test(stroke, deviation, judgement);
    }
  }
  return judgement;
}

/// Strokes of a kind that commissioning did not see are collected until its offsets can be learned. What open
/// findings explain is taken out, so that a fault does not become part of what is healthy; a suspicion is
/// waited for, but not for ever: the strokes that would settle it may never come again.
void DriftMonitor::LearnClass(const StrokeEvidence& stroke) {
  for (const DriftFinding& f : findings_)
    if (f.state == FindingState::kSuspected && stroke.sequence - f.found < kDriftThresholds.most_to_explain)
      return;
  const int index = candidates_.FindOrAdd(model_, stroke);
  if (index < 0) return;
  auto& members = new_classes_[index];
  members.push_back(reference_.Without(model_, stroke, explained_));
  if (static_cast<int>(members.size()) < kDriftThresholds.least_class_strokes) return;
  reference_.AddClass(model_, members);
  new_classes_.erase(index);
}

void DriftMonitor::TakeExplanation(std::int64_t number, const FindingExplanation& explanation,
                                   std::int64_t strokes) {
  for (DriftFinding& f : findings_) {
    if (f.number != number) continue;
    f.compared = explanation;
    f.explained = strokes;
  }
}

void DriftMonitor::Test(const StrokeEvidence& stroke, const Deviation& d, Judgement& judgement) {
  doubt_ = d.doubt;
  healthy_ = d.reference;
  JudgedStroke rest{stroke.sequence, d.operating_class, d.score - d.information * explained_,
                    d.information,   d.offset_doubt,    d.outside_doubt};
  for (int q = 0; q < model_.size(); ++q) {
    const double information = d.information(q, q);
    const double left = information > 0 ? rest.score[q] / information : 0;
    if (watched_[q]) tests_[q].Add(stroke.sequence, left, d.std[q], d.doubt[q], sizes_[q]);
    if (watched_[q]) trends_[q].Add(stroke.sequence, d.value[q], d.std[q]);
    judgement.quantities.push_back({d.value[q], d.std[q], d.doubt[q], d.reference[q], tests_[q].statistic()});
  }
  strokes_.push_back(std::move(rest));
  if (strokes_.size() > kRemembered) strokes_.pop_front();
  Follow(d, stroke);
  if (!strokes_.empty()) Explain(d, stroke.oil_temperature);  // empty: a finding has just gone
}

std::vector<int> DriftMonitor::ExplainedQuantities() const {
  std::vector<int> quantities;
  for (int q = 0; q < model_.size(); ++q)
    for (const DriftFinding& f : findings_)
      for (const FindingPart& part : f.parts)
        if (part.quantity == model_.quantities()[q].name && (quantities.empty() || quantities.back() != q))
          quantities.push_back(q);
  return quantities;
}

/// Sizes of open findings as they are now; a finding whose parts are all small for long enough is gone.
void DriftMonitor::Follow(const Deviation& d, const StrokeEvidence& stroke) {
  recent_score_ = kDriftThresholds.memory * recent_score_ + d.score;
  recent_information_ = kDriftThresholds.memory * recent_information_ + d.information;
  const std::vector<int> quantities = ExplainedQuantities();
  if (quantities.empty()) return;
  explained_.setZero();
  const auto fitted = FitTogether(recent_score_, recent_information_, quantities);
  const Eigen::VectorXd behind = BehindNewest(strokes_, quantities, model_.size());
  for (const Moved& m : fitted) explained_[m.quantity] = m.size;
  for (DriftFinding& finding : findings_) {
    bool small = true;
    if (finding.parts.empty()) continue;
    finding.alarm = false;
    for (FindingPart& part : finding.parts)
      for (const Moved& m : fitted) {
        if (model_.quantities()[m.quantity].name != part.quantity) continue;
        part.limit = kDriftThresholds.gone_share * sizes_[m.quantity].smallest + 2 * d.doubt[m.quantity];
        part.alarm = false;
        // What the finding is named for is no more; the other way it is another change.
        part.reversed = m.size * part.size < 0;
        if (part.reversed) continue;
        part.size = m.size;
        part.std = std::hypot(m.std, d.doubt[m.quantity], behind[m.quantity]);
        part.reference = d.reference[m.quantity];
        part.alarm = std::abs(m.size) >= std::max(sizes_[m.quantity].alarm, kNormal95 * part.std);
        finding.alarm = finding.alarm || part.alarm;
        small = small && std::abs(m.size) < part.limit;
      }
    finding.last = stroke.sequence;
    finding.oil_temperature = stroke.oil_temperature;
    finding.quiet = small ? finding.quiet + 1 : 0;
    if (finding.quiet >= rules_->clear_delay) finding.state = FindingState::kGone;
  }
  for (const DriftFinding& finding : findings_) {
    if (finding.state != FindingState::kGone) continue;
    for (const FindingPart& part : finding.parts)
      for (int q = 0; q < model_.size(); ++q)
        if (model_.quantities()[q].name == part.quantity) explained_[q] = 0;
    Restart(stroke.sequence);
  }
}

/// Opens a finding when a test says drifted, and names it once the strokes since tell its cause apart from others.
void DriftMonitor::Explain(const Deviation& d, double oil_temperature) {
  const std::int64_t now = strokes_.back().sequence;
  int strongest = -1;
  for (int q = 0; q < model_.size(); ++q)
    if (tests_[q].Direction() != 0 &&
        (strongest < 0 || std::abs(tests_[q].statistic()) > std::abs(tests_[strongest].statistic())))
      strongest = q;
  DriftFinding* open = nullptr;
  for (DriftFinding& f : findings_)
    if (f.state == FindingState::kSuspected) open = &f;
  if (open == nullptr && strongest < 0) return;
  if (open != nullptr && strongest < 0) {  // it went away before it could be explained
    open->state = FindingState::kGone;
    return;
  }
  if (open == nullptr) {
    DriftFinding finding;
    finding.number = ++found_;
    finding.found = now;
    findings_.push_back(finding);
    open = &findings_.back();
  }
  ChangeTime since = FindChangeTime(strokes_, strongest);
  ChangeExplanation explanation = ExplainChange(strokes_, since.last_before, sizes_, d.curve_doubt);
  if (explanation.moved.empty()) return;
  if (explanation.moved.front().quantity != strongest) {
    since = FindChangeTime(strokes_, explanation.moved.front().quantity);
    explanation = ExplainChange(strokes_, since.last_before, sizes_, d.curve_doubt);
    if (explanation.moved.empty()) return;
  }
  open->since = since;
  open->last = now;
  open->oil_temperature = oil_temperature;
  const auto after = std::count_if(strokes_.begin(), strokes_.end(),
                                   [&](const JudgedStroke& s) { return s.sequence > since.last_before; });
  const bool waited = now - open->found >= kDriftThresholds.most_to_explain;
  if (after < kDriftThresholds.least_to_explain || (!explanation.decided && !waited)) return;
  const bool outside = d.outside || (d.outside_doubt.array() > 0).any();
  if (outside && !NamedByRule(explanation.moved)) {
    for (std::size_t k = 1; k < explanation.moved.size(); ++k)
      explanation.rivals.push_back(explanation.moved[k].quantity);
    explanation.moved = {explanation.alone};
    explanation.decided = false;
  }
  open->rivals.clear();
  for (const int q : explanation.rivals) open->rivals.push_back(model_.quantities()[q].name);
  open->state = explanation.decided ? FindingState::kNamed : FindingState::kUndecided;
  Name(*open, explanation.moved, d.doubt);
}

/// Outside the temperatures learned, quantities moving together as no rule knows speak for a reference that
/// does not hold there rather than for several faults at once.
bool DriftMonitor::NamedByRule(const std::vector<Moved>& moved) const {
  std::map<std::string, int> movements;
  for (const Moved& m : moved) movements[model_.quantities()[m.quantity].name] = m.size > 0 ? 1 : -1;
  return rules_->Match(movements) != nullptr;
}

bool DriftMonitor::StandsBesideAnother(const DriftFinding& finding) const {
  return std::any_of(findings_.begin(), findings_.end(), [&](const DriftFinding& f) {
    const AlarmCause& cause = f.compared.cause;
    const bool another = cause.kind == CauseKind::kNotProven && !Contains(cause.effects, f.rule);
    return f.number != finding.number && f.state != FindingState::kGone &&
           (!f.described() || another || !f.compared.cause_title.empty());
  });
}

/// Applies the rules and starts to follow the sizes. A quantity that open findings explain in part moved by
/// all of it together: what corrects their size is no movement the other way.
void DriftMonitor::Name(DriftFinding& finding, const std::vector<Moved>& moved,
                        const Eigen::VectorXd& doubt) {
  finding.beside_another = StandsBesideAnother(finding);
  std::map<std::string, int> movements;
  finding.parts.clear();
  finding.alarm = false;
  for (const Moved& m : moved) {
    const Quantity& quantity = model_.quantities()[m.quantity];
    const double size = m.size + explained_[m.quantity];
    const bool alarm = std::abs(size) >= sizes_[m.quantity].alarm;
    movements[quantity.name] = size > 0 ? 1 : -1;
    finding.parts.push_back(
        {quantity.name, quantity.unit, size, m.std, healthy_[m.quantity],
         kDriftThresholds.gone_share * sizes_[m.quantity].smallest + 2 * doubt[m.quantity], alarm,
         quantity.share, quantity.title, quantity.relative});
    finding.alarm = finding.alarm || alarm;
  }
  const Rule* rule = finding.state == FindingState::kNamed ? rules_->Match(movements) : nullptr;
  if (rule != nullptr) {
    finding.rule = rule->id;
    finding.name = rule->name;
    finding.guidance = rule->guidance;
    finding.severity = rule->severity;
  } else {
    finding.rule.clear();
    const Told& counted = CountedInOf(model_.kind()).several;
    finding.name = finding.state == FindingState::kNamed
                       ? Tell("Change that no rule names", "Änderung, die keine Regel benennt")
                       : Tell("Change that the {} do not tell apart",
                              "Änderung, deren Ursache die {} nicht unterscheiden", counted);
    const Told by_oil = model_.kind().temperature.empty()
                            ? Told{}
                            : Tell(
                                  " If the oil is warmer or colder than when the healthy machine was "
                                  "learned, learn again (`hydroscope learn`).",
                                  " Ist das Öl wärmer oder kälter als beim Lernen der gesunden Maschine, neu "
                                  "lernen (`hydroscope learn`).");
    finding.guidance = Tell(
        "See `hydroscope explain` of the {} since the change; vary what drives the "
        "machine (speed, pressure, load).{}",
        "`hydroscope explain` der {} seit der Änderung ansehen; variieren, was die Maschine antreibt "
        "(Geschwindigkeit, Druck, Last).{}",
        counted, by_oil);
  }
  // Sizes are followed from the strokes since the change alone, what was explained before included.
  recent_score_.setZero();
  recent_information_.setZero();
  for (const JudgedStroke& s : strokes_) {
    if (s.sequence <= finding.since.last_before) continue;
    recent_score_ = kDriftThresholds.memory * recent_score_ + s.score + s.information * explained_;
    recent_information_ = kDriftThresholds.memory * recent_information_ + s.information;
  }
  for (const Moved& m : moved) explained_[m.quantity] += m.size;
  Restart(finding.last);
}

/// The tests begin anew after this stroke.
void DriftMonitor::Restart(std::int64_t sequence) {
  strokes_.clear();
  for (CumulativeSum& test : tests_) test.Reset(sequence);
}

std::vector<SlowDrift> DriftMonitor::SlowDrifts() const {
  std::vector<SlowDrift> drifts;
  for (int q = 0; q < model_.size(); ++q) {
    if (!watched_[q]) continue;
    SlowDrift drift{model_.quantities()[q].name,
                    model_.quantities()[q].unit,
                    trends_[q].Figures(sizes_[q].smallest, doubt_[q]),
                    0,
                    {}};
    if (!drift.figures.significant || (sizes_[q].only_upwards && drift.figures.slope < 0)) continue;
    drift.limit = std::copysign(sizes_[q].alarm, drift.figures.slope);
    drift.reach = SlowTrend::Reach(drift.figures, drift.limit);
    drifts.push_back(drift);
  }
  return drifts;
}

}  // namespace hydroscope::drift
