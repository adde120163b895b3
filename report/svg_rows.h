#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/svg_plot.h"

namespace hydroscope {

/// One row: a name on the left, a bar or a point with its interval, a remark on the right.
struct PlotRow {
  std::string label;
  double value = 0;
  double low = 0, high = 0;  ///< interval; the same as `value` for none
  std::string note;
  Ink ink = Ink::kBlue;
  bool bold = false;  ///< the label
};

/// Rows above each other over one axis, as an SVG element of PlotStyleSheet(), e.g. a ranking or a staircase.
struct RowPlot {
  std::string title;    ///< accessible name
  std::string x_label;  ///< with unit
  bool bars = false;    ///< bars from 0, else points
  std::vector<PlotRow> rows;
  std::optional<double> level;  ///< an upright line across all rows
  std::string level_label;
  double width = 860;  ///< px
  double label_width = 190, note_width = 240;
};
std::string RenderRows(const RowPlot& plot);

}  // namespace hydroscope
