#include "diagnosis/drift/reference.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/told_error.h"
#include "diagnosis/drift/curve_learning.h"
#include "diagnosis/drift/drift_thresholds.h"
#include "diagnosis/drift/serial.h"
#include "estimation/decompositions.h"
#include "models/counted_words.h"

namespace hydroscope::drift {
namespace {

constexpr std::uint32_t kReferenceMagic = 0x46455248;  // "HREF"
constexpr double kStepsPerKelvin = 10.0;
constexpr int kPasses = 8;  ///< of taking class means out

}  // namespace

Result<Reference> Reference::Learn(const WatchedModel& model, std::span<const StrokeEvidence> strokes,
                                   int version) {
  if (static_cast<int>(strokes.size()) < kDriftThresholds.least_strokes)
    return BadInput(Tell(
        "commissioning has {}, expected at least {}", "die Inbetriebnahme hat {}, erwartet mindestens {}",
        CountedWordsOf(model.kind()).CountedTold(strokes.size()), kDriftThresholds.least_strokes));
  Reference reference;
  reference.version_ = version;
  reference.first_ = strokes.front().sequence;
  reference.last_ = strokes.back().sequence;
  NormalEquations all;
  for (const StrokeEvidence& s : strokes) all += s.equations;
  const Eigen::VectorXd values = model.Solve(all);
  if (values.size() == 0)
    return BadInput(Tell(
        "strokes {} ... {} do not tell the parameters apart; vary what "
        "drives the machine: speed, pressure, load",
        "die Hübe {} … {} unterscheiden die Parameter nicht; verändern, was die Maschine antreibt: Geschwindigkeit, "
        "Druck, Last",
        reference.first_, reference.last_));
  NormalEquations base{all.h.topLeftCorner(model.base_count(), model.base_count()),
                       all.g.head(model.base_count()), all.yy, all.equations};
  reference.theta_ = Eigen::VectorXd::Zero(model.size());
  reference.theta_.head(model.base_count()) = SolveNormalEquations(base);
  reference.typical_ = values;
  reference.curves_ = LearnCurves(model, strokes, reference.theta_, values);
  // A class seen at few temperatures must not bend the curves: its mean error is taken out and the curves fitted again.
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::vector<StrokeEvidence> level = reference.WithoutClassMeans(model, strokes);
    reference.expected_.clear();
    reference.curves_ = LearnCurves(model, level, reference.theta_, values);
  }
  for (int q = 0; q < model.size(); ++q)
    if (!model.quantities()[q].effect && model.quantities()[q].over_oil != OilLaw::kNone &&
        !reference.curves_[q].tells_slope())
      reference.curves_[q].AssumeSlope(kDriftThresholds.unknown_slope * std::abs(values[q]));
  reference.expected_.clear();
  reference.LearnClasses(model, strokes);
  return reference;
}

std::vector<StrokeEvidence> Reference::WithoutClassMeans(const WatchedModel& model,
                                                         std::span<const StrokeEvidence> strokes) const {
  OperatingClasses classes;
  std::vector<Eigen::VectorXd> mean;
  std::vector<double> count;
  const auto error = [&](const StrokeEvidence& s) -> Eigen::VectorXd {
    const NormalEquations& e = s.equations;
    return (e.g - e.h * At(model, s.oil_temperature).theta)
        .cwiseQuotient(e.h.diagonal().cwiseMax(1e-300).cwiseSqrt());
  };
  for (const StrokeEvidence& s : strokes) {
    const int c = classes.FindOrAdd(model, s);
    if (c < 0) continue;
    mean.resize(classes.count(), Eigen::VectorXd::Zero(model.size()));
    count.resize(classes.count(), 0);
    mean[c] += error(s);
    ++count[c];
  }
  std::vector<StrokeEvidence> level(strokes.begin(), strokes.end());
  for (StrokeEvidence& s : level) {
    const int c = classes.Find(model, s);
    if (c < 0 || count[c] < kDriftThresholds.least_class_strokes) continue;
    const Eigen::VectorXd own =
        (mean[c] / count[c]).cwiseProduct(s.equations.h.diagonal().cwiseMax(1e-300).cwiseSqrt());
    s.equations.g -= own;
    s.equations.yy -= 2 * own.dot(At(model, s.oil_temperature).theta);  // its squared error stays
  }
  return level;
}

const Reference::Expected& Reference::At(const WatchedModel& model, double temperature) const {
  const bool measured = std::isfinite(temperature);
  const int step = measured ? static_cast<int>(std::lround(temperature * kStepsPerKelvin)) : -1;
  const auto known = expected_.find(step);
  if (known != expected_.end()) return known->second;
  const double at = measured ? step / kStepsPerKelvin : temperature;
  Expected e{Eigen::VectorXd(model.size()), Eigen::VectorXd(model.size()), {}, {}, false};
  for (int q = 0; q < model.size(); ++q) {
    const TemperatureModel::Prediction p = curves_[q].At(at);
    e.values[q] = p.value;
    e.stds[q] = p.std;
    e.outside = e.outside || p.outside;
  }
  e.theta = model.Theta(e.values, theta_);
  if (e.theta.size() == 0) e.theta = theta_;
  e.jacobian = model.Jacobian(e.theta);
  return expected_.emplace(step, std::move(e)).first->second;
}

Score Reference::ScoreOf(const WatchedModel& model, const StrokeEvidence& stroke) const {
  const Expected& e = At(model, stroke.oil_temperature);
  return {e.jacobian.transpose() * (stroke.equations.g - stroke.equations.h * e.theta),
          e.jacobian.transpose() * stroke.equations.h * e.jacobian};
}

/// Per quantity, deviations of the strokes from the curves.
std::vector<std::vector<ClassDeviation>> Reference::DeviationsOf(
    const WatchedModel& model, std::span<const StrokeEvidence> strokes) const {
  std::vector<std::vector<ClassDeviation>> deviations(model.size());
  for (const StrokeEvidence& s : strokes) {
    const Score score = ScoreOf(model, s);
    for (int q = 0; q < model.size(); ++q) {
      const double information = score.information(q, q);
      if (information > 0) deviations[q].push_back({score.score[q] / information, information});
    }
  }
  return deviations;
}

/// Offsets of the classes, how they differ, and the scatter of all strokes about them.
void Reference::LearnClasses(const WatchedModel& model, std::span<const StrokeEvidence> strokes) {
  std::vector<std::vector<StrokeEvidence>> members;
  for (const StrokeEvidence& s : strokes) {
    const int index = classes_.FindOrAdd(model, s);
    if (index < 0) continue;
    members.resize(classes_.count());
    members[index].push_back(s);
  }
  ranges_.assign(members.size(), {});
  std::vector<std::vector<std::vector<ClassDeviation>>> deviations;  // class, quantity, stroke
  for (const auto& m : members) {
    deviations.push_back(DeviationsOf(model, m));
    for (const StrokeEvidence& s : m) ranges_[deviations.size() - 1].Take(s.oil_temperature);
  }
  offsets_.assign(members.size(), {});
  for (int q = 0; q < model.size(); ++q) {
    std::vector<double> standardised;
    std::size_t fitted = 0;
    for (const auto& of_class : deviations) {
      if (static_cast<int>(of_class[q].size()) < kDriftThresholds.least_offset_strokes) continue;
      const double offset = MeasureOffset(of_class[q]).offset;
      for (const ClassDeviation& d : of_class[q])
        standardised.push_back((d.value - offset) * std::sqrt(d.information));
      ++fitted;
    }
    const double all = static_cast<double>(standardised.size());
    scatter_.push_back(Scatter(standardised) * all / std::max(1.0, all - static_cast<double>(fitted)));
    std::vector<ClassOffset> measured;
    for (const auto& of_class : deviations)
      measured.push_back(static_cast<int>(of_class[q].size()) >= kDriftThresholds.least_class_strokes
                             ? MeasureOffset(of_class[q])
                         : static_cast<int>(of_class[q].size()) >= kDriftThresholds.least_offset_strokes
                             ? MeasureOffset(of_class[q], scatter_[q])
                             : MeasureOffset({}, scatter_[q]));
    spread_.push_back(SpreadOf(measured));
    difference_.push_back(std::isfinite(spread_[q].std) ? spread_[q].std : 0);
    for (std::size_t c = 0; c < members.size(); ++c) offsets_[c].push_back(Combine(measured[c], spread_[q]));
  }
  const bool comparable = std::count_if(members.begin(), members.end(), [](const auto& m) {
                            return static_cast<int>(m.size()) >= kDriftThresholds.least_offset_strokes;
                          }) >= kDriftThresholds.least_classes;
  for (std::size_t c = 0; c < members.size(); ++c)
    if (static_cast<int>(members[c].size()) < kDriftThresholds.least_class_strokes && !comparable)
      offsets_[c].clear();
  if (!comparable)
    for (OffsetSpread& spread : spread_) spread.std = std::numeric_limits<double>::infinity();
}

/// What the model misses, and each class answers in its own way, may change with the oil as much as its
/// viscosity does: by this share of what classes differ by, outside the range the class was learned in.
double Reference::ChangeOutside(int index, double temperature) const {
  TemperatureRange range;
  if (index >= 0)
    range = ranges_[index];
  else
    for (const TemperatureRange& of_class : ranges_) {
      range.Take(of_class.low);
      range.Take(of_class.high);
    }
  const double edge = range.Nearest(temperature);
  return std::isfinite(temperature) && edge != temperature
             ? std::abs(RelativeViscosity(temperature) / RelativeViscosity(edge) - 1)
             : 0;
}

void Reference::AddClass(const WatchedModel& model, std::span<const StrokeEvidence> strokes) {
  if (strokes.empty()) return;
  const int index = classes_.FindOrAdd(model, strokes.front());
  if (index < 0) return;
  offsets_.resize(classes_.count());
  offsets_[index].clear();
  ranges_.resize(classes_.count());
  ranges_[index] = {};
  for (const StrokeEvidence& s : strokes) ranges_[index].Take(s.oil_temperature);
  for (const auto& deviations : DeviationsOf(model, strokes))
    offsets_[index].push_back(MeasureOffset(deviations));
}

Deviation Reference::Judge(const WatchedModel& model, const StrokeEvidence& stroke) const {
  Deviation d;
  const int index = classes_.Find(model, stroke);
  const bool learned = ClassLearned(index);
  if (!learned && !(ComparesClasses() && classes_.Encloses(model, stroke))) return d;
  d.judged = true;
  d.operating_class = learned ? index : -1;
  const Expected& e = At(model, stroke.oil_temperature);
  const Score score = ScoreOf(model, stroke);
  const int n = model.size();
  d.outside = e.outside;
  d.reference = e.values;
  d.value.resize(n);
  d.std.resize(n);
  d.curve_doubt = e.stds;
  d.offset_doubt.resize(n);
  d.outside_doubt.resize(n);
  const double outside = ChangeOutside(d.operating_class, stroke.oil_temperature);
  Eigen::VectorXd scatter(n);
  Eigen::VectorXd own = score.score;
  for (int q = 0; q < n; ++q) {
    const ClassOffset o = learned ? offsets_[index][q] : Combine(MeasureOffset({}, scatter_[q]), spread_[q]);
    const double information = score.information(q, q);
    own[q] -= information * o.offset;
    d.value[q] = information > 0 ? own[q] / information : 0;
    d.std[q] = information > 0 ? std::sqrt(o.scatter / information) : std::numeric_limits<double>::infinity();
    d.offset_doubt[q] = o.std;
    d.outside_doubt[q] = difference_[q] * outside;
    scatter[q] = o.scatter;
  }
  d.doubt =
      (d.curve_doubt.cwiseAbs2() + d.offset_doubt.cwiseAbs2() + d.outside_doubt.cwiseAbs2()).cwiseSqrt();
  // One noise level for all, so that explanations by different quantities compare.
  std::nth_element(scatter.begin(), scatter.begin() + n / 2, scatter.end());
  d.score = own / scatter[n / 2];
  d.information = score.information / scatter[n / 2];
  return d;
}

StrokeEvidence Reference::Without(const WatchedModel& model, const StrokeEvidence& stroke,
                                  const Eigen::VectorXd& sizes) const {
  StrokeEvidence without = stroke;
  without.equations.g -= stroke.equations.h * (At(model, stroke.oil_temperature).jacobian * sizes);
  return without;
}

void Reference::Save(ByteWriter& out) const {
  out.Put(kReferenceMagic);
  out.Put(kFormat);
  out.Put<std::int32_t>(version_);
  out.Put(first_);
  out.Put(last_);
  PutVector(out, theta_);
  PutVector(out, typical_);
  for (const TemperatureModel& curve : curves_) curve.Save(out);
  for (const OffsetSpread& spread : spread_) out.Put(spread);
  for (const double scatter : scatter_) out.Put(scatter);
  for (const double difference : difference_) out.Put(difference);
  classes_.Save(out);
  for (std::size_t c = 0; c < offsets_.size(); ++c) {
    out.Put<std::uint8_t>(!offsets_[c].empty());
    for (const ClassOffset& o : offsets_[c]) out.Put(o);
    out.Put(ranges_[c]);
  }
}

bool Reference::Restore(ByteReader& in) {
  *this = Reference();
  if (in.Get<std::uint32_t>() != kReferenceMagic || in.Get<std::uint32_t>() != kFormat) return false;
  version_ = in.Get<std::int32_t>();
  first_ = in.Get<std::int64_t>();
  last_ = in.Get<std::int64_t>();
  theta_ = GetVector(in);
  typical_ = GetVector(in);
  if (!in.ok() || theta_.size() == 0 || theta_.size() != typical_.size()) return false;
  curves_.resize(theta_.size());
  for (TemperatureModel& curve : curves_)
    if (!curve.Restore(in)) return false;
  spread_.resize(theta_.size());
  for (OffsetSpread& spread : spread_) spread = in.Get<OffsetSpread>();
  scatter_.resize(theta_.size());
  for (double& scatter : scatter_) scatter = in.Get<double>();
  difference_.resize(theta_.size());
  for (double& difference : difference_) difference = in.Get<double>();
  if (!classes_.Restore(in)) return false;
  offsets_.resize(classes_.count());
  ranges_.resize(classes_.count());
  for (std::size_t c = 0; c < offsets_.size(); ++c) {
    offsets_[c].resize(in.Get<std::uint8_t>() != 0 ? theta_.size() : 0);
    for (ClassOffset& o : offsets_[c]) o = in.Get<ClassOffset>();
    ranges_[c] = in.Get<TemperatureRange>();
  }
  return in.ok();
}

}  // namespace hydroscope::drift
