#pragma once

#include <string>

#include "models/counted_words.h"
#include "report/report.h"
#include "report/report_parameters.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {

/// SVG of one parameter over stroke number: estimates with 95 % band, limits and reference of the machine
/// file, borders between runs. Estimates that were not updated are crosses.
std::string TrendPlot(const ReportInput& input, const ParameterAnalysis& analysis, const ParameterInfo& info);

/// SVG of the same estimates over oil temperature, with regression line and its 95 % band; "" without temperatures.
std::string OilPlot(const ReportInput& input, const ParameterAnalysis& analysis, const ParameterInfo& info);

/// Two SVGs of one stroke: measured and modelled flow, and below it the residual with the band that sensor
/// noise leaves 95 % of the time.
std::string OverlayPlot(const StrokeOverlay& overlay, const CountedWords& counted = {});

/// SVG of the model error of every stroke and its noise floor.
std::string ErrorPlot(const ReportInput& input);

/// SVG of the oil temperature of every stroke; "" if it was not measured.
std::string TemperaturePlot(const ReportInput& input);

}  // namespace hydroscope
