#include "diagnosis/states/held_out_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/told_error.h"
#include "diagnosis/states/spread_pieces.h"
#include "models/output_unit.h"

namespace hydroscope {
namespace {

/// Of the worst output, over the noise of the fit.
double ErrorOver(const StateFit& fit, const StateFit& followed) {
  return RmsOf(followed.residuals, followed.model->output.rows).cwiseQuotient(fit.noise).maxCoeff();
}

std::pair<double, double> RangeOf(std::span<const Episode> episodes, int signal) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Episode& e : episodes)
    for (int row = 0; row < e.rows(); ++row)
      if (const double y = e.signal(row, signal); std::isfinite(y)) {
        low = std::min(low, y);
        high = std::max(high, y);
      }
  return {low, high};
}

std::vector<HeldOutRun::Beyond> BeyondFitted(const StateModel& model, std::span<const Episode> fitted,
                                             std::span<const Episode> held_out, double share) {
  std::vector<int> signals = model.inputs;
  signals.insert(signals.end(), model.outputs.begin(), model.outputs.end());
  std::vector<HeldOutRun::Beyond> out;
  for (const int s : signals) {
    const auto [low, high] = RangeOf(fitted, s);
    const auto [new_low, new_high] = RangeOf(held_out, s);
    const double margin = share * (high - low);
    if (new_low < low - margin || new_high > high + margin)
      out.push_back({model.machine.signals[static_cast<std::size_t>(s)].name, low, high, new_low, new_high});
  }
  return out;
}

/// Outputs that err by more than on the log fitted, most of it by a constant.
std::vector<HeldOutRun::Constant> Constants(const StateFit& fit, const StateFit& followed,
                                            const HeldOutRunOptions& options) {
  const StateModel& model = *followed.model;
  const Eigen::VectorXd rms = RmsOf(followed.residuals, model.output.rows);
  std::vector<HeldOutRun::Constant> out;
  for (int j = 0; j < model.output.rows; ++j) {
    if (rms[j] < options.more * fit.noise[j]) continue;
    double sum = 0, readings = 0;
    for (const RowMatrix& residuals : followed.residuals)
      for (Eigen::Index row = 0; row < residuals.rows(); ++row)
        if (const double r = residuals(row, j); std::isfinite(r)) {
          sum += r;
          ++readings;
        }
    const double mean = sum / std::max(1.0, readings), share = mean * mean / (rms[j] * rms[j]);
    if (share < options.constant_share) continue;
    const auto signal = static_cast<std::size_t>(model.outputs[static_cast<std::size_t>(j)]);
    out.push_back({model.machine.signals[signal].name, mean, share});
  }
  return out;
}

/// Whether small differences of where a run begins grow in some episode: states over their ranges, rms over `rows` rows in turn.
bool MagnifiesDifferences(const StateFit& followed, std::span<const Episode> episodes,
                          const HeldOutRunOptions& options) {
  StateSimulator simulator(followed.model);
  simulator.SetParameters(followed.parameters);
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const int last = episodes[e].rows() - 1;
    const Eigen::VectorXd begin = simulator.Initial(episodes[e], followed.initial[e]);
    StateRun as_is, moved;
    simulator.Run(episodes[e], 0, last, begin, nullptr, as_is);
    const Eigen::RowVectorXd range = as_is.states.colwise().maxCoeff() - as_is.states.colwise().minCoeff();
    simulator.Run(episodes[e], 0, last, begin + options.moved * range.transpose(), nullptr, moved);
    if (as_is.diverged || moved.diverged) return true;
    const Eigen::RowVectorXd by = range.cwiseMax(1e-300).cwiseInverse();
    const Eigen::VectorXd apart = ((moved.states - as_is.states) * by.asDiagonal()).rowwise().norm();
    const double first = apart.head(std::min<Eigen::Index>(options.rows, apart.size())).norm();
    for (Eigen::Index row = options.rows; row + options.rows <= apart.size(); row += options.rows)
      if (apart.segment(row, options.rows).norm() > options.magnified * first) return true;
  }
  return false;
}

}  // namespace

HeldOutRun LookAtHeldOut(const StateFit& fit, std::span<const Episode> fitted, const StateFit& followed,
                         std::span<const Episode> held_out, const HeldOutRunOptions& options) {
  HeldOutRun out;
  out.error = ErrorOver(fit, followed);
  if (out.error < options.more) return out;
  out.beyond = BeyondFitted(*fit.model, fitted, held_out, options.beyond);
  out.constant = Constants(fit, followed, options);
  if (!BeginsAnywhere(fit.model->machine)) return out;
  const std::vector<Episode> runs = ShortRuns(held_out, options.rows);
  if (runs.empty()) return out;
  const StateFit in_short_runs = FollowStates(fit.model, runs, fit.parameters, fit.noise);
  if (!in_short_runs.solved()) return out;
  out.short_error = ErrorOver(fit, in_short_runs);
  out.loses_its_way = out.short_error < options.as_fitted;
  out.magnifies = out.loses_its_way && MagnifiesDifferences(followed, held_out, options);
  return out;
}

std::vector<Told> HeldOutTexts(const HeldOutRun& run, const StateModel& model, const std::string& log,
                               const HeldOutRunOptions& options) {
  std::vector<Told> texts;
  if (run.magnifies)
    texts.push_back(Tell(
        "the free run over {} errs by {:.3g} times what it does on the log fitted, runs of {} rows with initial states of "
        "their own by {:.2g} times: law and parameters hold there too, but the machine magnifies small differences of "
        "both until so long a run loses its way. Judge by shorter episodes ([episodes] seconds), or fit more logs together",
        "der freie Lauf über {} weicht {:.3g}-mal so viel ab wie auf der angepassten Aufzeichnung, Stücke von {} Zeilen mit "
        "eigenen Anfangszuständen {:.2g}-mal so viel: Gesetz und Parameter gelten auch dort, doch die Maschine vergrößert "
        "kleine Unterschiede, bis ein so langer Lauf sich verliert. Nach kürzeren Episoden urteilen ([episodes] seconds) oder "
        "mehr Aufzeichnungen zusammen anpassen",
        log, run.error, options.rows, run.short_error));
  if (run.loses_its_way && !run.magnifies && run.constant.empty())
    texts.push_back(Tell(
        "the free run over {} errs by {:.3g} times what it does on the log fitted, runs of {} rows with initial states of "
        "their own by {:.2g} times: something adds up over more rows than that, small errors of the parameters, a law that is "
        "missing or acts more there, a disturbance that is not measured, or noise on the process itself. Such short runs do "
        "not tell these apart: fit both logs together and explain what is left",
        "der freie Lauf über {} weicht {:.3g}-mal so viel ab wie auf der angepassten Aufzeichnung, Stücke von {} Zeilen mit "
        "eigenen Anfangszuständen {:.2g}-mal so viel: über mehr Zeilen summiert sich etwas auf, kleine Fehler der Parameter, "
        "ein Gesetz, das fehlt oder dort stärker wirkt, eine Störung, die nicht gemessen wird, oder Rauschen des Prozesses "
        "selbst. So kurze Stücke trennen das nicht: beide Aufzeichnungen zusammen anpassen und den Rest erklären lassen",
        log, run.error, options.rows, run.short_error));
  for (const HeldOutRun::Constant& c : run.constant) {
    const DisplayUnit unit = ShownUnit(model.machine, c.signal);
    texts.push_back(Tell(
        "{:.0f} % of the error's energy of {} over {} is a constant, {:+.3g} {}: the zero of its sensor has moved between the "
        "logs, or something else that the model takes for constant; law and other parameters may hold all the same",
        "{:.0f} % der Energie des Fehlers von {} über {} sind eine Konstante, {:+.3g} {}: der Nullpunkt des Sensors hat sich "
        "zwischen den Aufzeichnungen verschoben, oder etwas anderes, was das Modell für konstant hält; Gesetz und andere "
        "Parameter können dennoch gelten",
        100 * c.share, c.signal, log, c.by * unit.factor, std::string(unit.name)));
  }
  for (const HeldOutRun::Beyond& b : run.beyond) {
    const DisplayUnit unit = ShownUnit(model.machine, b.signal);
    const auto shown = [&](double si) { return si * unit.factor + unit.offset; };
    texts.push_back(Tell(
        "{} goes from {:.4g} to {:.4g} {} in {}, beyond {:.4g} to {:.4g} {} of what was fitted: "
        "what the model says there was not seen",
        "{0} geht in {4} von {1:.4g} bis {2:.4g} {3}, über {5:.4g} bis {6:.4g} {7} der Anpassung hinaus: was das Modell "
        "dort sagt, wurde nicht gesehen",
        b.signal, shown(b.low), shown(b.high), std::string(unit.name), log, shown(b.fitted_low),
        shown(b.fitted_high), std::string(unit.name)));
  }
  return texts;
}

}  // namespace hydroscope
