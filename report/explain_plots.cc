#include "report/explain_plots.h"

#include <fmt/format.h>

#include "core/constants.h"
#include "core/contains.h"
#include "core/interval_text.h"
#include "models/output_unit.h"
#include "report/error_map_plot.h"
#include "report/svg_rows.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

/// Model error energy left with a fit, in % of `base`, with its 95 % interval over the strokes.
PlotRow ErrorLeft(const ExtendedFit& fit, double base) {
  const double percent = 100 / base, half_width = kNormal95 * percent * ExcessStd(fit);
  PlotRow row;
  row.value = percent * fit.excess.sum();
  row.low = row.value - half_width;
  row.high = row.value + half_width;
  return row;
}

/// Whether the temperature, if it is one of the map's signals, moved enough to be worth an axis.
bool TemperatureMoves(const ErrorMap& map, const ExplainResult& result) {
  const std::vector<ResidualSignal>& signals = result.signals;
  constexpr double kWorthAnAxis = 2.0;  // K
  for (std::size_t axis = 0; axis < map.signals.size(); ++axis) {
    const int channel = signals[map.signals[axis]].channel;
    if (channel < 0 || channel != result.log.model->temperature_channel) continue;
    const std::vector<double> edges = MapEdges(map, signals, axis);
    if (edges.back() - edges.front() < kWorthAnAxis) return false;
  }
  return true;
}

/// Of the pairs that explain the error about equally well, the first whose signals move.
const ErrorMap& ShownPair(const ExplainResult& result) {
  constexpr double kEqual = 0.05;
  const std::vector<ErrorMap>& pairs = result.location.pairs;
  for (const ErrorMap& pair : pairs)
    if (pair.explained > pairs.front().explained - kEqual && TemperatureMoves(pair, result)) return pair;
  return pairs.front();
}

}  // namespace

std::string StaircasePlot(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  RowPlot plot;
  plot.title = "error on strokes left out, step by step";
  const DisplayUnit unit = OutputUnit(result.log.machine);
  plot.x_label = fmt::format("error on strokes left out, rms ({})", unit.name);
  plot.bars = true;
  for (const ExplainStep& step : x.steps) {
    const double rms = step.rms_holdout * unit.factor;
    plot.rows.push_back({step.added.empty() ? "model as it is" : "+ " + step.added, rms, rms, rms,
                         fmt::format("{} {}", FormatShort(rms), unit.name),
                         step.added.empty() ? Ink::kBlue : Ink::kGreen, step.added.empty()});
  }
  plot.level = x.final.noise_floor * unit.factor;
  plot.level_label = "sensor noise alone";
  plot.note_width = 90;
  return RenderRows(plot);
}

std::string RankingPlot(const ExplainResult& result) {
  constexpr std::size_t kShown = 12;
  const Explanation& x = result.explanation;
  const double base = x.base.excess.sum();
  RowPlot plot;
  plot.title = "every effect tried alone";
  plot.x_label = "model error energy left (% of the model as it is; 95 % interval over the strokes)";
  plot.level = 100;
  plot.level_label = "model as it is";
  if (!(base > 0)) return "";
  for (const RankedEffect& ranked : x.ranking) {
    if (!ranked.fit.solved || !ranked.testable || plot.rows.size() >= kShown) continue;
    PlotRow row = ErrorLeft(ranked.fit, base);
    const EffectEstimate& size = ranked.fit.effects.back();
    const Effect& effect = result.effect(ranked.effect);
    const bool chosen = Contains(x.set, ranked.id);
    row.label = ranked.id;
    row.bold = chosen;
    // Blue is for what lowers the error beyond its scatter over the strokes: a bar that spans 100 % is not.
    const bool lowers = ranked.significant && row.high < plot.level;
    row.ink = chosen ? Ink::kGreen : lowers ? Ink::kBlue : Ink::kNeutral;
    row.note = fmt::format("{} = {}", effect.parameter, ShownWithInterval(size.size, size.std, effect.unit));
    plot.rows.push_back(std::move(row));
  }
  return plot.rows.empty() ? "" : RenderRows(plot);
}

std::string ResidualMap(const ExplainResult& result, bool diverging) {
  if (result.location.pairs.empty() || result.signals.empty()) return "";
  return ErrorMapPlot(ShownPair(result), result.signals, OutputUnit(result.log.machine), diverging);
}

std::string HistoryPlot(const Machine& machine) {
  const std::vector<ModelRecord>& history = machine.model_history;
  RowPlot plot;
  plot.title = "versions of the model";
  DisplayUnit unit = DisplayUnitFor("m3/s");
  for (const ModelRecord& record : history)
    if (record.judged()) unit = UnitOfRecord(machine, record.unit);
  plot.x_label = fmt::format("error on strokes left out, rms ({})", unit.name);
  plot.bars = true;
  plot.label_width = 250;
  for (const ModelRecord& record : history) {
    if (!record.judged()) continue;
    const double rms = record.rms_holdout * unit.factor;
    plot.rows.push_back(
        {fmt::format("{}: {}", record.version, record.name), rms, rms, rms,
         fmt::format("{} {}, {} strokes of {}", FormatShort(rms), unit.name, record.strokes, record.source),
         Ink::kBlue, false});
    plot.level = record.noise_floor * unit.factor;
  }
  plot.level_label = "sensor noise alone";
  return plot.rows.size() < 2 ? "" : RenderRows(plot);
}

}  // namespace hydroscope
