#include "diagnosis/states/other_causes/reversed_signal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "estimation/linear_form/starts.h"
#include "estimation/states/growing.h"
#include "models/expressions/syntax.h"

namespace hydroscope {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::string Canonical(const std::string& text) {
  const auto tree = ParseExpression(text);
  return tree ? CanonicalText(**tree) : text;
}

/// A weight of one window that is 0 at both ends with its first two rates, and its derivative by a window's length.
struct Weights {
  Eigen::VectorXd weight, derivative;

  Weights(int rows, int order) : weight(rows), derivative(rows) {
    for (int k = 0; k < rows; ++k) {
      const double s = (k + 0.5) / rows, q = s * (1 - s);
      weight[k] = q * q * q;
      derivative[k] = order == 1 ? -3 * q * q * (1 - 2 * s) : 6 * q * (1 - 5 * q);
    }
  }
};

/// Correlation of what two tied signals say of windows of so many rows side by side; 0 of too few windows.
double Together(const TiedSignals& tied, std::span<const Episode> episodes, int window, int least_windows) {
  const Weights weights(window, tied.order);
  double count = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  for (const Episode& e : episodes)
    for (int first = 0; first + window <= e.rows(); first += window) {
      const auto of = e.signal.col(tied.of).segment(first, window);
      const double a = weights.weight.dot(e.signal.col(tied.rate).segment(first, window)),
                   b = weights.derivative.dot(of) - of.mean() * weights.derivative.sum();
      if (!std::isfinite(a) || !std::isfinite(b)) continue;
      count += 1, x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
    }
  const double spread = (xx - x * x / count) * (yy - y * y / count);
  return count >= least_windows && spread > 0 ? (xy - x * y / count) / std::sqrt(spread) : 0;
}

Told TiedText(const TiedSignals& tied, const Machine& machine) {
  const SignalSpec &of = machine.signals[static_cast<std::size_t>(tied.of)],
                   &rate = machine.signals[static_cast<std::size_t>(tied.rate)];
  return Tell(
      "{} (column {}) has the opposite sign of the {} of {} (column {}): one of the two counts the other way round. Look which, "
      "and set scale = -1 for it in [signals] of the machine file",
      "{} (Spalte {}) hat das umgekehrte Vorzeichen der {} von {} (Spalte {}): eines der beiden zählt andersherum. Nachsehen, "
      "welches, und dafür in [signals] der Maschinendatei scale = -1 setzen",
      rate.name, rate.column,
      tied.order == 1 ? Told("derivative", "Ableitung") : Told("second derivative", "zweiten Ableitung"),
      of.name, of.column);
}

Told TiedAgainst(const StateModel& model, std::span<const Episode> episodes,
                 const ReversedSignalOptions& options) {
  int longest = 0;
  for (const Episode& e : episodes) {
    if (e.mean_rows > 1) return {};  // outputs are means: nothing of that is tied
    longest = std::max(longest, e.rows());
  }
  for (const TiedSignals& tied : TiedSignalsOf(model)) {
    double least = 0, most = 0;  // of all lengths: a signal that is late goes against fast motion alone
    for (int window = options.least_window; window <= longest; window *= 2) {
      const double together = Together(tied, episodes, window, options.least_windows);
      least = std::min(least, together);
      most = std::max(most, together);
    }
    if (least < -options.together && most < options.together) return TiedText(tied, model.machine);
  }
  return {};
}

std::vector<Episode> Reversed(std::span<const Episode> episodes, int signal) {
  std::vector<Episode> out(episodes.begin(), episodes.end());
  for (Episode& e : out) {
    e.signal.col(signal) *= -1;
    if (e.ripple.size() > 0) e.ripple.col(signal) *= -1;
  }
  return out;
}

/// Signals of the model whose readings lie on both sides of 0.
std::vector<int> SignalsToTry(const StateModel& model, std::span<const Episode> episodes,
                              const ReversedSignalOptions& options) {
  std::vector<int> signals;
  for (int s = 0; s < static_cast<int>(model.machine.signals.size()); ++s) {
    if (std::ranges::find(model.inputs, s) == model.inputs.end() &&
        std::ranges::find(model.outputs, s) == model.outputs.end())
      continue;
    double low = 0, high = 0;
    for (const Episode& e : episodes)
      for (int row = 0; row < e.rows(); ++row)
        if (const double y = e.signal(row, s); std::isfinite(y)) {
          low = std::min(low, y);
          high = std::max(high, y);
        }
    if (std::min(-low, high) > options.least_side * std::max(-low, high)) signals.push_back(s);
  }
  return signals;
}

Told ReversedText(const Machine& machine, int signal, const Told& with, const Told& as_it_is) {
  const SignalSpec& spec = machine.signals[static_cast<std::size_t>(signal)];
  return Tell(
      "{} (column {}) counts the other way round: with its sign reversed {}, as it is {}. Look at sensor and wiring, or set scale = -1 "
      "for it in [signals] of the machine file",
      "{} (Spalte {}) zählt andersherum: mit umgekehrtem Vorzeichen {}, so wie es ist {}. Sensor und Verdrahtung ansehen, oder dafür in "
      "[signals] der Maschinendatei scale = -1 setzen",
      spec.name, spec.column, with, as_it_is);
}

/// Whether a parameter of the machine is outside of its range in a linear form.
bool OutsideOfRanges(const LinearFit& fit, const Machine& machine) {
  for (std::size_t k = 0; k < fit.parameters.size(); ++k)
    for (const ParameterSpec& p : machine.states.parameters) {
      const bool reciprocal = fit.parameters[k] == "1/" + p.name;
      if (!reciprocal && fit.parameters[k] != p.name) continue;
      const double value =
          reciprocal ? 1 / fit.value[static_cast<Eigen::Index>(k)] : fit.value[static_cast<Eigen::Index>(k)];
      if (!(value >= p.min && value <= p.max)) return true;
    }
  return false;
}

Told BalancesAgainst(const StateModel& model, const LinearForm& form, std::span<const Episode> episodes,
                     const ReversedSignalOptions& options) {
  LinearFitOptions plain;
  plain.noise_pairs = 0;
  const LinearFit as_it_is = FitLinearForm(form, model.machine, episodes, plain);
  if (!as_it_is.solved() || !OutsideOfRanges(as_it_is, model.machine)) return {};
  for (const int signal : SignalsToTry(model, episodes, options)) {
    const LinearFit with = FitLinearForm(form, model.machine, Reversed(episodes, signal), plain);
    if (!with.solved()) continue;
    double best = 1, worst = 0;
    std::size_t where = 0;
    for (std::size_t e = 0; e < with.noise.size(); ++e) {
      const double share = with.noise[e] / as_it_is.noise[e];
      worst = std::max(worst, share);
      if (share >= best) continue;
      best = share;
      where = e;
    }
    if (best > options.balance || worst > options.other_balances) continue;
    return ReversedText(
        model.machine, signal,
        Tell("the balance \"{}\" leaves {:.0f} % of that", "lässt die Bilanz „{}“ {:.0f} % davon übrig",
             form.equations[where].name, 100 * best),
        Tell("parameters end outside of their ranges", "enden Parameter außerhalb ihrer Bereiche"));
  }
  return {};
}

/// From the beginning of the first episode that moves to some rows beyond; nothing if none does.
std::optional<Episode> FirstThatMoves(const StateModel& model, std::span<const Episode> episodes,
                                      const Eigen::VectorXd& white, const ReversedSignalOptions& options) {
  for (const Episode& e : episodes)
    for (int row = 0; row < e.rows(); ++row)
      for (int j = 0; j < model.output.rows; ++j)
        if (std::abs(e.signal(row, model.outputs[j]) - e.Reading(0, model.outputs[j])) >
            options.moves * white[j])
          return e.Part(0, std::min(e.rows(), row + options.rows));
  return std::nullopt;
}

/// Rms error over the white noise of the outputs, of a fit from the start of the machine file and from so many drawn ones.
double ErrorOfRows(const std::shared_ptr<const StateModel>& model, const Episode& rows,
                   const Eigen::VectorXd& white, int starts) {
  StateFitOptions options;
  options.starts = starts;
  options.iterations = 15;
  options.tolerance = 1e-3;
  const StateFit fit = FitStates(model, std::span(&rows, 1), options);
  if (!fit.solved()) return kInfinite;
  return std::sqrt(fit.noise.cwiseQuotient(white).squaredNorm() / static_cast<double>(white.size()));
}

Told RowsAgainst(const std::shared_ptr<const StateModel>& model, std::span<const Episode> episodes,
                 const ReversedSignalOptions& options) {
  const Eigen::VectorXd white =
      WhiteNoise(*model, episodes, Eigen::VectorXd::Constant(model->output.rows, kInfinite));
  if (!(white.array() > 0).all() || !white.allFinite()) return {};
  const auto rows = FirstThatMoves(*model, episodes, white, options);
  if (!rows) return {};
  double as_it_is = ErrorOfRows(model, *rows, white, 0);
  if (as_it_is < options.astray) return {};
  for (const int signal : SignalsToTry(*model, episodes, options)) {
    const double with = ErrorOfRows(model, Reversed(std::span(&*rows, 1), signal).front(), white, 0);
    const auto tells = [&] { return with <= options.follows && with - 1 <= options.left * (as_it_is - 1); };
    if (!tells()) continue;
    // A start that leads the log as it is astray says nothing of its signs.
    as_it_is = std::min(as_it_is, ErrorOfRows(model, *rows, white, StateFitOptions().starts));
    if (as_it_is < options.astray) return {};
    if (!tells()) continue;
    return ReversedText(
        model->machine, signal,
        Tell("the model errs by {:.2g} times the noise over the first {} rows",
             "weicht das Modell über die ersten {1} Zeilen um das {0:.2g}fache des Rauschens ab", with,
             rows->rows()),
        std::isfinite(as_it_is) ? Tell("by {:.2g} times", "um das {:.2g}fache", as_it_is)
                                : Told("it diverges", "divergiert es"));
  }
  return {};
}

}  // namespace

std::vector<TiedSignals> TiedSignalsOf(const StateModel& model) {
  std::vector<TiedSignals> tied;
  const StatesSpec& spec = model.machine.states;
  for (std::size_t j = 0; j < spec.outputs.size(); ++j) {
    const std::string output = Canonical(spec.outputs[j].expression);
    const auto is_rate_of = [&](int state) {
      return output == Canonical(spec.states[static_cast<std::size_t>(state)].ddt);
    };
    for (int x = 0; x < model.states(); ++x) {
      const int measured = model.measured_by[x], rate = model.rate_of[x];
      if (measured < 0 || measured == static_cast<int>(j)) continue;
      const int order = is_rate_of(x) ? 1 : rate >= 0 && is_rate_of(rate) ? 2 : 0;
      if (order > 0) tied.push_back({model.outputs[measured], model.outputs[j], order});
    }
  }
  return tied;
}

Told ReversedSignalIn(const Machine& machine, std::span<const Episode> episodes,
                      const ReversedSignalOptions& options) {
  const auto model = BuildStateModel(machine, machine.added_effects);
  if (!model) return {};
  if (Told text = TiedAgainst(**model, episodes, options); !text.empty()) return text;
  const LinearForm form = LinearFormOf(machine);
  return form.equations.empty() ? RowsAgainst(*model, episodes, options)
                                : BalancesAgainst(**model, form, episodes, options);
}

}  // namespace hydroscope
