#include "diagnosis/remainder/feature_banks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel/wide.h"
#include "core/quantile.h"
#include "diagnosis/sample_grams.h"

namespace hydroscope {
namespace {

constexpr int kKnots = 6;          ///< of the coefficient of a term, over one signal
constexpr int kRateKnots = 9;      ///< of a rate over one signal
constexpr int kPairKnots = 5;      ///< of a rate over two signals, each
constexpr int kPhaseKnots = 4;     ///< of a coefficient over the phase of the stroke
constexpr int kTrendPowers = 2;    ///< of the time within the log, and of the order of logs
constexpr int kPairedAxes = 3;     ///< signals taken two at a time
constexpr int kMostModulated = 8;  ///< terms of the balance that get coefficients over signals
constexpr double kTail = 0.01;     ///< quantile at the outer knots
constexpr std::size_t kQuantileSamples = 20000;
constexpr double kNudge = 0.01;  ///< of a channel's range, to see which columns read it

/// Place among `knots` hat functions: left knot and share of the right one.
struct Hat {
  int left = 0;
  double right = 0;
};

Hat HatAt(double place, int knots) {
  const double at = std::clamp(place, 0.0, 1.0) * (knots - 1);
  const int left = std::min(static_cast<int>(at), knots - 2);
  return {left, at - left};
}

/// The columns up to the output, in a row: which of them change when a channel of the stretch is nudged.
std::vector<bool> ColumnsThatRead(const ModelStructure& model, const Stretch& stretch, int channel) {
  const auto filled = [&](Stretch s) {
    model.derive_channels(s);
    std::vector<std::vector<double>> out;
    for (int c = 0; c <= model.output_column(); ++c) {
      double state = 0;
      out.emplace_back(s.samples);
      model.columns[c].fill(s, state, out.back());
    }
    return out;
  };
  Stretch nudged = stretch;
  auto& values = nudged.channel[channel];
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double nudge = kNudge * std::max(*high - *low, 1e-3 * std::abs(*high));
  for (std::size_t k = 0; k < values.size(); k += 2) values[k] += nudge;
  const auto before = filled(stretch), after = filled(nudged);
  std::vector<bool> reads;
  for (std::size_t c = 0; c < before.size(); ++c) reads.push_back(before[c] != after[c]);
  return reads;
}

std::vector<double> SamplesOf(std::span<const StrokeStretches> strokes, int channel) {
  std::size_t total = 0;
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& stretch : stroke) total += static_cast<std::size_t>(stretch.samples);
  const auto step = static_cast<int>(std::max<std::size_t>(1, total / kQuantileSamples));
  std::vector<double> values;
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& stretch : stroke)
      for (int k = 0; k < stretch.samples; k += step) values.push_back(stretch[channel][k]);
  return values;
}

}  // namespace

FeatureBanks::FeatureBanks(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                           const WindowSamples& window)
    : model_(model),
      strokes_(strokes),
      window_(window),
      weights_(model.level_form ? WeightsOfValues(window.block) : WeightsOfIncrements(window.block)),
      column_state_(model.columns.size(), 0.0) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const int channel : AxisChannels()) {
    const std::vector<double> values = SamplesOf(strokes, channel);
    const Axis axis{channel, Quantile(values, kTail, nan), Quantile(values, 1 - kTail, nan)};
    if (axis.high > axis.low) axes_.push_back(axis);
  }
  paired_ = std::min<int>(kPairedAxes, static_cast<int>(axes_.size()));
  axes_.push_back({-1, 0.0, 1.0});
  FindTimes();
  ChooseBanks();
}

/// Strokes of a log follow one another; a stroke without a stretch is of the log before it.
void FeatureBanks::FindTimes() {
  std::vector<std::size_t> begins;  // of logs
  int log = 0;
  for (std::size_t s = 0; s < strokes_.size(); ++s) {
    const int own = strokes_[s].empty() ? log : strokes_[s].front().log;
    if (begins.empty() || own != log) begins.push_back(s);
    log = own;
  }
  several_logs_ = begins.size() > 1;
  const auto place = [](std::size_t k, std::size_t count) {
    return count > 1 ? 2.0 * static_cast<double>(k) / (static_cast<double>(count) - 1) - 1.0 : 0.0;
  };
  for (std::size_t l = 0; l < begins.size(); ++l) {
    const std::size_t end = l + 1 < begins.size() ? begins[l + 1] : strokes_.size();
    for (std::size_t s = begins[l]; s < end; ++s) {
      in_log_.push_back(place(s - begins[l], end - begins[l]));
      of_log_.push_back(place(l, begins.size()));
    }
  }
}

/// Channels that are measured, those that the base terms read first; not those that the output alone reads.
std::vector<int> FeatureBanks::AxisChannels() const {
  const Stretch* sample = nullptr;
  for (const StrokeStretches& stroke : strokes_)
    for (const Stretch& stretch : stroke)
      if (sample == nullptr) sample = &stretch;
  if (sample == nullptr) return {};
  std::vector<int> read, further;
  for (int channel = 0; channel < static_cast<int>(model_.channel_source.size()); ++channel) {
    if (model_.channel_source[channel] < 0) continue;
    const std::vector<bool> reads = ColumnsThatRead(model_, *sample, channel);
    const bool base = std::find(reads.begin(), reads.end() - 1, true) != reads.end() - 1;
    if (base)
      read.push_back(channel);
    else if (!reads.back())
      further.push_back(channel);
  }
  read.insert(read.end(), further.begin(), further.end());
  return read;
}

void FeatureBanks::ChooseBanks() {
  const int phase = static_cast<int>(axes_.size()) - 1;
  const auto name = [&](int axis) {
    return axis == phase ? std::string("the phase of the stroke") : model_.channel_names[axes_[axis].channel];
  };
  const int terms = std::min(model_.base_count, kMostModulated);
  for (int axis = 0; axis < phase; ++axis) {
    for (int c = 0; c < terms; ++c) banks_.push_back({name(axis), {c}, {axis}, kKnots});
    banks_.push_back({name(axis), {}, {axis}, kRateKnots});
  }
  for (int a = 0; a < paired_; ++a)
    for (int b = a + 1; b < paired_; ++b)
      banks_.push_back({name(a) + " and " + name(b), {}, {a, b}, kPairKnots * kPairKnots});
  std::vector<int> all(terms);
  for (int c = 0; c < terms; ++c) all[c] = c;
  banks_.push_back({name(phase), all, {phase}, terms * kPhaseKnots});
  banks_.push_back({"the time within the log", all, {}, terms * kTrendPowers});
  if (several_logs_) banks_.push_back({kOrderOfLogs, all, {}, terms * kTrendPowers, true});
  out_.banks.resize(banks_.size());
}

void FeatureBanks::FillIncrements(const Stretch& stretch) {
  increments_.resize(model_.columns.size());
  for (std::size_t c = 0; c < model_.columns.size(); ++c) {
    increments_[c].assign(stretch.samples, 0.0);
    const std::size_t count = model_.level_form ? stretch.samples : stretch.samples - 1;
    model_.columns[c].fill(stretch, column_state_[c], std::span(increments_[c].data(), count));
  }
}

void FeatureBanks::FillPlaces(const Stretch& stretch, std::size_t stroke) {
  double total = 1;
  for (const Stretch& part : strokes_[stroke]) total += part.samples;
  place_.resize(axes_.size());
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    place_[a].resize(stretch.samples);
    const Axis& axis = axes_[a];
    for (int k = 0; k < stretch.samples; ++k) {
      const double x = axis.channel < 0 ? (done_ + k) / total
                                        : (stretch[axis.channel][k] - axis.low) / (axis.high - axis.low);
      place_[a][k] = std::isfinite(x) ? x : 0.0;
    }
  }
  done_ += stretch.samples;
}

/// Block means of features: `visit(k, add)` calls add(f, x) for what feature f gains from sample k to sample k + 1 (in the level form:
/// is at sample k).
template <typename Visit>
[[gnu::always_inline]] inline void FeatureBanks::SumBlocks(int features, int blocks, BlockColumns& rows,
                                                           Visit visit) const {
  rows.means.resize(features, blocks);
  rows.noise.resize(features, blocks);
  std::vector<BlockWeights> sums(features);
  const auto add_as = [&sums](const BlockWeights& weights) {
    return [&sums, &weights](int f, double x) { sums[f].lanes += x * weights.lanes; };
  };
  const BlockWeights lead{{0, 0, 1, 0}};
  for (int k = 0; !model_.level_form && k < lead_; ++k) visit(k, add_as(lead));
  for (int b = 0; b < blocks; ++b) {
    for (auto& [sum] : sums) sum = BlockWeights::Lanes{sum[2], 0, sum[2], 0};
    for (int row = 0; row < window_.block; ++row)
      visit(lead_ + b * window_.block + row, add_as(weights_[row]));
    for (int f = 0; f < features; ++f) {
      rows.means(f, b) = sums[f].lanes[0];
      rows.noise(f, b) = sums[f].lanes[1];
    }
  }
  if (model_.level_form) return;
  rows.means.colwise() -= rows.means.rowwise().mean().eval();
  rows.noise *= std::sqrt(std::max(0.0, blocks - 1.0) / std::max(1, blocks));
}

/// What runs on vectors.
struct FeatureBanks::Wide {
  HYDROSCOPE_WIDE void FillModel(FeatureBanks& own, int blocks) {
    const int columns = own.model_.column_count();
    own.SumBlocks(columns, blocks, own.out_.model, [&](int k, const auto& add) {
      for (int c = 0; c < columns; ++c) add(c, own.increments_[c][k]);
    });
  }

  HYDROSCOPE_WIDE void FillModulated(const FeatureBanks& own, const FeatureBank& bank, int blocks,
                                     BlockColumns& rows) {
    const int knots = bank.count / static_cast<int>(bank.columns.size());
    const std::vector<double>& place = own.place_[bank.axes[0]];
    own.SumBlocks(bank.count, blocks, rows, [&](int k, const auto& add) {
      const std::size_t next = std::min<std::size_t>(k + 1, place.size() - 1);
      const Hat hat = HatAt(own.model_.level_form ? place[k] : 0.5 * (place[k] + place[next]), knots);
      for (std::size_t i = 0; i < bank.columns.size(); ++i) {
        const int left = static_cast<int>(i) * knots + hat.left;
        const double increment = own.increments_[bank.columns[i]][k];
        add(left, (1 - hat.right) * increment);
        add(left + 1, hat.right * increment);
      }
    });
  }

  HYDROSCOPE_WIDE void FillRates(const FeatureBanks& own, const FeatureBank& bank, int blocks,
                                 BlockColumns& rows) {
    const bool pair = bank.axes.size() == 2;
    const double period = own.model_.level_form ? 1.0 : own.window_.period;
    const std::vector<double>& first = own.place_[bank.axes[0]];
    const std::vector<double>& second = own.place_[bank.axes.back()];
    own.SumBlocks(bank.count, blocks, rows, [&](int k, const auto& add) {
      const Hat a = HatAt(first[k], pair ? kPairKnots : kRateKnots);
      if (!pair) {
        add(a.left, (1 - a.right) * period);
        add(a.left + 1, a.right * period);
        return;
      }
      const Hat b = HatAt(second[k], kPairKnots);
      const int corner = a.left * kPairKnots + b.left;
      add(corner, (1 - a.right) * (1 - b.right) * period);
      add(corner + 1, (1 - a.right) * b.right * period);
      add(corner + kPairKnots, a.right * (1 - b.right) * period);
      add(corner + kPairKnots + 1, a.right * b.right * period);
    });
  }
};

/// Within a span the time is as good as constant: the terms' own rows times its powers.
void FeatureBanks::FillTrend(const FeatureBank& bank, double time, BlockColumns& rows) const {
  rows.means.resize(bank.count, out_.model.means.cols());
  rows.noise.resizeLike(rows.means);
  double power = 1;
  for (int p = 0; p < kTrendPowers; ++p) {
    power *= time;
    for (std::size_t i = 0; i < bank.columns.size(); ++i) {
      const int f = p * static_cast<int>(bank.columns.size()) + static_cast<int>(i);
      rows.means.row(f) = power * out_.model.means.row(bank.columns[i]);
      rows.noise.row(f) = power * out_.model.noise.row(bank.columns[i]);
    }
  }
}

const FeatureRows& FeatureBanks::Rows(std::size_t stroke, std::size_t part) {
  if (part == 0) done_ = 0;
  const Stretch& stretch = Derived(model_, strokes_[stroke][part], work_);
  lead_ = stretch.continues ? 1 : 0;
  const int blocks = (stretch.samples - lead_) / window_.block;
  FillIncrements(stretch);
  FillPlaces(stretch, stroke);
  Wide::FillModel(*this, blocks);
  for (std::size_t b = 0; b < banks_.size(); ++b) {
    const FeatureBank& bank = banks_[b];
    if (bank.columns.empty())
      Wide::FillRates(*this, bank, blocks, out_.banks[b]);
    else if (bank.axes.empty())
      FillTrend(bank, bank.of_logs ? of_log_[stroke] : in_log_[stroke], out_.banks[b]);
    else
      Wide::FillModulated(*this, bank, blocks, out_.banks[b]);
  }
  return out_;
}

}  // namespace hydroscope
