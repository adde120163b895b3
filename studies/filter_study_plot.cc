#include "studies/filter_study_plot.h"

#include <fmt/format.h>

#include <fstream>

#include "core/cannot_write.h"
#include "report/svg_sheet.h"

namespace hydroscope {
namespace {

constexpr double kWidth = 640, kHeight = 240;

SvgPlot PlotOf(const FilterStudyResult& study, int parameter) {
  SvgPlot::Options options;
  options.width = kWidth;
  options.height = kHeight;
  options.title = fmt::format("Deviation of theta{} over the filter width", parameter + 1);
  options.x_label = parameter + 1 == kStudied ? "filter width M (samples of 2 ms)" : "";
  options.y_label = fmt::format("θ_{{{}}} (% of truth)", parameter + 1);
  options.whole_x = true;
  SvgPlot plot(options);
  std::vector<double> bias, low, high;
  for (std::size_t k = 0; k < study.width.size(); ++k) {
    const BiasAndStd& r = study.published[k];
    bias.push_back(r.bias[parameter]);
    low.push_back(r.bias[parameter] - r.std[parameter]);
    high.push_back(r.bias[parameter] + r.std[parameter]);
  }
  const double ours = study.recursive.bias[parameter], spread = study.recursive.std[parameter];
  const std::vector<double> ends = {study.width.front(), study.width.back()};
  plot.Band(ends, {ours - spread, ours - spread}, {ours + spread, ours + spread}, Ink::kGreen,
            "ours, bias ± std");
  plot.ErrorBars(study.width, low, high, Ink::kVermillion);
  plot.Line(study.width, bias, {Ink::kVermillion, Dash::kSolid, 1.6}, "as published, bias ± std");
  plot.Points(study.width, bias, {Ink::kVermillion, Marker::kCircle, 2.6, false}, "");
  plot.Level(0, {Ink::kNeutral, Dash::kDashed, 1}, "truth");
  return plot;
}

}  // namespace

Status WriteFilterStudyPlot(const FilterStudyResult& study, const std::string& path) {
  std::vector<SvgPlot> plots;
  for (int i = 0; i < kStudied; ++i) plots.push_back(PlotOf(study, i));
  std::ofstream file(path);
  file << SvgSheet("", "", plots);
  file.flush();
  if (!file) return CannotWrite(path);
  return {};
}

}  // namespace hydroscope
