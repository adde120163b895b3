#include "report/svg_render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "report/svg_heat.h"
#include "report/svg_marks.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

constexpr double kTextHeight = 17, kTopGap = 8, kRightMargin = 14, kScaleWidth = 86;
constexpr std::size_t kMostTitledPoints = 400;

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void Add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void Add(const std::vector<double>& values) {
    for (const double value : values) Add(value);
  }
  bool Empty() const { return low > high; }
};

template <typename... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <typename... F>
Overloaded(F...) -> Overloaded<F...>;

class Renderer {
 public:
  Renderer(const SvgPlot::Options& options, const std::vector<SvgPlot::Layer>& layers)
      : options_(options), layers_(layers) {
    FindRanges();
    LayOut();
  }

  std::string Draw() {
    Begin();
    Grid();
    OpenClip();
    for (const SvgPlot::Layer& layer : layers_) std::visit([this](const auto& l) { DrawLayer(l); }, layer);
    svg_ += "</svg>";
    if (heat_ != nullptr) svg_ += HeatScale(*heat_, right_ + 18, top_, bottom_, options_.width);
    Frame();
    for (const SvgPlot::Layer& layer : layers_)
      if (const auto* level = std::get_if<SvgPlot::LevelLayer>(&layer)) LevelNote(*level);
    if (empty_) Text((left_ + right_) / 2, (top_ + bottom_) / 2, "middle", "p-empty", "no data");
    Legend();
    return svg_ + "</svg>\n";
  }

 private:
  void FindRanges() {
    Extent x, y;
    for (const SvgPlot::Layer& layer : layers_) {
      std::visit(Overloaded{[&](const SvgPlot::BandLayer& l) { x.Add(l.x), y.Add(l.low), y.Add(l.high); },
                            [&](const SvgPlot::LineLayer& l) { x.Add(l.x), y.Add(l.y); },
                            [&](const SvgPlot::PointLayer& l) { x.Add(l.x), y.Add(l.y); },
                            [&](const SvgPlot::ErrorLayer& l) { x.Add(l.x), y.Add(l.low), y.Add(l.high); },
                            [&](const SvgPlot::HeatLayer& l) { x.Add(l.x), y.Add(l.y), heat_ = &l; },
                            [](const auto&) {}},
                 layer);
    }
    empty_ = x.Empty() || y.Empty();
    if (options_.y_range) y = {options_.y_range->low, options_.y_range->high};
    data_centre_ = y.Empty() ? 0 : (y.low + y.high) / 2;
    AdmitLevels(y);
    const double margin = heat_ != nullptr ? 0 : 0.06;
    if (options_.log_x && !(x.low > 0)) x.low = x.Empty() || !(x.high > 0) ? 1 : x.high / 10;
    x_ = options_.x_range.value_or(RangeOfX(x, margin / 2));
    y_ = y.Empty() ? AxisRange{0, 1} : PaddedRange(y.low, y.high, margin);
    MakeRoomForNotes();
  }

  AxisRange RangeOfX(const Extent& x, double margin) const {
    if (x.Empty()) return options_.log_x ? AxisRange{1, 10} : AxisRange{0, 1};
    if (!options_.log_x) return PaddedRange(x.low, x.high, margin);
    const AxisRange exponents = PaddedRange(std::log10(x.low), std::log10(x.high), margin);
    return {std::pow(10.0, exponents.low), std::pow(10.0, exponents.high)};
  }

  /// Levels widen the range, the nearest first, as long as the data keep two fifths of it.
  void AdmitLevels(Extent& y) const {
    if (y.Empty()) return;
    const AxisRange data = PaddedRange(y.low, y.high, 0);
    std::vector<double> levels;
    for (const SvgPlot::Layer& layer : layers_)
      if (const auto* level = std::get_if<SvgPlot::LevelLayer>(&layer); level && std::isfinite(level->y))
        levels.push_back(level->y);
    const double centre = (data.low + data.high) / 2;
    std::ranges::sort(levels,
                      [&](double a, double b) { return std::abs(a - centre) < std::abs(b - centre); });
    for (const double level : levels) {
      Extent wider = y;
      wider.Add(level);
      if (wider.high - wider.low <= 2.5 * (data.high - data.low)) y = wider;
    }
  }

  /// A tenth more at the edge where levels beyond the range are named, so that the names cross no line.
  void MakeRoomForNotes() {
    bool below = false, above = false;
    for (const SvgPlot::Layer& layer : layers_) {
      const auto* level = std::get_if<SvgPlot::LevelLayer>(&layer);
      if (level == nullptr || level->label.empty() || !std::isfinite(level->y)) continue;
      below |= level->y < y_.low;
      above |= level->y > y_.high;
    }
    const double room = 0.1 * (y_.high - y_.low);
    if (below) y_.low -= room;
    if (above) y_.high += room;
  }

  void LayOut() {
    for (const SvgPlot::Layer& layer : layers_)
      std::visit(
          Overloaded{[&](const SvgPlot::BandLayer& l) { AddEntry(layer, l.label); },
                     [&](const SvgPlot::LineLayer& l) { AddEntry(layer, l.label); },
                     [&](const SvgPlot::PointLayer& l) { AddEntry(layer, l.label); }, [](const auto&) {}},
          layer);
    left_ = options_.left_margin;
    right_ = options_.width - kRightMargin - (heat_ != nullptr ? kScaleWidth : 0);
    PlaceEntries();
    top_ = kTextHeight * (1 + legend_rows_) + kTopGap;
    bottom_ =
        options_.height - (options_.x_tick_labels ? 22 : 8) - (options_.x_label.empty() ? 0 : kTextHeight);
    bottom_ = std::max(bottom_, top_ + 20);
    y_ticks_ = NiceTicks(y_.low, y_.high, std::clamp(static_cast<int>((bottom_ - top_) / 32), 3, 8));
    x_ticks_ = options_.log_x
                   ? DecadeTicks(x_.low, x_.high)
                   : NiceTicks(x_.low, x_.high, std::clamp(static_cast<int>((right_ - left_) / 78), 2, 12),
                               options_.whole_x);
  }

  struct Entry {
    const SvgPlot::Layer* layer;
    std::string label;
    double x = 0;
    int row = 0;
  };
  void AddEntry(const SvgPlot::Layer& layer, const std::string& label) {
    if (!label.empty()) entries_.push_back({&layer, label});
  }

  /// Entries stand on the line of the y label if they fit there, else on rows of their own.
  void PlaceEntries() {
    const auto width = [](const Entry& e) { return 34 + TextWidth(e.label); };
    const double total = std::accumulate(entries_.begin(), entries_.end(), 0.0,
                                         [&](double sum, const Entry& e) { return sum + width(e); });
    if (entries_.empty()) return;
    if (TextWidth(YLabel()) + 24 + total <= options_.width - 8) {
      double x = options_.width - 8 - total;
      for (Entry& entry : entries_) entry.x = x, x += width(entry);
      return;
    }
    legend_rows_ = 1;
    double x = 4;
    for (Entry& entry : entries_) {
      if (x > 4 && x + width(entry) > options_.width) x = 4, ++legend_rows_;
      entry.x = x;
      entry.row = legend_rows_;
      x += width(entry);
    }
  }

  std::string YLabel() const { return options_.y_label + ExponentNote(y_.low, y_.high, false); }
  static std::string ExponentNote(double low, double high, bool whole) {
    const int exponent = NiceTicks(low, high, 5, whole).exponent;
    return exponent == 0 ? "" : " × " + PowerOfTen(exponent);
  }

  /// NaN, which leaves a point out, where a logarithmic axis has no place for the value.
  double X(double value) const {
    const double share = options_.log_x ? std::log(value / x_.low) / std::log(x_.high / x_.low)
                                        : (value - x_.low) / (x_.high - x_.low);
    return left_ + share * (right_ - left_);
  }
  double Y(double value) const { return bottom_ - (value - y_.low) / (y_.high - y_.low) * (bottom_ - top_); }
  /// Far outside points are clamped just beyond the frame: browsers dislike huge coordinates.
  double ClampedY(double value) const { return std::clamp(Y(value), top_ - 400, bottom_ + 400); }

  void Begin() {
    svg_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"p-plot\" viewBox=\"0 0 {} {}\" role=\"img\" "
        "aria-label=\"{}\">",
        Px(options_.width), Px(options_.height), EscapeText(PlainSymbol(options_.title)));
    if (!options_.title.empty()) svg_ += "<title>" + EscapeText(PlainSymbol(options_.title)) + "</title>";
    Text(4, 13, "start", "p-label", YLabel());
  }

  void Text(double x, double y, const char* anchor, const std::string& classes, const std::string& text) {
    svg_ += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" class=\"{}\">{}</text>", Px(x), Px(y),
                        anchor, classes, SvgSymbol(text));
  }

  /// A nested <svg> clips what lies outside the axes and needs no identifier.
  void OpenClip() {
    svg_ += fmt::format("<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">",
                        Px(left_), Px(top_), Px(right_ - left_), Px(bottom_ - top_));
  }

  void Grid() {
    std::string path;
    for (const double tick : y_ticks_.values)
      path += fmt::format("M{} {}H{}", Px(left_), Px(Y(tick)), Px(right_));
    if (options_.log_x)
      for (const double tick : x_ticks_.values)
        path += fmt::format("M{} {}V{}", Px(X(tick)), Px(top_), Px(bottom_));
    if (!path.empty()) svg_ += fmt::format("<path class=\"p-grid\" d=\"{}\"/>", path);
  }

  void Frame() {
    std::string path = fmt::format("M{} {}V{}H{}", Px(left_), Px(top_), Px(bottom_), Px(right_));
    for (const double tick : x_ticks_.values) path += fmt::format("M{} {}v4", Px(X(tick)), Px(bottom_));
    svg_ += fmt::format("<path class=\"p-frame\" d=\"{}\"/>", path);
    for (std::size_t i = 0; i < y_ticks_.values.size(); ++i)
      Text(left_ - 6, Y(y_ticks_.values[i]) + 4, "end", "p-tick", y_ticks_.labels[i]);
    if (options_.x_tick_labels)
      for (std::size_t i = 0; i < x_ticks_.values.size(); ++i)
        Text(X(x_ticks_.values[i]), bottom_ + 17, "middle", "p-tick", x_ticks_.labels[i]);
    if (!options_.x_label.empty())
      Text((left_ + right_) / 2, options_.height - 5, "middle", "p-label",
           options_.x_label + (options_.log_x ? "" : ExponentNote(x_.low, x_.high, options_.whole_x)));
  }

  std::size_t Columns() const { return static_cast<std::size_t>((right_ - left_) / 1.5); }

  std::string Polyline(const std::vector<double>& x, const std::vector<double>& y,
                       const std::vector<std::size_t>& kept) const {
    std::string path;
    bool pen_down = false;
    for (const std::size_t i : kept) {
      const bool usable = i < x.size() && std::isfinite(X(x[i])) && std::isfinite(y[i]);
      if (usable) path += fmt::format("{}{} {}", pen_down ? 'L' : 'M', Px(X(x[i])), Px(ClampedY(y[i])));
      pen_down = usable;
    }
    return path;
  }

  void DrawLayer(const SvgPlot::LineLayer& layer) {
    const std::string path = Polyline(layer.x, layer.y, DecimateMinMax(layer.y, Columns()));
    if (!path.empty())
      svg_ +=
          fmt::format("<path class=\"p-line {}\" stroke-width=\"{}\"{} d=\"{}\"/>", InkClass(layer.style.ink),
                      Px(layer.style.width), DashAttribute(layer.style.dash), path);
  }

  void DrawLayer(const SvgPlot::BandLayer& layer) {
    std::string path;
    std::vector<std::size_t> part;
    const auto flush = [&] {
      if (part.size() > 1) {
        for (std::size_t k = 0; k < part.size(); ++k)
          path += fmt::format("{}{} {}", k == 0 ? 'M' : 'L', Px(X(layer.x[part[k]])),
                              Px(ClampedY(layer.high[part[k]])));
        for (std::size_t k = part.size(); k-- > 0;)
          path += fmt::format("L{} {}", Px(X(layer.x[part[k]])), Px(ClampedY(layer.low[part[k]])));
        path += 'Z';
      }
      part.clear();
    };
    std::vector<std::size_t> kept = DecimateMinMax(layer.low, Columns() / 2);
    const std::vector<std::size_t> kept_high = DecimateMinMax(layer.high, Columns() / 2);
    kept.insert(kept.end(), kept_high.begin(), kept_high.end());
    std::ranges::sort(kept);
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    for (const std::size_t i : kept) {
      if (std::isfinite(X(layer.x[i])) && std::isfinite(layer.low[i]) && std::isfinite(layer.high[i]))
        part.push_back(i);
      else
        flush();
    }
    flush();
    if (!path.empty()) svg_ += fmt::format("<path class=\"p-fill {}\" d=\"{}\"/>", InkClass(layer.ink), path);
  }

  /// Points of a scatter sorted along x, thinned.
  std::vector<std::size_t> KeptPoints(const SvgPlot::PointLayer& layer) const {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < layer.y.size(); ++i)
      if (std::isfinite(X(layer.x[i])) && std::isfinite(layer.y[i])) order.push_back(i);
    std::ranges::stable_sort(order, [&](auto a, auto b) { return layer.x[a] < layer.x[b]; });
    std::vector<double> sorted;
    for (const std::size_t i : order) sorted.push_back(layer.y[i]);
    std::vector<std::size_t> kept;
    for (const std::size_t k : DecimateMinMax(sorted, Columns() / 2)) kept.push_back(order[k]);
    return kept;
  }

  void DrawLayer(const SvgPlot::PointLayer& layer) {
    const std::vector<std::size_t> kept = KeptPoints(layer);
    const bool titled = !layer.titles.empty() && kept.size() <= kMostTitledPoints;
    if (kept.empty()) return;
    std::string path;
    svg_ += fmt::format("<g class=\"{}\">", PointClass(layer.style));
    for (const std::size_t i : kept) {
      const std::string mark =
          MarkerPath(layer.style.marker, X(layer.x[i]), ClampedY(layer.y[i]), layer.style.radius);
      if (titled)
        svg_ += fmt::format("<path d=\"{}\"><title>{}</title></path>", mark, EscapeText(layer.titles[i]));
      else
        path += mark;
    }
    svg_ += titled ? "</g>" : fmt::format("<path d=\"{}\"/></g>", path);
  }

  void DrawLayer(const SvgPlot::ErrorLayer& layer) {
    std::string path;
    for (const std::size_t i : DecimateMinMax(layer.high, Columns() / 2))
      if (std::isfinite(X(layer.x[i])) && std::isfinite(layer.low[i]) && std::isfinite(layer.high[i]))
        path += fmt::format("M{} {}V{}", Px(X(layer.x[i])), Px(ClampedY(layer.low[i])),
                            Px(ClampedY(layer.high[i])));
    if (!path.empty())
      svg_ += fmt::format("<path class=\"p-line {}\" stroke-width=\"1\" stroke-opacity=\".55\" d=\"{}\"/>",
                          InkClass(layer.ink), path);
  }

  void DrawLayer(const SvgPlot::LevelLayer& layer) {
    if (!std::isfinite(layer.y) || layer.y < y_.low || layer.y > y_.high) return;
    svg_ += fmt::format("<path class=\"p-line {}\" stroke-width=\"{}\"{} d=\"M{} {}H{}\"/>",
                        InkClass(layer.style.ink), Px(layer.style.width), DashAttribute(layer.style.dash),
                        Px(left_), Px(Y(layer.y)), Px(right_));
  }

  /// The level's name at the right end, on the side of its line away from the data; a level out of range is
  /// named at the left of the edge it lies beyond, several side by side.
  void LevelNote(const SvgPlot::LevelLayer& layer) {
    if (!std::isfinite(layer.y) || layer.label.empty()) return;
    const std::string classes = fmt::format("p-note {}", InkClass(layer.style.ink));
    if (layer.y > y_.high || layer.y < y_.low) {
      const bool above = layer.y > y_.high;
      double& used = above ? used_top_ : used_bottom_;
      const std::string note = layer.label + (above ? " ↑" : " ↓");
      Text(left_ + 6 + used, above ? top_ + 11 : bottom_ - 5, "start", classes, note);
      used += TextWidth(note) + 10;
      return;
    }
    const double y = Y(layer.y);
    const bool above = layer.y >= data_centre_ ? y - 4 >= top_ + 8 : y + 14 > bottom_;
    Text(right_ - 4, above ? y - 4 : y + 12, "end", classes, layer.label);
  }

  void DrawLayer(const SvgPlot::BorderLayer& layer) {
    std::string path;
    for (const double x : layer.x)
      if (x > x_.low && x < x_.high) path += fmt::format("M{} {}V{}", Px(X(x)), Px(top_), Px(bottom_));
    if (!path.empty()) svg_ += fmt::format("<path class=\"p-border\" d=\"{}\"/>", path);
  }

  void DrawLayer(const SvgPlot::HeatLayer& layer) { svg_ += HeatCells(layer); }

  std::string HeatCells(const SvgPlot::HeatLayer& layer) const {
    if (layer.x.size() < 2 || layer.y.size() < 2) return "";
    const AxisRange range = HeatRange(layer);
    const std::size_t columns = layer.x.size() - 1;
    std::string cells;
    for (std::size_t i = 0; i < layer.values.size() && i / columns + 1 < layer.y.size(); ++i) {
      const std::size_t row = i / columns, column = i % columns;
      const double x0 = X(layer.x[column]), x1 = X(layer.x[column + 1]), y0 = Y(layer.y[row + 1]),
                   y1 = Y(layer.y[row]);
      const bool blank = !std::isfinite(layer.values[i]);
      const std::string fill =
          blank ? "class=\"p-blank\""
                : fmt::format(
                      "fill=\"{}\"",
                      HeatColour((layer.values[i] - range.low) / (range.high - range.low), layer.diverging));
      cells +=
          fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {}><title>{}: {}</title></rect>",
                      Px(x0), Px(y0), Px(x1 - x0 + 0.3), Px(y1 - y0 + 0.3), fill,
                      EscapeText(PlainSymbol(layer.label)), blank ? "no data" : FormatShort(layer.values[i]));
    }
    return cells;
  }

  void Legend() {
    for (const Entry& entry : entries_) {
      const double y = 9 + kTextHeight * entry.row;
      svg_ +=
          "<g>" +
          std::visit(Overloaded{[&](const SvgPlot::BandLayer& l) {
                                  return fmt::format("<path class=\"p-fill {}\" d=\"M{} {}h20v10h-20z\"/>",
                                                     InkClass(l.ink), Px(entry.x), Px(y - 5));
                                },
                                [&](const SvgPlot::LineLayer& l) {
                                  return fmt::format(
                                      "<path class=\"p-line {}\" stroke-width=\"{}\"{} d=\"M{} {}h20\"/>",
                                      InkClass(l.style.ink), Px(l.style.width + 0.3),
                                      DashAttribute(l.style.dash), Px(entry.x), Px(y));
                                },
                                [&](const SvgPlot::PointLayer& l) {
                                  return fmt::format(
                                      "<path class=\"{}\" d=\"{}\"/>", PointClass(l.style),
                                      MarkerPath(l.style.marker, entry.x + 11, y, l.style.radius));
                                },
                                [](const auto&) { return std::string(); }},
                     *entry.layer) +
          "</g>";
      Text(entry.x + 25, y + 4, "start", "p-tick", entry.label);
    }
  }

  const SvgPlot::Options& options_;
  const std::vector<SvgPlot::Layer>& layers_;
  const SvgPlot::HeatLayer* heat_ = nullptr;
  std::vector<Entry> entries_;
  AxisRange x_, y_;
  AxisTicks x_ticks_, y_ticks_;
  double left_ = 0, right_ = 0, top_ = 0, bottom_ = 0, used_top_ = 0, used_bottom_ = 0, data_centre_ = 0;
  int legend_rows_ = 0;
  bool empty_ = false;
  std::string svg_;
};

}  // namespace

std::string RenderPlot(const SvgPlot::Options& options, const std::vector<SvgPlot::Layer>& layers) {
  return Renderer(options, layers).Draw();
}

}  // namespace hydroscope
