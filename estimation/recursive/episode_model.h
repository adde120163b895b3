#pragma once

#include <Eigen/Dense>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/told.h"
#include "estimation/episode.h"
#include "models/machine.h"

namespace hydroscope {

/// A parameter that is followed from episode to episode. SI.
struct FollowedParameter {
  std::string name, unit;
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
  double scale = 0;  ///< of one that is 0 where all is well: what its errors are compared with
};

/// What the first episode gives, fitted from all starts.
struct FirstFit {
  Eigen::VectorXd parameters;  ///< SI
  Eigen::VectorXd size;        ///< SI, above 0: of each parameter, as far as it is known before anything is
  /// SI, what all following episodes are measured against: the noise of each output, or the parameters that they
  /// are linearised about.
  Eigen::VectorXd basis;
  double shown_noise = 0;  ///< of the errors as they are shown
};

/// An episode linearised: errors over their noise against the slopes of what the model gives, in pieces of it.
struct LinearisedEpisode {
  struct Piece {
    Eigen::MatrixXd information;  ///< slopes' slopes
    Eigen::VectorXd gradient;     ///< slopes' errors, errors measured less modelled
  };
  std::vector<Piece> pieces;
  double energy = 0;  ///< sum of squared errors
  int readings = 0;   ///< independent errors in it
  /// Mean square of the errors that may be white noise (WhiteNoiseVariance); infinity: they are not told apart.
  double white = std::numeric_limits<double>::infinity();
};

/// An episode as its model reads it.
class ReadEpisode {
 public:
  virtual ~ReadEpisode() = default;
  /// From all starts; nothing if none leads anywhere.
  virtual std::optional<FirstFit> Fit() const = 0;
  /// About `at`, SI; nothing where the model cannot be run there.
  virtual std::optional<LinearisedEpisode> Linearise(const Eigen::VectorXd& at,
                                                     const Eigen::VectorXd& basis) const = 0;
};

/// What tells of each episode what it says of the parameters, apart from all others. One for each way in which machines are
/// judged in episodes; following, storing, watching and reporting know no other difference between them.
class EpisodeModel {
 public:
  virtual ~EpisodeModel() = default;
  virtual const Machine& machine() const = 0;
  virtual const std::vector<FollowedParameter>& parameters() const = 0;
  virtual int basis_size() const = 0;  ///< entries of FirstFit::basis
  /// Each episode tells the parameters by itself, and limits are where a search ends, nothing that a machine comes to: a
  /// follower that has lost them fits anew at any age.
  virtual bool told_by_one() const { return false; }
  /// The basis for parameters that have come to `at`: `basis` as it is while it leads on from there.
  virtual Eigen::VectorXd BasisAt(const Eigen::VectorXd& at, const Eigen::VectorXd& basis) const {
    return at.size() > 0 ? basis : Eigen::VectorXd();
  }
  /// The episode must outlive what is returned; nullptr: it says nothing.
  virtual std::unique_ptr<ReadEpisode> Read(const Episode& episode) const = 0;
  /// What makes doubtful what an episode says, however well it is described.
  virtual std::vector<Told> DoubtsOf(const Episode& /*episode*/) const { return {}; }
};

}  // namespace hydroscope
