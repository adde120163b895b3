#include "models/expressions/units.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace hydroscope {
namespace {

using Kind = ExpressionNode::Kind;

constexpr std::array<std::string_view, 5> kBaseNames = {"kg", "m", "s", "A", "K"};

const std::vector<std::pair<std::string_view, Dimension>>& Symbols() {
  static const std::vector<std::pair<std::string_view, Dimension>> symbols = {
      {"1", {}},
      {"rad", {}},
      {"kg", {{1, 0, 0, 0, 0}}},
      {"m", {{0, 1, 0, 0, 0}}},
      {"s", {{0, 0, 1, 0, 0}}},
      {"A", {{0, 0, 0, 1, 0}}},
      {"K", {{0, 0, 0, 0, 1}}},
      {"Hz", {{0, 0, -1, 0, 0}}},
      {"N", {{1, 1, -2, 0, 0}}},
      {"Nm", {{1, 2, -2, 0, 0}}},
      {"Pa", {{1, -1, -2, 0, 0}}},
      {"J", {{1, 2, -2, 0, 0}}},
      {"W", {{1, 2, -3, 0, 0}}},
      {"V", {{1, 2, -3, -1, 0}}},
  };
  return symbols;
}

/// unit = factor { ["*" | " " | "/"] factor }; factor = symbol [exponent] | "(" unit ")" | "sqrt(" unit ")".
class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : text_(text) {}

  std::optional<Dimension> Run() {
    const auto unit = Product(0);
    return unit && at_ == text_.size() ? unit : std::nullopt;
  }

 private:
  bool Take(std::string_view symbol) {
    if (text_.substr(at_, symbol.size()) != symbol) return false;
    at_ += symbol.size();
    return true;
  }
  void SkipSpace() {
    while (Take(" ")) {
    }
  }

  std::optional<Dimension> Product(int depth) {
    if (depth > 8) return std::nullopt;
    SkipSpace();
    auto unit = Factor(depth);
    for (SkipSpace(); unit && at_ < text_.size() && text_[at_] != ')'; SkipSpace()) {
      const bool over = Take("/");
      if (!over) Take("*");
      SkipSpace();
      const auto factor = Factor(depth);
      if (!factor) return std::nullopt;
      unit = over ? *unit / *factor : *unit * *factor;
    }
    return unit;
  }

  std::optional<Dimension> Factor(int depth) {
    const bool root = Take("sqrt(");
    if (root || Take("(")) {
      const auto inner = Product(depth + 1);
      if (!inner || !Take(")")) return std::nullopt;
      return root ? inner->Power(0.5) : *inner;
    }
    std::size_t end = at_;
    while (end < text_.size() && std::isalpha(static_cast<unsigned char>(text_[end]))) ++end;
    if (end == at_ && end < text_.size() && text_[end] == '1') ++end;
    const std::string_view name = text_.substr(at_, end - at_);
    for (const auto& [symbol, dimension] : Symbols()) {
      if (symbol != name) continue;
      at_ = end;
      return dimension.Power(Exponent());
    }
    return std::nullopt;
  }

  double Exponent() {
    Take("^");
    const bool minus = Take("-");
    if (at_ == text_.size() || text_[at_] < '0' || text_[at_] > '9') return minus ? NAN : 1.0;
    const double digit = text_[at_++] - '0';
    return minus ? -digit : digit;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

using Factors = std::vector<std::pair<std::string_view, double>>;  ///< symbol, power

double Size(const Factors& factors) {
  double sum = 0;
  for (const auto& [symbol, power] : factors) sum += std::abs(power);
  return sum;
}

/// "1/(V2 s)" and not "s5 A2/(kg2 m4)": base units, beside the power of one other unit that leaves least of them.
Factors FewestFactors(const Dimension& dimension) {
  Factors best;
  for (const std::string_view symbol : {"", "V", "Pa", "N", "W"})
    for (const double power : {1, -1, 2, -2, 3, -3}) {
      const Dimension rest =
          symbol.empty() ? dimension : dimension / ParseSiUnit(symbol).value_or(Dimension{}).Power(power);
      Factors factors;
      if (!symbol.empty()) factors.emplace_back(symbol, power);
      for (std::size_t i = 0; i < kBaseNames.size(); ++i)
        if (std::abs(rest.power[i]) > 1e-9) factors.emplace_back(kBaseNames[i], rest.power[i]);
      if (best.empty() || Size(factors) < Size(best) - 1e-9) best = std::move(factors);
    }
  return best;
}

std::string ProductName(const Factors& factors) {
  std::string above, below;
  int factors_below = 0;
  for (const auto& [symbol, power] : factors) {
    std::string& side = power > 0 ? above : below;
    if (power < 0) ++factors_below;
    side += fmt::format("{}{}{}", side.empty() ? "" : " ", symbol,
                        std::abs(std::abs(power) - 1) < 1e-9 ? "" : fmt::format("{:.3g}", std::abs(power)));
  }
  if (below.empty()) return above;
  return fmt::format("{}/{}", above.empty() ? "1" : above, factors_below > 1 ? "(" + below + ")" : below);
}

Told Shown(const ExpressionUnit& unit) {
  return unit.dimension.pure() ? Told("a pure number", "eine reine Zahl") : Told(SiUnitName(unit.dimension));
}

/// Both sides of + - < == ?: min max.
ExpressionResult<ExpressionUnit> Common(const ExpressionNode& at, const ExpressionUnit& a,
                                        const ExpressionUnit& b) {
  if (a.exact && b.exact && !(a.dimension == b.dimension))
    return tl::unexpected(ExpressionError{
        at.at, Tell("\"{}\" puts {} and {} together, expected the same unit on both sides",
                    "\"{}\" verbindet {} und {}, erwartet: dieselbe Einheit auf beiden Seiten", at.text,
                    Shown(a), Shown(b))});
  return a.exact ? a : b;
}

const std::set<std::string> kComparisons = {"<", "<=", ">", ">=", "==", "!="};

/// What all arguments from `first` on have in common.
ExpressionResult<ExpressionUnit> CommonOf(const ExpressionNode& node, const std::vector<ExpressionUnit>& args,
                                          std::size_t first) {
  ExpressionResult<ExpressionUnit> unit = args[first];
  for (std::size_t i = first + 1; unit && i < args.size(); ++i) unit = Common(node, *unit, args[i]);
  return unit;
}

ExpressionResult<ExpressionUnit> UnitOfCall(const ExpressionNode& node,
                                            const std::vector<ExpressionUnit>& args) {
  if (node.text == "abs") return args[0];
  if (node.text == "sign" || node.text == "atan2") return ExpressionUnit{};
  if (node.text == "sqrt") return ExpressionUnit{args[0].dimension.Power(0.5), args[0].exact};
  if (node.text == "ddt")
    return ExpressionUnit{args[0].dimension * Dimension{{0, 0, -1, 0, 0}}, args[0].exact};
  if (node.text == "min" || node.text == "max") return CommonOf(node, args, 0);
  if (node.text == "delay") {
    if (args[1].exact && !(args[1].dimension == Dimension{{0, 0, 1, 0, 0}}))
      return tl::unexpected(ExpressionError{
          node.args[1]->at,
          Tell("a delay in {}, expected s", "eine Verzögerung in {}, erwartet: s", Shown(args[1]))});
    return args[0];
  }
  if (args[0].exact && !args[0].dimension.pure())
    return tl::unexpected(ExpressionError{
        node.at, Tell("{} of {}, expected a pure number: divide by a value of that unit first",
                      "{} von {}, erwartet: eine reine Zahl; erst durch einen Wert dieser Einheit teilen",
                      node.text, Shown(args[0]))});
  return ExpressionUnit{};
}

}  // namespace

bool Dimension::operator==(const Dimension& other) const {
  for (std::size_t i = 0; i < power.size(); ++i)
    if (!(std::abs(power[i] - other.power[i]) < 1e-9)) return false;
  return true;
}

Dimension Dimension::operator*(const Dimension& other) const {
  Dimension product = *this;
  for (std::size_t i = 0; i < power.size(); ++i) product.power[i] += other.power[i];
  return product;
}

Dimension Dimension::operator/(const Dimension& other) const { return *this * other.Power(-1); }

Dimension Dimension::Power(double exponent) const {
  Dimension result = *this;
  for (double& p : result.power) p *= exponent;
  return result;
}

std::optional<Dimension> ParseSiUnit(std::string_view text) {
  const auto unit = UnitParser(text).Run();
  if (!unit) return std::nullopt;
  for (double p : unit->power)
    if (!std::isfinite(p)) return std::nullopt;
  return unit;
}

std::string SiUnitName(const Dimension& dimension) {
  static const std::vector<std::string_view> familiar = {
      "1",        "s",        "Pa",         "m",         "m2",
      "m3",       "m/s",      "m3/s",       "V",         "A",
      "N",        "K",        "1/s",        "kg",        "W",
      "Pa/s",     "m/s2",     "N/s",        "m3/(s Pa)", "m3/(s sqrt(Pa))",
      "1/K",      "1/Pa",     "N/m",        "N s/m",     "Pa s",
      "Pa s2/m6", "kg/m4",    "m3/Pa",      "Pa s/m",    "N/V",
      "Pa/V",     "1/V",      "m/V",        "m3/(s V)",  "N/A",
      "Pa/K",     "m3/(s K)", "N/K",        "m3/s2",     "m/(s V)",
      "Pa/m3",    "sqrt(Pa)", "m6/(s2 Pa)", "1/m",       "N s2/m2",
      "m2/s",     "s/m",      "m3/m",       "1/V2",      "N/V2",
      "m/V2",     "Pa/V2",    "m3/(s V2)",  "1/m2",      "1/Pa2",
      "N m",      "N m s",    "N m/V",      "N m/A",     "N m/K",
      "kg m2",    "kg m",     "kg/s",       "m3/(s A)",  "m/A",
      "W/K",      "K/W",      "K/s",        "V/s",       "A/s",
      "V/A",      "A/V",      "V s",        "V s/m",     "Pa/A"};
  for (const std::string_view name : familiar)
    if (*ParseSiUnit(name) == dimension) return std::string(name);
  return ProductName(FewestFactors(dimension));
}

ExpressionResult<ExpressionUnit> UnitOf(const ExpressionNode& node, const NameUnits& names) {
  std::vector<ExpressionUnit> args;
  for (const Expression& arg : node.args) {
    const auto unit = UnitOf(*arg, names);
    if (!unit) return unit;
    args.push_back(*unit);
  }
  switch (node.kind) {
    case Kind::kNumber:
      return ExpressionUnit{{}, false};
    case Kind::kName: {
      const auto found = names.find(node.text);
      if (found == names.end() || !found->second) return ExpressionUnit{{}, false};
      return ExpressionUnit{*found->second, true};
    }
    case Kind::kNegate:
      return args[0];
    case Kind::kNot:
      return ExpressionUnit{};
    case Kind::kConditional:
      return CommonOf(node, args, 1);
    case Kind::kBinary:
      if (node.text == "*")
        return ExpressionUnit{args[0].dimension * args[1].dimension, args[0].exact && args[1].exact};
      if (node.text == "/")
        return ExpressionUnit{args[0].dimension / args[1].dimension, args[0].exact && args[1].exact};
      if (node.text == "^") {
        if (args[1].exact && !args[1].dimension.pure())
          return tl::unexpected(ExpressionError{
              node.at, Tell("the exponent has the unit {}, expected a pure number",
                            "der Exponent hat die Einheit {}, erwartet: eine reine Zahl", Shown(args[1]))});
        const bool constant = node.args[1]->kind == Kind::kNumber;
        if (constant) return ExpressionUnit{args[0].dimension.Power(node.args[1]->number), args[0].exact};
        return ExpressionUnit{args[0].dimension, args[0].exact && args[0].dimension.pure()};
      }
      if (node.text == "&&" || node.text == "||") return ExpressionUnit{};
      return CommonOf(node, args, 0).map([&](const ExpressionUnit& both) {
        return kComparisons.contains(node.text) ? ExpressionUnit{} : both;
      });
    case Kind::kCall:
      return UnitOfCall(node, args);
  }
  return ExpressionUnit{};
}

}  // namespace hydroscope
