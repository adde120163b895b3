#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "core/bytes.h"
#include "core/records/estimate.h"
#include "estimation/recursive/episode_model.h"
#include "estimation/recursive/information_filter.h"

namespace hydroscope {

struct EpisodeFollowerOptions {
  double time_constant = 60;  ///< s of excited data over which the past is forgotten, ...
  double least_memory = 5;    ///< ... but no less than so many episodes, ...
  /// ... less where episodes scatter by more than this many times what their pieces say: they move.
  double still = 1.5;
  /// Of parameters over their size, before anything is known of them, and the most ever.
  double covariance = 1;
  /// Of what an episode adds to a direction where all are alike, over the memory: what it must add.
  double excited = 0.1;
  int linearisations = 3;  ///< of one episode at most
  double close = 0.3;  ///< standard errors that the parameters may lie from where an episode was linearised
  double lost = 2;     ///< rms error over the noise beyond which a young follower is fitted anew
  int young = 10;      ///< episodes
  int refits = 3;      ///< fits from all starts at most, after the first
  /// Squared errors that a fit from all starts must be better by than one from where it was: a likelihood ratio of 20.
  double better = 6;
  /// Episodes that parameters may be lost for before they are sought anew; most find their way back.
  int patience = 6;
  double errors_remembered = 20;  ///< episodes from whose errors the intervals are widened
  /// Episodes that the pieces of episodes count as beside the episodes themselves.
  double white_episodes = 5;
};

/// What one episode says of the parameters, linearised about `at`: errors over their noise (LinearisedEpisode). To first order the errors of other parameters p are those at `at` less slopes * (p - at).
struct EpisodeEvidence {
  Eigen::VectorXd at;           ///< SI
  Eigen::MatrixXd information;  ///< sum of slopes' slopes
  Eigen::VectorXd gradient;     ///< sum of slopes' errors
  Eigen::MatrixXd scatter;      ///< sum of gradient gradient' over its pieces, about what fits it best
  double energy = 0;            ///< sum of squared errors
  int readings = 0;
  double unexplained = 1;  ///< mean squared error that no parameters take away, at least 1 (the noise)
  double white = 0;  ///< rms over the noise of what may be white noise in the errors (WhiteNoiseVariance)

  /// rms error that other parameters would leave, over the noise.
  double ErrorAt(const Eigen::VectorXd& parameters) const;
};

/// What following an episode gave.
struct FollowedEpisode {
  EpisodeEvidence evidence;  ///< where it was linearised last; without readings: the model cannot be run
  double error_before = 0;   ///< rms over the noise, with the parameters before it; NaN for the first
  double error_least = 0;    ///< ... with those that fit it best
  /// ... that white noise may cause: the rest is coloured noise, or what the model misses.
  double error_white = 0;
  std::vector<Estimate> estimates;  ///< empty before the first fit
};

/// Follows the parameters of a machine from episode to episode. The first one is fitted from all starts. Each one after is
/// linearised at the parameters as they are (ReadEpisode); error and information go into a filter that forgets only what the
/// episode sees anew (InformationFilter); where that moves the parameters by more than a share of their standard error, it is
/// linearised again there (iterated extended Kalman filter, Bell and Cathey 1993, with parameters for states). Where each
/// episode tells the parameters by itself, one of another machine begins the follower anew at any age. Errors are
/// correlated in time: intervals are widened by how much more gradients scatter than white errors would make them, of pieces
/// within episodes (clusters, as TakeCovariance) and of the episodes themselves against the parameters before them.
/// Deterministic; everything it remembers is saved.
class EpisodeFollower {
 public:
  EpisodeFollower(std::shared_ptr<const EpisodeModel> model, const EpisodeFollowerOptions& options = {});

  /// Episodes in the order of their recording.
  FollowedEpisode Add(const Episode& episode);

  const EpisodeModel& model() const { return *model_; }
  bool begun() const { return filter_.has_value(); }
  Eigen::VectorXd parameters() const;
  /// Noise of the errors as they are shown: SI of a single output, of several their share of its variation.
  double shown_noise() const { return shown_noise_; }

  void Save(ByteWriter& out) const;
  /// False: the state is of another model.
  bool Restore(ByteReader& in);

 private:
  int count() const { return static_cast<int>(model_->parameters().size()); }
  const FollowedParameter& parameter(int p) const { return model_->parameters()[p]; }
  bool Begin(const ReadEpisode& episode);
  void Begin(const FirstFit& fit);
  std::optional<EpisodeEvidence> Linearise(const ReadEpisode& episode, const Eigen::VectorXd& at,
                                           const Eigen::VectorXd& basis) const;
  std::optional<EpisodeEvidence> Linearise(const ReadEpisode& episode, const Eigen::VectorXd& at) const {
    return Linearise(episode, at, basis_);
  }
  EpisodeEvidence ByItself(const ReadEpisode& episode, EpisodeEvidence evidence) const;
  Eigen::VectorXd Best(const EpisodeEvidence& evidence) const;
  InformationFilter Updated(const EpisodeEvidence& evidence, double seconds) const;
  EpisodeEvidence Settle(const ReadEpisode& episode, EpisodeEvidence evidence, double seconds) const;
  bool Recover(const ReadEpisode& episode, const EpisodeEvidence& before, EpisodeEvidence& settled,
               double seconds);
  void TellLost(FollowedEpisode& followed) const;
  void Widen(const EpisodeEvidence& before, const EpisodeEvidence& settled, bool judged);
  /// Variance of gradients over that of white errors: of pieces of episodes, and of episodes against the parameters before.
  struct Scatter {
    double pieces = 1, episodes = 1;
    double Widening() const { return std::max({1.0, pieces, episodes}); }
  };
  std::vector<Scatter> Scatters() const;
  double StillMemory(double seconds) const;
  double Memory(double seconds) const;
  double LeastAdded(double seconds) const { return options_.excited / StillMemory(seconds); }
  std::vector<Estimate> Estimates(const EpisodeEvidence& evidence, const Eigen::MatrixXd& before,
                                  double seconds, double end);
  Eigen::VectorXd Admissible(const Eigen::VectorXd& parameters) const;

  std::shared_ptr<const EpisodeModel> model_;
  EpisodeFollowerOptions options_;
  Eigen::VectorXd basis_, size_;
  double shown_noise_ = 0;
  std::optional<InformationFilter> filter_;  ///< of parameters over `size_`, noise of variance 1
  /// Of gradients, over `size_`, exponentially forgotten: information, what pieces scatter by; what episodes should scatter by
  /// and do.
  Eigen::MatrixXd information_, of_pieces_, expected_, of_episodes_;
  double errors_ = 0;  ///< episodes that of_episodes_ rests on
  Eigen::VectorXd last_excited_;
  int episodes_ = 0, refits_ = 0;
  int lost_ =
      0;  ///< episodes in a row that a fit from all starts fits far better, where each tells by itself
};

}  // namespace hydroscope
