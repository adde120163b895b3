#include "diagnosis/states/screened_effect.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>

#include "diagnosis/states/added_effect.h"
#include "diagnosis/states/tangent.h"
#include "estimation/column_products.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

class EffectScreen {
 public:
  EffectScreen(const StateFit& near, const StateModel& with, std::span<const Episode> episodes,
               const ScreeningOptions& options)
      : near_(near), with_(with), episodes_(episodes), options_(options) {}

  ScreenedEffect Run() {
    TakeKnown();
    if (with_.delays.size() != near_.model->delays.size()) return Unranked();
    factor_ = ProportionalTo();
    Draw();
    double energy = 0;
    const std::vector<Score> scores = Scores(energy);
    std::vector<std::size_t> order(draws_.size());
    for (std::size_t d = 0; d < order.size(); ++d) order[d] = d;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return scores[a].explained > scores[b].explained; });
    ScreenedEffect out;
    const auto largest = [&](double Score::*energy) {
      double most = 0;
      for (const Score& score : scores) most = std::max(most, score.*energy);
      return most;
    };
    out.seen = largest(&Score::changes) < options_.least_seen          ? EffectSeen::kNeverActs
               : largest(&Score::not_taken_over) < options_.least_seen ? EffectSeen::kTakenOver
                                                                       : EffectSeen::kYes;
    out.explained = energy > 0 ? std::clamp(scores[order.front()].explained / energy, 0.0, 1.0) : 0.0;
    for (std::size_t k = 0; k < order.size() && k < static_cast<std::size_t>(options_.kept); ++k) {
      StateStart start{draws_[order[k]], near_.initial};
      if (factor_ >= 0) {
        const ParameterSpec& spec = SpecOf(factor_);
        start.parameters[factor_] =
            std::clamp(scores[order[k]].amplitude * start.parameters[factor_], spec.min, spec.max);
      }
      out.starts.push_back(std::move(start));
    }
    out.starts.push_back({first_, near_.initial});
    return out;
  }

 private:
  struct Score {
    double explained = 0;  ///< energy, in noise variances
    double amplitude = 1;  ///< of the draw's effect
    double changes = 0;    ///< energy of what the largest such effect does to the outputs, in noise variances
    double not_taken_over = 0;  ///< ... with parameters and initial states free
  };

  /// An effect that delays an input reads what the model without it does not have at hand.
  ScreenedEffect Unranked() const {
    ScreenedEffect out{{{first_, near_.initial}}, std::nullopt};
    std::mt19937 random(options_.seed);
    for (int k = 0; k < options_.unranked; ++k) out.starts.push_back({Drawn(random), near_.initial});
    return out;
  }

  const ParameterSpec& SpecOf(int p) const { return with_.parameters[static_cast<std::size_t>(p)].spec; }

  void TakeKnown() {
    first_.resize(with_.parameter_count());
    for (int p = 0; p < with_.parameter_count(); ++p) {
      const auto& known = near_.model->parameters;
      const auto at = std::find_if(known.begin(), known.end(), [&](const StateParameter& other) {
        return other.name == with_.parameters[static_cast<std::size_t>(p)].name;
      });
      if (at != known.end()) {
        first_[p] = near_.parameters[at - known.begin()];
      } else {
        first_[p] = SpecOf(p).start;
        new_.push_back(p);
      }
    }
  }

  Eigen::VectorXd Drawn(std::mt19937& random) const {
    std::uniform_real_distribution<double> uniform;
    Eigen::VectorXd drawn = first_;
    for (const int p : new_) {
      const double share = uniform(random);
      const ParameterSpec& spec = SpecOf(p);
      if (!std::isfinite(spec.min) || !std::isfinite(spec.max)) continue;
      drawn[p] = spec.min > 0 ? spec.min * std::pow(spec.max / spec.min, share)
                              : spec.min + share * (spec.max - spec.min);
    }
    return drawn;
  }

  /// A new parameter which the effect is proportional to, at rows of the log and draws; -1 if there is none.
  int ProportionalTo() const {
    constexpr int kRows = 40, kDraws = 5;
    constexpr double kRounding = 1e-6;  // values are differences of rates that may be much larger
    std::mt19937 random(options_.seed);
    for (const int p : new_) {
      AddedEffect effect(*near_.model, with_, near_.parameters);
      for (int d = 0; d < kDraws; ++d) {
        Eigen::VectorXd drawn = Drawn(random);
        if (drawn[p] == 0) drawn[p] = 1;
        effect.AddDraw(drawn);
        drawn[p] *= 0.5;
        effect.AddDraw(drawn);
      }
      const auto effect_rows = static_cast<int>(effect.equations().size());
      std::vector<double> values(static_cast<std::size_t>(2 * kDraws * effect_rows)),
          input(static_cast<std::size_t>(with_.driving()), 0.0);
      double size = 0, off = 0;
      for (std::size_t e = 0; e < episodes_.size(); ++e)
        for (int k = 0; k < kRows; ++k) {
          const int row = static_cast<int>(static_cast<std::int64_t>(episodes_[e].rows() - 1) * k / kRows);
          for (std::size_t i = 0; i < with_.inputs.size(); ++i)
            input[i] = episodes_[e].signal(row, with_.inputs[i]);
          const Eigen::VectorXd state = near_.runs[e].states.row(row).transpose();
          effect.Values(state.data(), input.data(), values.data());
          for (int d = 0; d < kDraws; ++d)
            for (int r = 0; r < effect_rows; ++r) {
              const double whole = values[static_cast<std::size_t>(2 * d * effect_rows + r)],
                           half = values[static_cast<std::size_t>((2 * d + 1) * effect_rows + r)];
              size += std::abs(whole);
              off += std::abs(whole - 2 * half);
            }
        }
      if (size > 0 && off <= kRounding * size) return p;
    }
    return -1;
  }

  void Draw() {
    draws_ = {first_};
    if (factor_ >= 0 && draws_.front()[factor_] == 0)
      draws_.front()[factor_] =
          std::isfinite(SpecOf(factor_).max) && SpecOf(factor_).max > 0 ? SpecOf(factor_).max : 1;
    if (new_.empty() || (new_.size() == 1 && factor_ == new_.front())) return;  // all draws would be one
    std::mt19937 random(options_.seed);
    for (int k = 0; k < options_.draws; ++k) draws_.push_back(Drawn(random));
  }

  /// Of each draw; `energy`: that of the error.
  std::vector<Score> Scores(double& energy) const {
    AddedEffect effect(*near_.model, with_, near_.parameters);
    for (const Eigen::VectorXd& draw : draws_) effect.AddDraw(draw);
    const AddedTerms added = effect.Terms();
    const int parameters = near_.model->parameter_count(), columns = added.columns;
    // Sums over all episodes, initial states taken out: parameters, draws, error.
    const int all = parameters + columns + 1;
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(all, all);
    for (std::size_t e = 0; e < episodes_.size(); ++e) {
      sums += ColumnProducts(TangentColumns(near_, episodes_[e], e, added, {&near_.residuals[e]}));
    }
    std::vector<Score> scores(draws_.size());
    const Eigen::MatrixXd weights =
        parameters > 0
            ? ScaledFactor(sums.topLeftCorner(parameters, parameters)).SolveColumns(sums.topRows(parameters))
            : Eigen::MatrixXd(0, all);
    const Eigen::MatrixXd rest = sums - sums.leftCols(parameters) * weights;
    energy = rest(all - 1, all - 1);
    for (int d = 0; d < columns; ++d) {
      const int c = parameters + d;
      const double square = rest(c, c), cross = rest(c, all - 1);
      Score& score = scores[static_cast<std::size_t>(d)];
      const double most = LargestOf(draws_[static_cast<std::size_t>(d)]);
      score.changes = most * most * sums(c, c);
      score.not_taken_over = most * most * std::max(0.0, square);
      if (!(square > 1e-12 * sums(c, c)) || !std::isfinite(square) || !std::isfinite(cross)) continue;
      std::tie(score.explained, score.amplitude) =
          Explained(draws_[static_cast<std::size_t>(d)], square, cross);
    }
    return scores;
  }

  /// How many times a draw's effect its largest is; infinite where its range has no end.
  double LargestOf(const Eigen::VectorXd& draw) const {
    if (factor_ < 0) return 1;
    const ParameterSpec& spec = SpecOf(factor_);
    return std::max(std::abs(spec.min), std::abs(spec.max)) / std::abs(draw[factor_]);
  }

  /// Energy that a draw's effect explains, and its amplitude for it.
  std::pair<double, double> Explained(const Eigen::VectorXd& draw, double square, double cross) const {
    if (factor_ < 0) return {2 * cross - square, 1};
    const ParameterSpec& spec = SpecOf(factor_);
    const double wanted = cross / square * draw[factor_];
    const double amplitude = std::clamp(wanted, spec.min, spec.max) / draw[factor_];
    return {2 * amplitude * cross - amplitude * amplitude * square, amplitude};
  }

  const StateFit& near_;
  const StateModel& with_;
  std::span<const Episode> episodes_;
  const ScreeningOptions& options_;
  Eigen::VectorXd first_;
  std::vector<int> new_;
  int factor_ = -1;  ///< parameter which the effect is proportional to
  std::vector<Eigen::VectorXd> draws_;
};

}  // namespace

ScreenedEffect ScreenEffect(const StateFit& near, const StateModel& with, std::span<const Episode> episodes,
                            const ScreeningOptions& options) {
  return EffectScreen(near, with, episodes, options).Run();
}

}  // namespace hydroscope
