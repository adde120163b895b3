#include "estimation/linear_form/window_equations.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "models/expressions/check.h"
#include "models/expressions/evaluator.h"

namespace hydroscope {
namespace {

using Channels = std::vector<std::vector<double>>;

/// A text as a program over the channels; nothing for "".
std::optional<ExpressionEvaluator> ProgramOfText(const std::string& text, const Machine& machine,
                                                 const std::map<std::string, int>& channel_of) {
  if (text.empty()) return std::nullopt;
  const auto tree = ParseExpression(text);
  if (!tree) return std::nullopt;
  auto constants = ExpressionNamesOf(machine).constants;
  return ExpressionEvaluator(*WithValues(*tree, constants), channel_of);
}

/// Central differences over `half` rows, twice and three times as many, extrapolated so that their errors of second and fourth
/// order cancel (Richardson 1911): one alone is low by (w half period)^2/6 of what moves with w, and with it what oil takes up.
/// At the ends over what there is.
std::vector<double> RateOf(const std::vector<double>& values, int half, double period) {
  const int n = static_cast<int>(values.size());
  const auto difference = [&](int k, int reach) {
    const int a = std::max(0, k - reach), b = std::min(n - 1, k + reach);
    return (values[b] - values[a]) / (period * (b - a));
  };
  std::vector<double> rate(values.size());
  for (int k = 0; k < n; ++k) {
    const bool inside = k >= 3 * half && k + 3 * half < n;
    rate[k] = inside ? (15 * difference(k, half) - 6 * difference(k, 2 * half) + difference(k, 3 * half)) / 10
                     : difference(k, half);
  }
  return rate;
}

/// Means over [k, k + box] by the trapezoidal rule: values between rows k and k + box.
std::vector<double> BoxMeans(const std::vector<double>& values, int box) {
  const auto width = static_cast<std::size_t>(box);
  if (values.size() <= width) return {};
  std::vector<double> means(values.size() - width);
  for (std::size_t k = 0; k < means.size(); ++k) {
    double sum = 0.5 * (values[k] + values[k + width]);
    for (std::size_t i = 1; i < width; ++i) sum += values[k + i];
    means[k] = sum / box;
  }
  return means;
}

/// d/dt rate + level, seen through the window: the first box makes the rate a difference.
std::vector<double> Windowed(const std::vector<double>& rate, const std::vector<double>& level, int box,
                             double period) {
  std::vector<double> out;
  if (!level.empty()) out = BoxMeans(level, box);
  if (!rate.empty()) {
    const auto width = static_cast<std::size_t>(box);
    out.resize(rate.size() - width, 0.0);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += (rate[k + width] - rate[k]) / (box * period);
  }
  for (int pass = 0; pass < 3; ++pass) out = BoxMeans(out, box);
  return out;
}

/// The columns of one record.
class RecordWindows {
 public:
  RecordWindows(const LinearForm& form, const Machine& machine, const Episode& episode,
                const WindowEquationOptions& options)
      : machine_(machine), rows_(static_cast<std::size_t>(episode.rows())) {
    period_ = (episode.time.back() - episode.time.front()) / std::max(1, episode.rows() - 1);
    box_ = std::max(2, static_cast<int>(std::lround(options.box / period_)));
    const int half = std::max(1, static_cast<int>(std::lround(options.rate_half_width / period_)));
    for (std::size_t s = 0; s < machine.signals.size(); ++s) {
      const auto column = episode.signal.col(s);
      channel_of_[machine.signals[s].name] = static_cast<int>(channels_.size());
      channels_.emplace_back(column.begin(), column.end());
    }
    for (const auto& [signal, name] : form.rates) {
      channel_of_[name] = static_cast<int>(channels_.size());
      channels_.push_back(RateOf(channels_[channel_of_[signal]], half, period_));
    }
  }
  bool enough() const { return rows_ > 5 * static_cast<std::size_t>(box_); }
  int box() const { return box_; }

  std::vector<double> Column(const std::string& rate, const std::string& level) const {
    return Windowed(ValuesOf(rate), ValuesOf(level), box_, period_);
  }

 private:
  std::vector<double> ValuesOf(const std::string& text) const {
    const auto program = ProgramOfText(text, machine_, channel_of_);
    if (!program) return {};
    std::vector<double> values(rows_);
    program->Values(channels_, 0, values);
    return values;
  }

  const Machine& machine_;
  std::size_t rows_;
  double period_ = 0;
  int box_ = 2;
  Channels channels_;
  std::map<std::string, int> channel_of_;
};

}  // namespace

WindowEquations WindowsOf(const LinearForm& form, const Machine& machine, std::span<const Episode> episodes,
                          const WindowEquationOptions& options) {
  const std::size_t equations = form.equations.size(), parameters = form.parameters.size();
  std::vector<std::vector<Eigen::VectorXd>> rows(equations);  // of windows: parameters, then what is known
  WindowEquations out;
  for (const Episode& episode : episodes) {
    const RecordWindows record(form, machine, episode, options);
    if (!record.enough()) continue;
    std::vector<Eigen::MatrixXd> columns(equations);
    for (std::size_t e = 0; e < equations; ++e) {
      const LinearForm::Equation& equation = form.equations[e];
      const std::vector<double> known = record.Column(equation.known_rate, equation.known_level);
      const auto count = static_cast<Eigen::Index>(known.size());
      columns[e] = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(parameters) + 1);
      columns[e].rightCols(1) = Eigen::Map<const Eigen::VectorXd>(known.data(), count);
      for (const LinearForm::Term& term : equation.terms) {
        const auto p = std::ranges::find(form.parameters, term.parameter) - form.parameters.begin();
        const std::vector<double> column = record.Column(term.rate, term.level);
        columns[e].col(p) += Eigen::Map<const Eigen::VectorXd>(column.data(), count);
      }
    }
    const Eigen::Index count = columns.front().rows();
    for (Eigen::Index k = 0; k < count; k += record.box()) {
      const bool whole =
          std::ranges::all_of(columns, [k](const Eigen::MatrixXd& c) { return c.row(k).allFinite(); });
      if (!whole) continue;
      for (std::size_t e = 0; e < equations; ++e) rows[e].push_back(columns[e].row(k).transpose());
      out.time.push_back(
          episode.time[static_cast<std::size_t>(k) + 2 * static_cast<std::size_t>(record.box())]);
    }
  }
  for (const std::vector<Eigen::VectorXd>& of_equation : rows) {
    const auto count = static_cast<Eigen::Index>(of_equation.size());
    Eigen::MatrixXd regressor(count, static_cast<Eigen::Index>(parameters));
    Eigen::VectorXd known(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      regressor.row(k) = of_equation[k].head(regressor.cols());
      known[k] = of_equation[k][regressor.cols()];
    }
    out.regressor.push_back(std::move(regressor));
    out.known.push_back(std::move(known));
  }
  return out;
}

}  // namespace hydroscope
