#include "pipeline/shaft_ripple.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace hydroscope {
namespace {

using Complex = std::complex<double>;

constexpr int kOrders = ShaftRipple::kOrders;
constexpr int kSlowOrders = 3;       // where steps of the signal itself show
constexpr int kFewRevolutions = 20;  // that a shape is not taken from
constexpr double kLargestSize = 4;   // of the usual
constexpr double kTurn = 2 * std::numbers::pi;

/// Mean and orders 1 ... kOrders of one revolution.
struct Revolution {
  double mean = 0;
  std::array<Complex, kOrders> order{};
};

/// Part of the line between two readings that lies within one revolution.
struct Part {
  std::size_t revolution;
  double from, to;    ///< turns
  double begin, end;  ///< readings
};

std::vector<Part> PartsOf(const std::vector<double>& turns, const std::vector<double>& y) {
  const auto revolutions = static_cast<std::size_t>(turns.back());
  std::vector<Part> parts;
  for (std::size_t row = 0; row + 1 < turns.size(); ++row) {
    const double rise = (y[row + 1] - y[row]) / (turns[row + 1] - turns[row]);
    for (double from = turns[row]; from < turns[row + 1];) {
      const auto at = static_cast<std::size_t>(from);
      if (at >= revolutions) return parts;
      const double to = std::min(turns[row + 1], static_cast<double>(at + 1));
      parts.push_back({at, from, to, y[row] + (from - turns[row]) * rise, y[row] + (to - turns[row]) * rise});
      from = to;
    }
  }
  return parts;
}

/// By the trapezoidal rule over the angle. Orders are of what a reading is beyond the mean: revolutions do not begin at rows, and
/// what the rule errs by at their ends goes with what it is applied to, be it a ripple of half a bar or a mean of 200.
std::vector<Revolution> RevolutionsOf(const std::vector<double>& turns, const std::vector<double>& y) {
  std::vector<Revolution> out(static_cast<std::size_t>(turns.back()));
  const std::vector<Part> parts = PartsOf(turns, y);
  for (const Part& p : parts) out[p.revolution].mean += 0.5 * (p.to - p.from) * (p.begin + p.end);
  for (const Part& p : parts) {
    Revolution& revolution = out[p.revolution];
    const Complex from = std::polar(1.0, -kTurn * p.from), to = std::polar(1.0, -kTurn * p.to);
    Complex begin = 0.5 * (p.to - p.from) * (p.begin - revolution.mean),
            end = 0.5 * (p.to - p.from) * (p.end - revolution.mean);
    for (Complex& order : revolution.order) order += (begin *= from) + (end *= to);
  }
  return out;
}

/// Takes out a signal that moves evenly from one revolution to the next.
void TakeOutTrend(std::vector<Revolution>& revolutions) {
  std::vector<double> slopes;
  for (std::size_t r = 0; r < revolutions.size(); ++r) {
    const std::size_t before = r > 0 ? r - 1 : r, after = std::min(r + 1, revolutions.size() - 1);
    slopes.push_back((revolutions[after].mean - revolutions[before].mean) /
                     static_cast<double>(std::max<std::size_t>(1, after - before)));
  }
  for (std::size_t r = 0; r < revolutions.size(); ++r)
    for (int k = 0; k < kOrders; ++k) revolutions[r].order[k] -= Complex(0, slopes[r] / (kTurn * (k + 1)));
}

double MedianOf(std::vector<double>& values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median of each order over revolutions of size 1.
std::array<Complex, kOrders> ShapeOf(const std::vector<Revolution>& revolutions,
                                     const std::vector<double>& size) {
  constexpr double kSmall = 0.2;  // revolutions so much smaller than the usual say little of the shape
  std::array<Complex, kOrders> shape;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    std::vector<double> real, imaginary;
    for (std::size_t r = 0; r < revolutions.size(); ++r) {
      if (size[r] < kSmall || !std::isfinite(std::abs(revolutions[r].order[k]))) continue;
      real.push_back(revolutions[r].order[k].real() / size[r]);
      imaginary.push_back(revolutions[r].order[k].imag() / size[r]);
    }
    if (!real.empty()) shape[k] = {MedianOf(real), MedianOf(imaginary)};
  }
  return shape;
}

/// Size of each revolution by its faster orders; empty if they hardly repeat.
std::vector<double> SizesOf(const std::vector<Revolution>& revolutions,
                            const std::array<Complex, kOrders>& shape) {
  constexpr double kRepeats = 4;  // energy of the shape over what scatters about it
  double energy = 0, scatter = 0;
  for (std::size_t k = kSlowOrders; k < shape.size(); ++k) energy += std::norm(shape[k]);
  if (energy == 0) return {};
  std::vector<double> sizes;
  for (const Revolution& revolution : revolutions) {
    if (!std::isfinite(std::abs(revolution.order.front()))) {  // a reading is missing
      sizes.push_back(sizes.empty() ? 1.0 : sizes.back());
      continue;
    }
    double product = 0, left = 0;
    for (std::size_t k = kSlowOrders; k < shape.size(); ++k)
      product += std::real(std::conj(shape[k]) * revolution.order[k]);
    sizes.push_back(std::clamp(product / energy, 0.0, kLargestSize));
    for (std::size_t k = kSlowOrders; k < shape.size(); ++k)
      left += std::norm(revolution.order[k] - sizes.back() * shape[k]);
    scatter += left / static_cast<double>(revolutions.size());
  }
  if (energy < kRepeats * scatter) return {};
  return sizes;
}

/// The middle one of each three: a step of the signal itself spoils the size of the revolution that it falls into, a change of
/// the ripple stays.
std::vector<double> WithoutOutliers(const std::vector<double>& sizes) {
  std::vector<double> out = sizes;
  for (std::size_t r = 1; r + 1 < sizes.size(); ++r)
    out[r] =
        std::max(std::min(sizes[r - 1], sizes[r]), std::min(std::max(sizes[r - 1], sizes[r]), sizes[r + 1]));
  return out;
}

}  // namespace

ShaftRipple::ShaftRipple(const std::vector<double>& turns, const std::vector<double>& readings) {
  constexpr int kRounds = 3;  // shape and sizes by turns: they settle at once
  if (turns.empty() || turns.back() < kFewRevolutions) return;
  std::vector<Revolution> revolutions = RevolutionsOf(turns, readings);
  TakeOutTrend(revolutions);
  sizes_.assign(revolutions.size(), 1.0);
  for (int round = 0; round < kRounds && !empty(); ++round) {
    shape_ = ShapeOf(revolutions, sizes_);
    sizes_ = WithoutOutliers(SizesOf(revolutions, shape_));
  }
  if (!empty()) sizes_ = SizesWithin(turns, readings);
}

double ShaftRipple::ShapeAt(double turn, int slowest) const {
  const Complex step = std::polar(1.0, kTurn * turn);
  Complex turned = 1, sum = 0;
  for (int k = 0; k < kOrders; ++k) {
    turned *= step;
    if (k >= slowest) sum += shape_[static_cast<std::size_t>(k)] * turned;
  }
  return 2 * sum.real();
}

/// Weighted by a bell over a revolution (Hann 1903): what moves slowly under it leaves hardly anything in the faster orders.
std::vector<double> ShaftRipple::SizesWithin(const std::vector<double>& turns,
                                             const std::vector<double>& readings) const {
  std::vector<double> shape;
  for (const double turn : turns) shape.push_back(ShapeAt(turn, kSlowOrders));
  std::vector<double> sizes;
  std::size_t first = 0;
  for (double middle = 0.5; middle <= turns.back() - 0.5; middle += 1.0 / kSizesPerTurn) {
    while (turns[first] < middle - 0.5) ++first;
    double weights = 0, mean = 0, of_shape = 0, product = 0, energy = 0;
    for (std::size_t i = first; i < turns.size() && turns[i] < middle + 0.5; ++i) {
      const double weight = 1 + std::cos(kTurn * (turns[i] - middle));
      weights += weight;
      mean += weight * readings[i];
      of_shape += weight * shape[i];
      product += weight * shape[i] * readings[i];
      energy += weight * shape[i] * shape[i];
    }
    const double size = (product - mean * of_shape / weights) / (energy - of_shape * of_shape / weights);
    sizes.push_back(std::isfinite(size) ? std::clamp(size, 0.0, kLargestSize)
                                        : (sizes.empty() ? 1.0 : sizes.back()));
  }
  return sizes;
}

double ShaftRipple::SizeAt(double turn) const {
  const double since =
      std::clamp(kSizesPerTurn * (turn - 0.5), 0.0, static_cast<double>(sizes_.size()) - 1.001);
  const auto before = static_cast<std::size_t>(since);
  const double share = since - static_cast<double>(before);
  return (1 - share) * sizes_[before] + share * sizes_[before + 1];
}

double ShaftRipple::SlowAt(double turn, int points) const {
  if (empty()) return 0;
  double sum = 0;
  for (int k = 0; k < kSlowOrders; ++k) {
    const double angle = kTurn * (k + 1), half = 0.5 * angle / points, loss = std::sin(half) / half;
    sum += (shape_[static_cast<std::size_t>(k)] * std::polar(1.0, angle * turn)).real() / (loss * loss);
  }
  return 2 * SizeAt(turn) * sum;
}

double ShaftRipple::At(double turn) const {
  if (empty()) return 0;
  return SizeAt(turn) * ShapeAt(turn, 0);
}

}  // namespace hydroscope
