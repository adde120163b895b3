#include "models/expressions/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/constants.h"
#include "core/units.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/table.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

using Kind = ExpressionNode::Kind;
using Checked = tl::expected<void, ExpressionError>;

std::string Signals(const ExpressionNames& names) {
  std::vector<std::string> list;
  for (const auto& [name, unit] : names.units)
    if (name != "pi") list.push_back(name);
  return fmt::format("{}", fmt::join(list, ", "));
}

Checked CheckNames(const ExpressionNode& node, const ExpressionNames& names, bool in_ddt) {
  if (node.kind == Kind::kName) {
    if (!names.units.contains(node.text)) {
      std::vector<std::string> known;
      for (const auto& [name, unit] : names.units) known.push_back(name);
      return tl::unexpected(ExpressionError{
          node.at,
          Tell("unknown signal \"{}\"; {}known here: {}", "unbekanntes Signal \"{}\"; {}hier bekannt: {}",
               node.text, DidYouMean(node.text, known), Signals(names))});
    }
    if (in_ddt && names.found.contains(node.text))
      return tl::unexpected(ExpressionError{
          node.at, Tell("{} is found from the data and cannot stand inside ddt(...)",
                        "{} wird aus den Daten gefunden und kann nicht in ddt(...) stehen", node.text)});
  }
  for (const Expression& arg : node.args)
    if (const Checked fine = CheckNames(*arg, names, in_ddt || node.text == "ddt"); !fine) return fine;
  return {};
}

/// delay(signal, time).
Checked CheckDelays(const ExpressionNode& node, const ExpressionNames& names) {
  for (const Expression& arg : node.args)
    if (const Checked fine = CheckDelays(*arg, names); !fine) return fine;
  if (node.kind != Kind::kCall || node.text != "delay") return {};
  const ExpressionNode &signal = *node.args[0], &time = *node.args[1];
  const auto refuse = [](const ExpressionNode& at, const Told& why) {
    return tl::unexpected(ExpressionError{at.at, why});
  };
  if (names.delayed.empty())
    return refuse(node,
                  {"delay(...) has a place only in the equations of a model with states that has inputs",
                   "delay(...) hat nur in Gleichungen eines Modells mit Zuständen und Eingängen Platz"});
  if (signal.kind != Kind::kName || !names.delayed.contains(signal.text))
    return refuse(
        signal,
        {"delay(...) is of an input, a signal that no equation gives: write e.g. delay(u, t_dead)",
         "delay(...) gilt einem Eingang, einem Signal, das keine Gleichung liefert: z. B. delay(u, t_dead)"});
  const bool constant =
      time.kind == Kind::kNumber || (time.kind == Kind::kName && names.constants.contains(time.text));
  if (!constant && (time.kind != Kind::kName || !names.delay_times.contains(time.text)))
    return refuse(
        time,
        {"a delay is a number of seconds, or a parameter whose min is 0 or more: write e.g. delay(u, t_dead)",
         "eine Verzögerung ist eine Zahl in Sekunden oder ein Parameter, dessen min 0 oder mehr ist: z. B. delay(u, t_dead)"});
  return {};
}

using Range = ValueRange;

/// Products of the ends; zero times anything is zero, since what is infinite here stands for what is large.
Range ProductOf(const Range& a, const Range& b) {
  const auto product = [](double x, double y) { return x == 0 || y == 0 ? 0.0 : x * y; };
  const auto [low, high] = std::minmax(
      {product(a.low, b.low), product(a.low, b.high), product(a.high, b.low), product(a.high, b.high)});
  return {low, high};
}

Range QuotientOf(const Range& a, const Range& b) {
  if (b.low > 0 || b.high < 0) return ProductOf(a, {1 / b.high, 1 / b.low});
  return {};
}

Range RangeOfName(const std::string& name, const ExpressionNames& names) {
  if (const auto constant = names.constants.find(name); constant != names.constants.end())
    return {constant->second, constant->second};
  const auto found = names.found.find(name);
  return found == names.found.end() ? Range{} : found->second;
}

/// What values an expression can take, rates and signals being anything, and names what `names` says.
Range RangeOf(const ExpressionNode& node, const ExpressionNames& names) {
  const auto arg = [&](std::size_t i) { return RangeOf(*node.args[i], names); };
  if (node.kind == Kind::kNumber) return {node.number, node.number};
  if (node.kind == Kind::kName) return RangeOfName(node.text, names);
  if (node.kind == Kind::kNegate) return {-arg(0).high, -arg(0).low};
  if (node.kind == Kind::kConditional)
    return {std::min(arg(1).low, arg(2).low), std::max(arg(1).high, arg(2).high)};
  if (node.kind == Kind::kNot) return {0, 1};
  const std::string& f = node.text;
  if (node.kind == Kind::kBinary) {
    if (f == "+") return {arg(0).low + arg(1).low, arg(0).high + arg(1).high};
    if (f == "-") return {arg(0).low - arg(1).high, arg(0).high - arg(1).low};
    if (f == "*") return ProductOf(arg(0), arg(1));
    if (f == "/") return QuotientOf(arg(0), arg(1));
    if (f == "^") {
      const Range power = arg(1);
      const bool even = power.low == power.high && std::fmod(power.low, 2.0) == 0.0;
      return {even || arg(0).low >= 0 ? 0.0 : -kInfinity, kInfinity};
    }
    return {0, 1};  // comparisons, && and ||
  }
  if (node.kind == Kind::kCall) {
    if (f == "abs") return {0, std::max(std::abs(arg(0).low), std::abs(arg(0).high))};
    if (f == "sqrt" || f == "exp") return {0, kInfinity};
    if (f == "cosh") return {1, kInfinity};
    if (f == "sign" || f == "tanh" || f == "sin" || f == "cos") return {-1, 1};
    if (f == "min" || f == "max") {
      Range range = arg(0);
      for (std::size_t i = 1; i < node.args.size(); ++i) {
        const Range next = arg(i);
        const auto pick = [&](double a, double b) { return f == "min" ? std::min(a, b) : std::max(a, b); };
        range = {pick(range.low, next.low), pick(range.high, next.high)};
      }
      return range;
    }
  }
  return {};
}

/// Operands for which a function gives a finite value.
Range Domain(const std::string& function) {
  constexpr double kLargestExponent = 700.0;
  if (function == "sqrt") return {0, kInfinity};
  if (function == "ln" || function == "log10") return {std::numeric_limits<double>::min(), kInfinity};
  if (function == "exp") return {-kInfinity, kLargestExponent};
  if (function == "sinh" || function == "cosh") return {-kLargestExponent, kLargestExponent};
  if (function == "asin" || function == "acos") return {-1, 1};
  return {};
}

Checked Refuse(const ExpressionNode& node, const Told& what, const Told& instead) {
  return tl::unexpected(ExpressionError{
      node.at,
      Tell(
          "{} of a rate that may have any sign and size, and is zero when the motion turns; write {}",
          "{} mit einer Änderungsrate, die jedes Vorzeichen und jede Größe haben kann und null ist, wenn die Bewegung "
          "umkehrt; stattdessen {}",
          what, instead)});
}

Checked CheckRates(const ExpressionNode& node, const ExpressionNames& names) {
  for (const Expression& arg : node.args)
    if (const Checked fine = CheckRates(*arg, names); !fine) return fine;
  if (node.kind == Kind::kBinary && node.text == "/" && ContainsDdt(*node.args[1])) {
    const Range below = RangeOf(*node.args[1], names);
    if (!(below.low > 0 || below.high < 0))
      return Refuse(node, {"division by an expression", "Division durch einen Ausdruck"},
                    {"e.g. max(abs(ddt(x)), 0.001)", "z. B. max(abs(ddt(x)), 0.001)"});
  }
  if (node.kind == Kind::kBinary && node.text == "^" &&
      (ContainsDdt(*node.args[0]) || ContainsDdt(*node.args[1]))) {
    const Range base = RangeOf(*node.args[0], names), power = RangeOf(*node.args[1], names);
    const bool whole = power.low == power.high && power.low >= 0 && std::fmod(power.low, 1.0) == 0.0;
    const bool root = base.low >= 0 && power.low == power.high && power.low >= 0;
    if (!whole && !root)
      return Refuse(node, {"a power", "eine Potenz"}, {"e.g. abs(ddt(x))^0.5", "z. B. abs(ddt(x))^0.5"});
  }
  if (node.kind == Kind::kCall && node.args.size() == 1 && node.text != "ddt" && ContainsDdt(*node.args[0])) {
    const Range domain = Domain(node.text), range = RangeOf(*node.args[0], names);
    if (!(range.low >= domain.low && range.high <= domain.high))
      return Refuse(node, node.text,
                    Tell("e.g. {}(max(abs(ddt(x)), 0.001)) or limit it with min and max",
                         "z. B. {}(max(abs(ddt(x)), 0.001)), oder mit min und max begrenzen", node.text));
  }
  return {};
}

Expression Map(const Expression& node, const auto& replace) {
  if (Expression replaced = replace(*node)) return replaced;
  if (node->args.empty()) return node;
  ExpressionNode copy = *node;
  for (Expression& arg : copy.args) arg = Map(arg, replace);
  return std::make_shared<const ExpressionNode>(std::move(copy));
}

}  // namespace

ExpressionNames ExpressionNamesOf(const Machine& machine) {
  ExpressionNames names;
  names.units["pi"] = Dimension{};
  names.constants["pi"] = std::numbers::pi;
  const MachineKind& kind = KindOf(machine);
  for (const auto& [name, known] : machine.geometry) {
    std::string si = known.unit;
    for (const MachineInput& input : kind.geometry)
      if (input.name == name) si = input.si;
    names.units[name] = si.empty() ? std::nullopt : ParseSiUnit(si);
    names.constants[name] = known.value;
  }
  for (const SignalSpec& signal : machine.signals) {
    names.units[signal.name] = ParseSiUnit(FindFileUnit(signal.unit).value_or(FileUnit{.si = "1"}).si);
    names.constants.erase(signal.name);
  }
  return names;
}

ExpressionNames ExpressionNamesOf(const Machine& machine, const UserEffectSpec& effect) {
  ExpressionNames names = ExpressionNamesOf(machine);
  for (const ShapeSpec& shape : effect.shape) {
    names.units[shape.name] = shape.unit.empty() ? std::nullopt : ParseSiUnit(shape.unit);
    names.constants.erase(shape.name);
    names.found[shape.name] = {shape.min, shape.max};
  }
  return names;
}

ExpressionResult<CheckedExpression> CheckExpression(const std::string& text, const ExpressionNames& names) {
  const auto tree = TRY(ParseExpression(text));
  if (const Checked fine = CheckNames(*tree, names, false); !fine) return tl::unexpected(fine.error());
  const auto unit = TRY(UnitOf(*tree, names.units));
  if (const Checked fine = CheckDelays(*tree, names); !fine) return tl::unexpected(fine.error());
  if (const Checked fine = CheckRates(*tree, names); !fine) return tl::unexpected(fine.error());
  return CheckedExpression{tree, unit};
}

Expression WithValues(const Expression& expression, const std::map<std::string, double>& values) {
  return Map(expression, [&](const ExpressionNode& node) -> Expression {
    const auto value = node.kind == Kind::kName ? values.find(node.text) : values.end();
    return value == values.end() ? nullptr : NumberNode(value->second);
  });
}

Expression WithRates(const Expression& expression, double rate) {
  return Map(expression, [&](const ExpressionNode& node) -> Expression {
    return node.kind == Kind::kCall && node.text == "ddt" ? NumberNode(rate) : nullptr;
  });
}

Expression Replaced(const Expression& expression,
                    const std::function<Expression(const ExpressionNode&)>& replacement) {
  return Map(expression, replacement);
}

std::set<std::string> NamesIn(const ExpressionNode& node) {
  std::set<std::string> names;
  if (node.kind == Kind::kName) names.insert(node.text);
  for (const Expression& arg : node.args) names.merge(NamesIn(*arg));
  return names;
}

}  // namespace hydroscope
