#include "models/expressions/syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/units.h"
#include "models/expressions/limits.h"

namespace hydroscope {
namespace {

using Kind = ExpressionNode::Kind;

constexpr std::size_t kMaxLength = 2000;
constexpr int kMaxParts = kMaxExpressionOperators;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Binary operators by rank, loosest first.
const std::vector<std::vector<std::string_view>> kRanks = {
    {"||"}, {"&&"}, {"<=", ">=", "==", "!=", "<", ">"}, {"+", "-"}, {"*", "/"}};

const Told kOperand = {"a signal, a number or \"(\"", "ein Signal, eine Zahl oder \"(\""};

class Parser {
 public:
  explicit Parser(const std::string& text) : text_(text) {}

  ExpressionResult<Expression> Run() {
    if (text_.size() > kMaxLength)
      return Fail(kMaxLength, Tell("the expression is longer than {} characters",
                                   "der Ausdruck ist länger als {} Zeichen", kMaxLength));
    auto whole = Conditional();
    if (whole && !AtEnd())
      return Fail(at_, Unexpected({"an operator or the end", "ein Operator oder das Ende"}));
    return whole;
  }

 private:
  using Parsed = ExpressionResult<Expression>;

  static tl::unexpected<ExpressionError> Fail(std::size_t at, Told text) {
    return tl::unexpected(ExpressionError{at, std::move(text)});
  }
  static tl::unexpected<ExpressionError> TooLong(std::size_t at) {
    return Fail(
        at, Tell("more than {} operators and brackets", "mehr als {} Operatoren und Klammern", kMaxParts));
  }
  void SkipSpace() {
    while (at_ < text_.size() && IsSpace(text_[at_])) ++at_;
  }
  bool AtEnd() {
    SkipSpace();
    return at_ == text_.size();
  }
  Told Unexpected(const Told& expected) {
    if (AtEnd())
      return Tell("the expression ends here; expected {}", "der Ausdruck endet hier; erwartet: {}", expected);
    const char c = text_[at_];
    if (c == ',')
      return Tell("unexpected \",\"; expected {} (the decimal sign is a point)",
                  "unerwartet: \",\"; erwartet: {} (das Dezimalzeichen ist ein Punkt)", expected);
    if (static_cast<unsigned char>(c) >= 0x80 || static_cast<unsigned char>(c) < 0x20)
      return Tell("a character no expression knows; expected {}",
                  "ein Zeichen, das kein Ausdruck kennt; erwartet: {}", expected);
    return Tell("unexpected \"{}\"; expected {}", "unerwartet: \"{}\"; erwartet: {}", c, expected);
  }
  bool Take(std::string_view symbol) {
    SkipSpace();
    if (text_.compare(at_, symbol.size(), symbol) != 0) return false;
    at_ += symbol.size();
    return true;
  }
  static Expression Node(Kind kind, std::size_t at, std::string text, std::vector<Expression> args) {
    return std::make_shared<const ExpressionNode>(
        ExpressionNode{kind, 0, std::move(text), std::move(args), at});
  }

  Parsed Conditional() {
    if (++brackets_ > kMaxExpressionParts)
      return Fail(at_, Tell("more than {} brackets", "mehr als {} Klammern", kMaxExpressionParts));
    if (++parts_ > kMaxParts) return TooLong(at_);
    auto condition = Binary(0);
    SkipSpace();
    const std::size_t mark = at_;
    if (condition && Take("?")) {
      auto yes = Conditional();
      if (!yes) return yes;
      if (!Take(":"))
        return Fail(at_, Unexpected({"\":\" of condition ? a : b", "\":\" von Bedingung ? a : b"}));
      auto no = Conditional();
      if (!no) return no;
      condition = Node(Kind::kConditional, mark, "?", {*condition, *yes, *no});
    }
    return condition;
  }

  Parsed Binary(std::size_t rank) {
    if (rank == kRanks.size()) return Sign();
    auto left = Binary(rank + 1);
    while (left) {
      SkipSpace();
      const std::size_t mark = at_;
      const auto op = std::find_if(kRanks[rank].begin(), kRanks[rank].end(), [&](auto o) { return Take(o); });
      if (op == kRanks[rank].end()) return left;
      auto right = Binary(rank + 1);
      if (!right) return right;
      left = Node(Kind::kBinary, mark, std::string(*op), {*left, *right});
      if (++parts_ > kMaxParts) return TooLong(mark);
    }
    return left;
  }

  Parsed Sign() {
    SkipSpace();
    const std::size_t mark = at_;
    const bool minus = Take("-"), plus = !minus && Take("+"), no = !minus && !plus && Take("!");
    if (!minus && !plus && !no) return Power();
    if (++parts_ > kMaxParts) return TooLong(mark);
    auto operand = Sign();
    if (!operand || plus) return operand;
    return Node(minus ? Kind::kNegate : Kind::kNot, mark, "", {*operand});
  }

  Parsed Power() {
    auto base = Primary();
    if (!base) return base;
    SkipSpace();
    const std::size_t mark = at_;
    if (!Take("^")) return base;
    if (++parts_ > kMaxParts) return TooLong(mark);
    auto exponent = Sign();
    if (!exponent) return exponent;
    return Node(Kind::kBinary, mark, "^", {*base, *exponent});
  }

  Parsed Primary() {
    SkipSpace();
    const std::size_t mark = at_;
    if (Take("(")) {
      auto inner = Conditional();
      if (inner && !Take(")")) return Fail(at_, Unexpected({"\")\"", "\")\""}));
      return inner;
    }
    if (AtEnd()) return Fail(at_, Unexpected(kOperand));
    if (IsDigit(text_[at_]) || text_[at_] == '.') return Number(mark);
    if (!IsLetter(text_[at_])) return Fail(at_, Unexpected(kOperand));
    while (at_ < text_.size() && (IsLetter(text_[at_]) || IsDigit(text_[at_]))) ++at_;
    std::string name = text_.substr(mark, at_ - mark);
    if (Take("(")) return Call(mark, std::move(name));
    return Node(Kind::kName, mark, std::move(name), {});
  }

  Parsed Number(std::size_t mark) {
    double number = 0;
    const char* end = text_.data() + text_.size();
    const auto [rest, problem] = std::from_chars(text_.data() + mark, end, number);
    if (problem != std::errc() || !std::isfinite(number))
      return Fail(mark, {"this is no number", "das ist keine Zahl"});
    at_ = static_cast<std::size_t>(rest - text_.data());
    if (at_ < text_.size() && IsLetter(text_[at_]))
      return Fail(
          at_,
          {"a letter after a number; write * between them, units have no place here (SI)",
           "ein Buchstabe hinter einer Zahl; * dazwischen schreiben, Einheiten haben hier keinen Platz (SI)"});
    return std::make_shared<const ExpressionNode>(ExpressionNode{Kind::kNumber, number, "", {}, mark});
  }

  Parsed Call(std::size_t mark, std::string name) {
    const auto& known = ExpressionFunctions();
    const auto function =
        std::find_if(known.begin(), known.end(), [&](const auto& f) { return f.name == name; });
    if (function == known.end()) return Fail(mark, UnknownFunction(name));
    std::vector<Expression> args;
    if (!Take(")")) {
      do {
        auto argument = Conditional();
        if (!argument) return argument;
        args.push_back(*argument);
      } while (Take(","));
      if (!Take(")")) return Fail(at_, Unexpected({"\",\" or \")\"", "\",\" oder \")\""}));
    }
    if (args.size() < function->min_args || args.size() > function->max_args)
      return Fail(
          mark, Tell("{0} takes {1} argument{2}, found {3}", "{0} nimmt {1} Argument{4}, gefunden {3}", name,
                     function->max_args > 2 ? Tell("{} or more", "{} oder mehr", function->min_args)
                                            : Tell("{}", "{}", function->min_args),
                     function->min_args == 1 ? "" : "s", args.size(), function->min_args == 1 ? "" : "e"));
    return Node(Kind::kCall, mark, std::move(name), std::move(args));
  }

  static Told UnknownFunction(const std::string& name) {
    if (name == "log")
      return {"unknown function \"log\"; write ln (natural) or log10",
              "unbekannte Funktion \"log\"; ln (natürlich) oder log10 schreiben"};
    if (name == "if")
      return {"unknown function \"if\"; write condition ? a : b",
              "unbekannte Funktion \"if\"; Bedingung ? a : b schreiben"};
    std::vector<std::string> names;
    for (const ExpressionFunction& f : ExpressionFunctions()) names.emplace_back(f.name);
    const std::string near = Nearest(name, names);
    std::string all;
    for (const std::string& n : names) all += (all.empty() ? "" : " ") + n;
    return Tell("unknown function \"{}\"; {}functions: {}", "unbekannte Funktion \"{}\"; {}Funktionen: {}",
                name, near.empty() ? Told() : Tell("did you mean \"{}\"? ", "war \"{}\" gemeint? ", near),
                all);
  }

  const std::string& text_;
  std::size_t at_ = 0;
  int parts_ = 0, brackets_ = 0;
};

}  // namespace

const std::vector<ExpressionFunction>& ExpressionFunctions() {
  constexpr std::size_t kMany = 20;
  static const std::vector<ExpressionFunction> functions = {
      {"ddt", 1, 1, "rate of change, taken by the window"},
      {"delay", 2, 2, "a signal some seconds ago; in models with states"},
      {"abs", 1, 1, "absolute value"},
      {"sign", 1, 1, "-1, 0 or 1"},
      {"sqrt", 1, 1, "square root"},
      {"exp", 1, 1, "e to the power of"},
      {"ln", 1, 1, "natural logarithm"},
      {"log10", 1, 1, "decimal logarithm"},
      {"sin", 1, 1, "sine, rad"},
      {"cos", 1, 1, "cosine, rad"},
      {"tan", 1, 1, "tangent, rad"},
      {"asin", 1, 1, "inverse sine, rad"},
      {"acos", 1, 1, "inverse cosine, rad"},
      {"atan", 1, 1, "inverse tangent, rad"},
      {"atan2", 2, 2, "angle of the point (second, first), rad"},
      {"sinh", 1, 1, "hyperbolic sine"},
      {"cosh", 1, 1, "hyperbolic cosine"},
      {"tanh", 1, 1, "hyperbolic tangent"},
      {"min", 2, kMany, "smallest"},
      {"max", 2, kMany, "largest"},
  };
  return functions;
}

ExpressionResult<Expression> ParseExpression(const std::string& text) { return Parser(text).Run(); }

std::string CanonicalText(const ExpressionNode& node) {
  const auto arg = [&](std::size_t i) { return CanonicalText(*node.args[i]); };
  switch (node.kind) {
    case Kind::kNumber:
      return node.number < 0 ? fmt::format("({})", node.number) : fmt::format("{}", node.number);
    case Kind::kName:
      return node.text;
    case Kind::kNegate:
      return fmt::format("(-{})", arg(0));
    case Kind::kNot:
      return fmt::format("(!{})", arg(0));
    case Kind::kBinary:
      return fmt::format("({}{}{})", arg(0), node.text, arg(1));
    case Kind::kConditional:
      return fmt::format("({}?{}:{})", arg(0), arg(1), arg(2));
    case Kind::kCall:
      break;
  }
  std::string list;
  for (std::size_t i = 0; i < node.args.size(); ++i) list += (i == 0 ? "" : ",") + arg(i);
  return fmt::format("{}({})", node.text, list);
}

Expression NumberNode(double number) {
  return std::make_shared<const ExpressionNode>(ExpressionNode{Kind::kNumber, number, "", {}, 0});
}

Expression NameNode(const std::string& name) {
  return std::make_shared<const ExpressionNode>(ExpressionNode{Kind::kName, 0, name, {}, 0});
}

Expression BinaryNode(const std::string& op, Expression left, Expression right) {
  return std::make_shared<const ExpressionNode>(
      ExpressionNode{Kind::kBinary, 0, op, {std::move(left), std::move(right)}, 0});
}

Expression NegateNode(Expression operand) {
  return std::make_shared<const ExpressionNode>(
      ExpressionNode{Kind::kNegate, 0, "", {std::move(operand)}, 0});
}

bool ContainsDdt(const ExpressionNode& node) {
  if (node.kind == Kind::kCall && node.text == "ddt") return true;
  return std::any_of(node.args.begin(), node.args.end(), [](const Expression& a) { return ContainsDdt(*a); });
}

std::string CaretLine(const std::string& text, std::size_t at) {
  constexpr std::size_t kBefore = 60, kAfter = 40;
  const std::size_t mark = std::min(at, text.size());
  const std::size_t first = mark > kBefore ? mark - kBefore : 0;
  std::string shown = text.substr(first, mark - first + kAfter);
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  // A character of several bytes is one column wide.
  const auto columns = std::count_if(shown.begin(), shown.begin() + static_cast<std::ptrdiff_t>(mark - first),
                                     [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
  return fmt::format("    {}\n    {}^", shown, std::string(static_cast<std::size_t>(columns), ' '));
}

}  // namespace hydroscope
