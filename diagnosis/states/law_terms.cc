#include "diagnosis/states/law_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>

#include "diagnosis/states/added_effect.h"
#include "estimation/decompositions.h"
#include "estimation/states/shooting.h"

namespace hydroscope {
namespace {

/// Where the terms of effects are compared: states and inputs along a candidate's run, and the size of each equation's rate.
struct RunRows {
  std::vector<Eigen::VectorXd> states;
  std::vector<std::vector<double>> inputs;
  Eigen::VectorXd size;  ///< states, then outputs
};

/// Every `apart`th row.
RunRows RowsOf(const StateCandidate& candidate, std::span<const Episode> episodes, int apart) {
  const StateModel& model = *candidate.fit.model;
  RunRows out;
  out.size = Eigen::VectorXd::Zero(model.states() + model.output.rows);
  for (std::size_t e = 0; e < episodes.size(); ++e)
    for (int row = 0; row + 1 < episodes[e].rows(); row += apart) {
      const StateRun& run = candidate.fit.runs[e];
      std::vector<double> input(static_cast<std::size_t>(model.driving()));
      for (std::size_t i = 0; i < model.inputs.size(); ++i)
        input[i] = episodes[e].signal(row, model.inputs[i]);
      out.states.push_back(run.states.row(row).transpose());
      out.inputs.push_back(std::move(input));
      const double period = episodes[e].time[static_cast<std::size_t>(row) + 1] -
                            episodes[e].time[static_cast<std::size_t>(row)];
      out.size.head(model.states()) +=
          ((run.states.row(row + 1) - run.states.row(row)) / period).cwiseAbs2().transpose();
      out.size.tail(model.output.rows) += candidate.fit.scale.cwiseAbs2();
    }
  out.size = out.size.cwiseMax(1e-300).cwiseSqrt();
  return out;
}

/// Row x equation: terms of effects at these parameters of the model with them, over the size of the equation's rate.
RowMatrix TermsAt(AddedEffect& effect, const Eigen::VectorXd& parameters, const RunRows& rows) {
  effect.SetDraw(parameters);
  RowMatrix out = RowMatrix::Zero(static_cast<Eigen::Index>(rows.states.size()), rows.size.size());
  std::vector<double> values(effect.equations().size());
  for (std::size_t r = 0; r < rows.states.size(); ++r) {
    effect.Values(rows.states[r].data(), rows.inputs[r].data(), values.data());
    for (std::size_t k = 0; k < values.size(); ++k) {
      const int equation = effect.equations()[k];
      out(static_cast<Eigen::Index>(r), equation) = values[k] / rows.size[equation];
    }
  }
  return out;
}

/// The same of the effects that `with` has and `near` lacks.
RowMatrix TermsAt(const StateModel& near, const StateModel& with, const Eigen::VectorXd& parameters,
                  const RunRows& rows) {
  AddedEffect effect(near, with, parameters.head(near.parameter_count()));
  return TermsAt(effect, parameters, rows);
}

/// Those of a model whose parameters a fit of more effects has.
Eigen::VectorXd ParametersFor(const StateModel& model, const StateFit& fit) {
  Eigen::VectorXd out(model.parameter_count());
  const auto& known = fit.model->parameters;
  for (int p = 0; p < model.parameter_count(); ++p)
    out[p] = fit.parameters[std::ranges::find(known, model.parameters[static_cast<std::size_t>(p)].name,
                                              &StateParameter::name) -
                            known.begin()];
  return out;
}

bool ReadsThePastAnew(const StateModel& base, const StateModel& with) {
  // What a delayed input is at a row is not at hand here.
  return !base.delays.empty() || !with.delays.empty();
}

class NearestLawSearch {
 public:
  NearestLawSearch(const StateModel& near, const StateCandidate& found, const StateModel& with,
                   std::span<const Episode> episodes, const NearestLawOptions& options)
      : with_(with), scale_(with), options_(options) {
    std::int64_t rows = 0;
    for (const Episode& episode : episodes) rows += episode.rows();
    rows_ = RowsOf(found, episodes, static_cast<int>(std::max<std::int64_t>(1, rows / options.rows)));
    wanted_ = TermsAt(near, *found.fit.model, found.fit.parameters, rows_);
    TakeKnown(found.fit);
    effect_.emplace(near, with, first_.head(near.parameter_count()));
  }

  std::optional<NearestLaw> Run() {
    if (!(wanted_.norm() > 0)) return std::nullopt;
    std::mt19937 random(options_.seed);
    std::vector<std::pair<double, Eigen::VectorXd>> draws = {{Unlike(first_), first_}};
    for (int k = 0; k < options_.draws && !own_.empty(); ++k) {
      Eigen::VectorXd drawn = Drawn(random);
      const double unlike = Unlike(drawn);
      draws.emplace_back(unlike, std::move(drawn));
    }
    const std::size_t kept = std::min(draws.size(), static_cast<std::size_t>(std::max(1, options_.kept)));
    std::partial_sort(draws.begin(), draws.begin() + static_cast<std::ptrdiff_t>(kept), draws.end(),
                      [](const auto& a, const auto& b) { return a.first < b.first; });
    NearestLaw nearest{first_, Apart(first_)};
    for (std::size_t k = 0; k < kept && !own_.empty(); ++k) {
      Eigen::VectorXd sought = Sought(draws[k].second);
      if (const double apart = Apart(sought); apart < nearest.apart) nearest = {std::move(sought), apart};
    }
    return nearest;
  }

 private:
  void TakeKnown(const StateFit& found) {
    first_.resize(with_.parameter_count());
    for (int p = 0; p < with_.parameter_count(); ++p) {
      const StateParameter& parameter = with_.parameters[static_cast<std::size_t>(p)];
      const auto& known = found.model->parameters;
      const auto at = std::find_if(known.begin(), known.end(),
                                   [&](const StateParameter& other) { return other.name == parameter.name; });
      first_[p] = at != known.end() ? found.parameters[at - known.begin()] : parameter.spec.start;
      if (at == known.end()) own_.push_back(p);
    }
  }

  Eigen::VectorXd Drawn(std::mt19937& random) const {
    std::uniform_real_distribution<double> uniform;
    Eigen::VectorXd drawn = first_;
    for (const int p : own_) {
      const double share = uniform(random);
      const auto at = static_cast<std::size_t>(p);
      if (scale_.ranged(at))
        drawn[p] = scale_.FromScaled(at, scale_.low(at) + share * (scale_.high(at) - scale_.low(at)));
    }
    return drawn;
  }

  /// 1 less the squared correlation of terms: how far they would be apart if they could be scaled.
  double Unlike(const Eigen::VectorXd& parameters) {
    const RowMatrix terms = TermsAt(*effect_, parameters, rows_);
    const double both = terms.cwiseProduct(wanted_).sum(), size = terms.squaredNorm();
    const double unlike = both > 0 ? 1 - both * both / (size * wanted_.squaredNorm()) : 1;
    return std::isfinite(unlike) ? unlike : 1;
  }

  RowMatrix Difference(const Eigen::VectorXd& parameters) {
    return (TermsAt(*effect_, parameters, rows_) - wanted_) / wanted_.norm();
  }
  double Apart(const Eigen::VectorXd& parameters) {
    const double norm = Difference(parameters).norm();
    return std::isfinite(norm) ? norm : std::numeric_limits<double>::infinity();
  }

  Eigen::VectorXd Parameters(const Eigen::VectorXd& from, const Eigen::VectorXd& scaled) const {
    Eigen::VectorXd parameters = from;
    for (std::size_t k = 0; k < own_.size(); ++k)
      parameters[own_[k]] =
          scale_.FromScaled(static_cast<std::size_t>(own_[k]), scaled[static_cast<Eigen::Index>(k)]);
    return parameters;
  }

  /// Differences by the effects' own parameters, scaled.
  Eigen::MatrixXd Slopes(const Eigen::VectorXd& from, const Eigen::VectorXd& scaled) {
    constexpr double kStep = 1e-6;
    const RowMatrix here = Difference(Parameters(from, scaled));
    Eigen::MatrixXd slopes(here.size(), scaled.size());
    for (Eigen::Index k = 0; k < scaled.size(); ++k) {
      Eigen::VectorXd beside = scaled;
      beside[k] += kStep;
      const RowMatrix change = (Difference(Parameters(from, beside)) - here) / kStep;
      slopes.col(k) = change.reshaped();
    }
    return slopes;
  }

  /// The nearest from a draw by Levenberg and Marquardt's method, inside the ranges.
  Eigen::VectorXd Sought(const Eigen::VectorXd& from) {
    constexpr double kLeastDamping = 1e-9, kMostDamping = 1e9, kFactor = 10;
    const auto count = static_cast<Eigen::Index>(own_.size());
    Eigen::VectorXd scaled(count), low(count), high(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto p = static_cast<std::size_t>(own_[static_cast<std::size_t>(k)]);
      scaled[k] = scale_.ToScaled(p, from[own_[static_cast<std::size_t>(k)]]);
      low[k] = scale_.low(p);
      high[k] = scale_.high(p);
    }
    double apart = Apart(from), damping = 1e-3;
    for (int step = 0; step < options_.iterations && damping < kMostDamping; ++step) {
      const Eigen::MatrixXd slopes = Slopes(from, scaled);
      const Eigen::VectorXd error = Difference(Parameters(from, scaled)).reshaped();
      if (!slopes.allFinite() || !error.allFinite()) break;
      const Eigen::MatrixXd information = slopes.transpose() * slopes;
      for (bool lower = false; !lower && damping < kMostDamping;) {
        Eigen::MatrixXd damped = information;
        damped.diagonal() *= 1 + damping;
        damped.diagonal().array() += 1e-300;
        const Eigen::VectorXd next =
            (scaled - SymmetricFactor(damped).Solve(slopes.transpose() * error)).cwiseMax(low).cwiseMin(high);
        const double there = Apart(Parameters(from, next));
        lower = there < apart;
        damping = lower ? std::max(damping / kFactor, kLeastDamping) : damping * kFactor;
        if (!lower) continue;
        scaled = next;
        apart = there;
      }
    }
    return Parameters(from, scaled);
  }

  const StateModel& with_;
  shooting::ParameterScale scale_;
  const NearestLawOptions& options_;
  RunRows rows_;
  RowMatrix wanted_;
  Eigen::VectorXd first_;
  std::vector<int> own_;               ///< parameters that `found` does not have
  std::optional<AddedEffect> effect_;  ///< of `with`; the other parameters stay as they are
};

}  // namespace

bool SameLaw(const StateFit& base, const StateCandidate& a, const StateCandidate& b,
             std::span<const Episode> episodes, double share, const StateModel* some) {
  if (ReadsThePastAnew(*base.model, *a.fit.model) || ReadsThePastAnew(*base.model, *b.fit.model))
    return false;
  const auto terms = [&](const StateCandidate& candidate) {
    return TermsAt(*base.model, *candidate.fit.model, candidate.fit.parameters,
                   RowsOf(candidate, episodes, 1));
  };
  const RowMatrix of_a = terms(a);
  const double size =
      some == nullptr
          ? of_a.norm()
          : TermsAt(*base.model, *some, ParametersFor(*some, a.fit), RowsOf(a, episodes, 1)).norm();
  return (of_a - terms(b)).norm() <= share * size;
}

std::optional<NearestLaw> NearestLawTo(const StateFit& base, const StateCandidate& found,
                                       const StateModel& with, std::span<const Episode> episodes,
                                       const NearestLawOptions& options) {
  if (ReadsThePastAnew(*base.model, *found.fit.model) || ReadsThePastAnew(*base.model, with))
    return std::nullopt;
  return NearestLawSearch(*base.model, found, with, episodes, options).Run();
}

}  // namespace hydroscope
