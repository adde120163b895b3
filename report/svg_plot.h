#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace hydroscope {

/// Tick positions of one axis with their labels.
struct AxisTicks {
  std::vector<double> values;
  std::vector<std::string> labels;
  int exponent = 0;  ///< labels show value / 10^exponent; 0 for most axes
};

/// Ticks at 1, 2, 2.5 or 5 times a power of ten inside [low, high] (low < high, finite), about `target` of
/// them, labels with equal decimals. `whole` keeps the step at 1 or more (stroke numbers). Values beyond five
/// digits or below 1e-3 steps share a power of ten, a multiple of 3.
AxisTicks NiceTicks(double low, double high, int target, bool whole = false);

/// Ticks of a logarithmic axis from `low` to `high` (0 < low < high): 1 to 9 times each power of ten, with labels at 1, 2 and 5,
/// over less than a decade and a half at nearly all of them.
AxisTicks DecadeTicks(double low, double high);

/// "10⁻⁶" for -6.
std::string PowerOfTen(int exponent);

/// A range that holds [low, high] with a margin of `share` on both sides; a single value gets a range around it.
struct AxisRange {
  double low = 0, high = 1;
};
AxisRange PaddedRange(double low, double high, double share);

/// Indices of the points that a plot of `buckets` columns needs to look the same: first, least, greatest and
/// last of every bucket of equal count, in order. Non-finite values are dropped where a bucket holds others;
/// a bucket without any keeps one, so that the gap stays. All indices if there are no more than 4 * buckets.
std::vector<std::size_t> DecimateMinMax(const std::vector<double>& y, std::size_t buckets);

/// Colours of Okabe and Ito (2008), told apart by colour-blind readers; the style sheet darkens or lightens
/// them with the theme. Never the only mark of a difference: lines differ in dash, points in shape as well.
enum class Ink { kBlue, kVermillion, kGreen, kOrange, kPurple, kSky, kNeutral };
enum class Dash { kSolid, kDashed, kDotted, kDashDot };
enum class Marker { kCircle, kSquare, kTriangle, kDiamond, kCross };

struct LineStyle {
  Ink ink = Ink::kBlue;
  Dash dash = Dash::kSolid;
  double width = 1.6;  ///< px
};

struct PointStyle {
  Ink ink = Ink::kBlue;
  Marker marker = Marker::kCircle;
  double radius = 2.6;  ///< px
  bool hollow = false;
};

/// One plot as an SVG element. Texts may hold anything, they are escaped; "_{...}" in labels is a subscript.
/// All layers are in data coordinates of one pair of axes and are drawn in the order of the calls.
/// Non-finite values interrupt lines and bands and leave out points. Long series are thinned so that the
/// picture stays the same (first, least, greatest and last of every column), so the size of the result is
/// bounded whatever the length. Colours, fonts and the theme come from PlotStyleSheet(), which the page
/// includes once.
class SvgPlot {
 public:
  struct Options {
    double width = 560, height = 230;  ///< px of the view box; the page scales it to its column
    std::string title;                 ///< accessible name, also shown while the pointer rests on the plot
    std::string x_label, y_label;      ///< with unit: "oil temperature (°C)"
    bool whole_x = false;              ///< the x axis counts (stroke numbers)
    bool log_x = false;                ///< the x axis is logarithmic; what is not above 0 is left out
    bool x_tick_labels = true;
    std::optional<AxisRange> x_range;  ///< instead of the range of the data
    /// The same; a margin is added and levels may widen it; the rest is clipped.
    std::optional<AxisRange> y_range;
    double left_margin = 58;  ///< px; the same for plots that stand above each other
  };

  explicit SvgPlot(Options options);

  /// x ascending; `low` and `high` as long as x. An empty label keeps a layer out of the legend.
  void Band(std::vector<double> x, std::vector<double> low, std::vector<double> high, Ink ink,
            std::string label);
  void Line(std::vector<double> x, std::vector<double> y, LineStyle style, std::string label);
  /// `titles` (one per point or none) appear while the pointer rests on a point.
  void Points(std::vector<double> x, std::vector<double> y, PointStyle style, std::string label,
              std::vector<std::string> titles = {});
  void ErrorBars(std::vector<double> x, std::vector<double> low, std::vector<double> high, Ink ink);
  /// A line across with its label at the right end. It widens the y range at most to 2.5 times that of the
  /// data; a level beyond is named at the edge with an arrow instead.
  void Level(double y, LineStyle style, std::string label);
  /// Thin lines from bottom to top (borders between runs).
  void Borders(std::vector<double> x);
  /// `values` row by row from the lowest y; edges one longer than cells, ascending. `diverging` centres the
  /// colours at 0. Empty cells (NaN) stay blank. The colour scale stands on the right, named `value_label`.
  void HeatMap(std::vector<double> x_edges, std::vector<double> y_edges, std::vector<double> values,
               bool diverging, std::string value_label);

  /// The <svg> element: well-formed XML, no identifiers, so any number fit into one page. Without finite data
  /// it shows empty axes and "no data".
  std::string Render() const;
  const Options& options() const { return options_; }

  struct BandLayer {
    std::vector<double> x, low, high;
    Ink ink;
    std::string label;
  };
  struct LineLayer {
    std::vector<double> x, y;
    LineStyle style;
    std::string label;
  };
  struct PointLayer {
    std::vector<double> x, y;
    PointStyle style;
    std::string label;
    std::vector<std::string> titles;
  };
  struct ErrorLayer {
    std::vector<double> x, low, high;
    Ink ink;
  };
  struct LevelLayer {
    double y;
    LineStyle style;
    std::string label;
  };
  struct BorderLayer {
    std::vector<double> x;
  };
  struct HeatLayer {
    std::vector<double> x, y, values;
    bool diverging;
    std::string label;
  };
  using Layer =
      std::variant<BandLayer, LineLayer, PointLayer, ErrorLayer, LevelLayer, BorderLayer, HeatLayer>;

 private:
  Options options_;
  std::vector<Layer> layers_;
};

/// CSS of the plots for light and dark theme and print: class names start with "p-". Expects the page to set
/// data-theme="dark" or "light" on the root element if the reader chose one.
std::string PlotStyleSheet();

}  // namespace hydroscope
