#include "estimation/recursive/episode_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// Relative standard error beyond which a parameter is not told from others (as TrustOf has it).
constexpr double kUseful = 0.3;

void PutNumbers(ByteWriter& out, const Eigen::MatrixXd& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) out.Put(values.data()[i]);
}

Eigen::MatrixXd GetNumbers(ByteReader& in, int rows, int columns) {
  Eigen::MatrixXd values(rows, columns);
  for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = in.Get<double>();
  return values;
}

Eigen::MatrixXd Symmetric(const Eigen::MatrixXd& m) { return 0.5 * (m + m.transpose()); }

/// The inverse where it is one, nothing is known of other directions.
Eigen::MatrixXd FlooredInverse(const Eigen::MatrixXd& m) {
  constexpr double kRounding = 1e-12;
  const SymmetricEigen eigen = EigenOf(Symmetric(m));
  const double floor = kRounding * std::max(eigen.values.maxCoeff(), 1e-300);
  const Eigen::VectorXd weights =
      eigen.values.unaryExpr([floor](double value) { return value > floor ? 1 / value : 0.0; });
  return eigen.vectors * weights.asDiagonal() * eigen.vectors.transpose();
}

/// Standard errors of an episode within which what it says beyond the others may be chance.
constexpr double kChance = 3;
/// Squared errors over the noise that parameters of its own take from an episode, of which chance gives five parameters as many
/// in one of ten million; and of which a step that takes no more ends the search for them.
constexpr double kBeyondChance = 40, kSearchEnds = 0.01;
constexpr double kBeginDamping = 1e-3, kMostDamping = 1e6, kDampingStep = 10;
constexpr int kMostSteps = 30;

/// Variance of following: a parameter is so far `behind` what an episode alone says of it, whose own variance is `own`.
double LagVariance(double behind, double own) {
  return std::max(0.0, behind * behind - kChance * kChance * own);
}

/// Sum of squared errors at other parameters.
double EnergyAt(const EpisodeEvidence& e, const Eigen::VectorXd& parameters) {
  const Eigen::VectorXd change = parameters - e.at;
  return std::max(0.0, e.energy - 2 * e.gradient.dot(change) + change.dot(e.information * change));
}

}  // namespace

double EpisodeEvidence::ErrorAt(const Eigen::VectorXd& parameters) const {
  return std::sqrt(EnergyAt(*this, parameters) / std::max(1, readings));
}

EpisodeFollower::EpisodeFollower(std::shared_ptr<const EpisodeModel> model,
                                 const EpisodeFollowerOptions& options)
    : model_(std::move(model)), options_(options) {}

Eigen::VectorXd EpisodeFollower::parameters() const {
  return filter_ ? Admissible(size_.cwiseProduct(Eigen::VectorXd(filter_->Theta()))) : Eigen::VectorXd();
}

Eigen::VectorXd EpisodeFollower::Admissible(const Eigen::VectorXd& parameters) const {
  Eigen::VectorXd out = parameters;
  for (int p = 0; p < count(); ++p) {
    out[p] = std::clamp(out[p], parameter(p).min, parameter(p).max);
  }
  return out;
}

/// From all starts.
bool EpisodeFollower::Begin(const ReadEpisode& episode) {
  const auto fit = episode.Fit();
  if (fit) Begin(*fit);
  return fit.has_value();
}

void EpisodeFollower::Begin(const FirstFit& fit) {
  basis_ = fit.basis;
  shown_noise_ = fit.shown_noise;
  size_ = fit.size;
  const Eigen::VectorXd start = fit.parameters.cwiseQuotient(size_);
  filter_.emplace(InformationFilter::Vector(start), options_.covariance, options_.covariance);
  information_ = of_pieces_ = expected_ = of_episodes_ = Eigen::MatrixXd::Zero(count(), count());
  errors_ = 0;
  last_excited_ = Eigen::VectorXd::Constant(count(), kUnknown);
}

/// Nothing where the model cannot be run at `at`.
std::optional<EpisodeEvidence> EpisodeFollower::Linearise(const ReadEpisode& episode,
                                                          const Eigen::VectorXd& at,
                                                          const Eigen::VectorXd& basis) const {
  const auto linear = episode.Linearise(at, basis);
  if (!linear) return std::nullopt;
  EpisodeEvidence e;
  e.at = at;
  e.information = e.scatter = Eigen::MatrixXd::Zero(count(), count());
  e.gradient = Eigen::VectorXd::Zero(count());
  for (const LinearisedEpisode::Piece& piece : linear->pieces) {
    e.information += piece.information;
    e.gradient += piece.gradient;
  }
  e.energy = linear->energy;
  e.readings = linear->readings;
  if (!e.information.allFinite() || !std::isfinite(e.energy) || e.readings == 0) return std::nullopt;
  // About what fits the episode best: how far that lies from `at` is no scatter of its pieces, and no noise.
  const Eigen::VectorXd change = Best(e) - at;
  e.unexplained = std::max(1.0, EnergyAt(e, at + change) / e.readings);
  e.white = std::sqrt(linear->white);
  for (const LinearisedEpisode::Piece& piece : linear->pieces) {
    const Eigen::VectorXd gradient = piece.gradient - piece.information * change;
    e.scatter += gradient * gradient.transpose();
  }
  return e;
}

/// Parameters that fit an episode alone best, to first order; those it does not see as they are.
Eigen::VectorXd EpisodeFollower::Best(const EpisodeEvidence& e) const {
  return e.at + size_.cwiseProduct(FlooredInverse(size_.asDiagonal() * e.information * size_.asDiagonal()) *
                                   size_.cwiseProduct(e.gradient));
}

/// The filter with the episode in it. Errors larger than the noise count less.
InformationFilter EpisodeFollower::Updated(const EpisodeEvidence& e, double seconds) const {
  InformationFilter filter = *filter_;
  const double weight = 1 / e.unexplained;
  const Eigen::MatrixXd added = weight * (size_.asDiagonal() * e.information * size_.asDiagonal());
  const Eigen::MatrixXd known = filter.information();
  const PositiveFactor root(known);
  const Eigen::MatrixXd half = root.SolveLower(added);
  const SymmetricEigen relative = EigenOf(Symmetric(root.SolveLower(Eigen::MatrixXd(half.transpose()))));
  const auto excited = (relative.values.array() > LeastAdded(seconds)).count();
  if (excited > 0) {
    const Eigen::MatrixXd directions = root.SolveUpper(relative.vectors.rightCols(excited));
    filter.Forget(OrthonormalBasis(directions), std::exp(-1 / Memory(seconds)));
  }
  const Eigen::VectorXd cross = weight * size_.cwiseProduct(e.information * e.at + e.gradient);
  filter.Add(added, cross, kUnknown);
  return filter;
}

/// Linearised again until the parameters that follow lie close to where that was done.
EpisodeEvidence EpisodeFollower::Settle(const ReadEpisode& episode, EpisodeEvidence evidence,
                                        double seconds) const {
  for (int step = 1; step < options_.linearisations; ++step) {
    const InformationFilter filter = Updated(evidence, seconds);
    const Eigen::VectorXd next = Admissible(size_.cwiseProduct(Eigen::VectorXd(filter.Theta())));
    const Eigen::VectorXd error =
        size_.cwiseProduct(Eigen::MatrixXd(filter.Covariance()).diagonal().cwiseMax(0).cwiseSqrt());
    if (((next - evidence.at).array().abs() <= options_.close * error.array()).all()) break;
    const auto again = Linearise(episode, next);
    if (!again || again->energy > evidence.energy) break;  // too far: what was linearised before stands
    evidence = *again;
  }
  return evidence;
}

/// What an episode says where it is described best, if that lies beyond chance from where it was linearised: slopes that lead
/// only part of the way leave a remainder there, and what is known sharply seems to have moved for it. Levenberg-Marquardt with
/// slopes that move along. Of models whose episodes tell the parameters by themselves, and have them for a basis.
EpisodeEvidence EpisodeFollower::ByItself(const ReadEpisode& episode, EpisodeEvidence evidence) const {
  if (evidence.gradient.dot(Best(evidence) - evidence.at) <= kBeyondChance * evidence.unexplained)
    return evidence;
  double damping = kBeginDamping;
  for (int step = 0; step < kMostSteps && damping < kMostDamping; ++step) {
    const auto here = Linearise(episode, evidence.at, evidence.at);
    if (!here) break;
    Eigen::MatrixXd damped = size_.asDiagonal() * here->information * size_.asDiagonal();
    damped.diagonal() *= 1 + damping;
    const Eigen::VectorXd next = Admissible(
        evidence.at + size_.cwiseProduct(FlooredInverse(damped) * size_.cwiseProduct(here->gradient)));
    const auto there = Linearise(episode, next);
    const double gained = there ? evidence.energy - there->energy : -1;
    if (gained > 0) {
      evidence = *there;
      damping /= kDampingStep;
      if (gained < kSearchEnds * evidence.unexplained) break;
    } else {
      damping *= kDampingStep;
    }
  }
  return evidence;
}

/// Takes what gradients scatter by into account.
void EpisodeFollower::Widen(const EpisodeEvidence& before, const EpisodeEvidence& settled, bool judged) {
  const double keep = std::exp(-1 / options_.errors_remembered);
  const auto scaled = [&](const Eigen::MatrixXd& m, const EpisodeEvidence& e) -> Eigen::MatrixXd {
    return (size_.asDiagonal() * m * size_.asDiagonal()) / e.unexplained;
  };
  information_ = keep * information_ + scaled(settled.information, settled);
  of_pieces_ = keep * of_pieces_ + scaled(settled.scatter, settled) / settled.unexplained;
  expected_ *= keep;
  of_episodes_ *= keep;
  errors_ *= keep;
  if (!judged) return;
  const Eigen::MatrixXd h = scaled(before.information, settled);
  const Eigen::VectorXd g = size_.cwiseProduct(before.gradient) / settled.unexplained;
  expected_ += h + h * Eigen::MatrixXd(filter_->Covariance()) * h;
  of_episodes_ += g * g.transpose();
  errors_ += 1;
}

/// Per parameter, in the direction that it is estimated by.
std::vector<EpisodeFollower::Scatter> EpisodeFollower::Scatters() const {
  const Eigen::MatrixXd inverse = FlooredInverse(information_);
  std::vector<Scatter> out(static_cast<std::size_t>(count()));
  for (int p = 0; p < count(); ++p) {
    const Eigen::VectorXd d = inverse.col(p);
    const double white = d.dot(information_ * d), expected = d.dot(expected_ * d);
    Scatter& s = out[p];
    if (white > 0) s.pieces = std::max(1.0, d.dot(of_pieces_ * d) / white);
    const double episodes = expected > 0 ? d.dot(of_episodes_ * d) / expected : s.pieces;
    s.episodes =
        (errors_ * episodes + options_.white_episodes * s.pieces) / (errors_ + options_.white_episodes);
  }
  return out;
}

/// Episodes that the past weighs as much as while the parameters stand still.
double EpisodeFollower::StillMemory(double seconds) const {
  return std::max(options_.least_memory, options_.time_constant / std::max(seconds, 1e-9));
}

/// Episodes that the past weighs as much as. Where episodes scatter by more than their pieces say, the parameters move.
double EpisodeFollower::Memory(double seconds) const {
  double moves = 1;
  for (const Scatter& s : Scatters()) moves = std::max(moves, s.episodes / (options_.still * s.pieces));
  return StillMemory(seconds) / moves;
}

std::vector<Estimate> EpisodeFollower::Estimates(const EpisodeEvidence& e, const Eigen::MatrixXd& before,
                                                 double seconds, double end) {
  const Eigen::VectorXd theta = size_.cwiseProduct(Eigen::VectorXd(filter_->Theta())),
                        inside = Admissible(theta);
  const Eigen::MatrixXd covariance = filter_->Covariance();
  const std::vector<Scatter> scatters = Scatters();
  const Eigen::MatrixXd added = (size_.asDiagonal() * e.information * size_.asDiagonal()) / e.unexplained;
  const Eigen::MatrixXd with = Inverse(Inverse(before) + added);
  const Eigen::MatrixXd own = FlooredInverse(added);
  const Eigen::VectorXd behind = (Best(e) - theta).cwiseQuotient(size_);
  std::vector<Estimate> out;
  for (int p = 0; p < count(); ++p) {
    const FollowedParameter& followed = parameter(p);
    const double share = 1 - with(p, p) / before(p, p);
    const bool excited = share > LeastAdded(seconds);
    if (excited) last_excited_[p] = end;
    Estimate estimate;
    estimate.parameter = followed.name;
    estimate.value = inside[p];
    const Scatter& scatter = scatters[p];
    const double lag = excited ? LagVariance(behind[p], own(p, p) * scatter.pieces) : 0.0;
    estimate.std = size_[p] * std::sqrt(std::max(0.0, covariance(p, p)) * scatter.Widening() + lag);
    estimate.unit = followed.unit;
    estimate.excitation = added(p, p) * own(p, p) > 0 ? std::min(1.0, 1 / (added(p, p) * own(p, p))) : 0;
    estimate.last_excited = last_excited_[p];
    const bool seen_alone = added(p, p) * before(p, p) > LeastAdded(seconds);
    estimate.reason =
        theta[p] != inside[p]     ? EstimateReason::kOutsidePhysics
        : !excited && !seen_alone ? EstimateReason::kNotExcited
        : !excited || estimate.std > kUseful * std::max(std::abs(estimate.value), followed.scale)
            ? EstimateReason::kConfounded
            : EstimateReason::kUpdated;
    out.push_back(std::move(estimate));
  }
  return out;
}

/// Begins anew with an episode of another machine: the parameters before it err by far more than others do, and those that they
/// lead to have left the basis behind; or again and again, or at a limit, they lead to none that fit. From there, or from all
/// starts if that fits better. `settled` is then about where it began.
bool EpisodeFollower::Recover(const ReadEpisode& episode, const EpisodeEvidence& before,
                              EpisodeEvidence& settled, double seconds) {
  const double much = options_.lost * options_.lost;
  const int lost_before = std::exchange(lost_, 0);
  EpisodeFollower ahead = *this;
  ahead.Widen(before, settled, true);
  const Eigen::VectorXd led_to = size_.cwiseProduct(Eigen::VectorXd(ahead.Updated(settled, seconds).Theta()));
  const Eigen::VectorXd next = Admissible(led_to), basis = model_->BasisAt(next, basis_);
  const bool far = basis != basis_;
  if ((far ? before.energy : settled.energy) <= much * settled.readings) return false;
  EpisodeFollower on = *this;
  on.Begin({.parameters = next, .size = size_, .basis = basis, .shown_noise = shown_noise_});
  auto found = on.Linearise(episode, next);
  if (found) found = on.Settle(episode, *found, seconds);
  if (EpisodeFollower anew = *this; anew.Begin(episode)) {
    const auto sought = anew.Linearise(episode, anew.parameters());
    if (sought && (!found || sought->energy < found->energy - options_.better)) {
      on = std::move(anew);
      found = sought;
    }
  }
  if (!found) return false;
  if (const bool another = far && much * found->energy < before.energy; !another) {
    if (!(much * found->energy < settled.energy)) return false;  // what the model misses
    lost_ = lost_before + 1;
    if (lost_ < options_.patience && led_to == next) return false;
  }
  on.lost_ = 0;
  on.shown_noise_ = shown_noise_;  // what all episodes are measured against
  on.basis_ = found->at;
  found = on.Linearise(episode, found->at);
  if (!found) return false;
  *this = std::move(on);
  settled = *found;
  return true;
}

/// Where the parameters are lost, or the search ended at a limit, none is told beside the others; a limit says nothing.
void EpisodeFollower::TellLost(FollowedEpisode& followed) const {
  if (!model_->told_by_one()) return;
  const bool at_limit = std::ranges::any_of(
      followed.estimates, [](const Estimate& e) { return e.reason == EstimateReason::kOutsidePhysics; });
  if (lost_ == 0 && !at_limit) return;
  if (at_limit) followed.evidence = {};
  for (Estimate& e : followed.estimates)
    if (e.reason == EstimateReason::kUpdated) e.reason = EstimateReason::kConfounded;
}

FollowedEpisode EpisodeFollower::Add(const Episode& episode) {
  FollowedEpisode out;
  out.error_before = out.error_least = kUnknown;
  const std::unique_ptr<const ReadEpisode> read = model_->Read(episode);
  if (read == nullptr) return out;
  const bool first = !begun();
  if (first && !Begin(*read)) return out;
  const double seconds = episode.time.back() - episode.time.front();
  auto before = Linearise(*read, parameters());
  if (!before) return out;
  EpisodeEvidence settled = Settle(*read, *before, seconds);
  bool anew = false;
  if (const bool young = episodes_ > 0 && episodes_ < options_.young && refits_ < options_.refits;
      young && settled.energy > options_.lost * options_.lost * settled.readings) {
    ++refits_;
    const EpisodeFollower kept = *this;
    anew = Begin(*read);
    if (anew) before = Linearise(*read, parameters());
    if (!anew || !before) {
      *this = kept;
      return out;
    }
    settled = *before;
  }
  if (!first && !anew && model_->told_by_one()) {
    anew = Recover(*read, *before, settled, seconds);
    if (!anew) settled = ByItself(*read, std::move(settled));
  }
  const Eigen::MatrixXd covariance = filter_->Covariance();
  Widen(*before, settled, !first && !anew);
  out.error_before = first ? kUnknown : before->ErrorAt(before->at);
  filter_ = Updated(settled, seconds);
  basis_ = model_->BasisAt(parameters(), basis_);
  ++episodes_;
  out.estimates = Estimates(settled, covariance, seconds, episode.time.back());
  out.error_least = settled.ErrorAt(Best(settled));
  out.error_white = std::min(out.error_least, settled.white);
  out.evidence = std::move(settled);
  TellLost(out);
  return out;
}

void EpisodeFollower::Save(ByteWriter& out) const {
  out.Put<std::int32_t>(count());
  out.Put<std::int32_t>(model_->basis_size());
  out.Put<std::uint8_t>(begun());
  out.Put<std::int32_t>(episodes_);
  out.Put<std::int32_t>(refits_);
  if (!begun()) return;
  PutNumbers(out, basis_);
  PutNumbers(out, size_);
  out.Put(shown_noise_);
  PutNumbers(out, filter_->information());
  PutNumbers(out, filter_->state());
  for (const Eigen::MatrixXd* m : {&information_, &of_pieces_, &expected_, &of_episodes_})
    PutNumbers(out, *m);
  out.Put(errors_);
  PutNumbers(out, last_excited_);
  if (model_->told_by_one()) out.Put<std::int32_t>(lost_);
}

bool EpisodeFollower::Restore(ByteReader& in) {
  if (in.Get<std::int32_t>() != count() || in.Get<std::int32_t>() != model_->basis_size()) return false;
  const bool begun = in.Get<std::uint8_t>() != 0;
  episodes_ = in.Get<std::int32_t>();
  refits_ = in.Get<std::int32_t>();
  filter_.reset();
  if (!begun) return in.ok();
  basis_ = GetNumbers(in, model_->basis_size(), 1);
  size_ = GetNumbers(in, count(), 1);
  shown_noise_ = in.Get<double>();
  const Eigen::MatrixXd information = GetNumbers(in, count(), count());
  const Eigen::VectorXd state = GetNumbers(in, count(), 1);
  for (Eigen::MatrixXd* m : {&information_, &of_pieces_, &expected_, &of_episodes_})
    *m = GetNumbers(in, count(), count());
  errors_ = in.Get<double>();
  last_excited_ = GetNumbers(in, count(), 1);
  lost_ = model_->told_by_one() && !in.at_end() ? in.Get<std::int32_t>() : 0;
  if (!in.ok() || !basis_.allFinite() || !(shown_noise_ > 0) || !(size_.array() > 0).all()) return false;
  filter_.emplace(InformationFilter::Matrix(information), InformationFilter::Vector(state),
                  InformationFilter::Matrix(Eigen::MatrixXd::Constant(count(), count(), kUnknown)),
                  1 / options_.covariance);
  return true;
}

}  // namespace hydroscope
