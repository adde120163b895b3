#include "estimation/states/state_episodes.h"

#include <cmath>
#include <limits>

#include "estimation/states/fit.h"
#include "estimation/states/white_noise.h"

namespace hydroscope {
namespace {

constexpr double kShareOfRange = 1e-3;  // that a parameter counts as large as, however small it is

/// Mean square of the white noise in the errors of an episode, outputs over their noise.
double WhiteShare(const Episode& episode, const RowMatrix& residual, const Eigen::VectorXd& noise) {
  double energy = 0, count = 0;
  for (Eigen::Index j = 0; j < residual.cols(); ++j) {
    WhiteNoiseVariance white;
    white.Add(residual.col(j), episode.mean_rows);
    energy += white.count() * white.Value() / (noise[j] * noise[j]);
    count += white.count();
  }
  return count > 0 ? energy / count : std::numeric_limits<double>::infinity();
}

class SimulatedEpisode : public ReadEpisode {
 public:
  SimulatedEpisode(std::shared_ptr<const StateModel> model, const Episode& episode)
      : model_(std::move(model)), episode_(episode) {}

  std::optional<FirstFit> Fit() const override {
    const StateFit fit = FitStates(model_, {&episode_, 1});
    if (!fit.solved()) return std::nullopt;
    FirstFit first{fit.parameters, Eigen::VectorXd::Ones(fit.parameters.size()), fit.noise, 0};
    first.shown_noise = fit.noise.size() == 1 ? fit.noise[0]
                                              : std::sqrt(fit.noise.cwiseQuotient(fit.scale).squaredNorm() /
                                                          static_cast<double>(fit.noise.size()));
    for (int p = 0; p < model_->parameter_count(); ++p) {
      const ParameterSpec& spec = model_->parameters[p].spec;
      const double range = std::isfinite(spec.max - spec.min) ? spec.max - spec.min : std::abs(spec.start);
      if (const double size = std::max(std::abs(fit.parameters[p]), kShareOfRange * range); size > 0)
        first.size[p] = size;
    }
    return first;
  }

  std::optional<LinearisedEpisode> Linearise(const Eigen::VectorXd& at,
                                             const Eigen::VectorXd& basis) const override {
    const StateFit fit = FollowStates(model_, {&episode_, 1}, at, basis);
    if (!fit.solved()) return std::nullopt;
    LinearisedEpisode out;
    for (const StatePiece& piece : fit.pieces) {
      out.pieces.push_back({piece.information, piece.gradient});
      out.energy += piece.energy;
      out.readings += piece.readings;
    }
    out.white = WhiteShare(episode_, fit.residuals.front(), basis);
    return out;
  }

 private:
  std::shared_ptr<const StateModel> model_;
  const Episode& episode_;
};

class StateEpisodes : public EpisodeModel {
 public:
  explicit StateEpisodes(std::shared_ptr<const StateModel> states) : states_(std::move(states)) {
    for (const StateParameter& p : states_->parameters) {
      const bool may_be_none = p.spec.start == 0 && std::isfinite(p.spec.max - p.spec.min);
      parameters_.push_back({.name = p.name,
                             .unit = p.spec.unit.empty() ? "1" : p.spec.unit,
                             .min = p.spec.min,
                             .max = p.spec.max,
                             .scale = may_be_none ? kShareOfRange * (p.spec.max - p.spec.min) : 0});
    }
  }
  const Machine& machine() const override { return states_->machine; }
  const std::vector<FollowedParameter>& parameters() const override { return parameters_; }
  int basis_size() const override { return states_->output.rows; }
  std::unique_ptr<ReadEpisode> Read(const Episode& episode) const override {
    return std::make_unique<SimulatedEpisode>(states_, episode);
  }

 private:
  std::shared_ptr<const StateModel> states_;
  std::vector<FollowedParameter> parameters_;
};

}  // namespace

std::shared_ptr<const EpisodeModel> EpisodesOfStates(std::shared_ptr<const StateModel> states) {
  return std::make_shared<StateEpisodes>(std::move(states));
}

}  // namespace hydroscope
