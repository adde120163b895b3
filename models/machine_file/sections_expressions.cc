#include <algorithm>
#include <optional>
#include <set>

#include "core/limits.h"
#include "models/effect.h"
#include "models/expressions/balance.h"
#include "models/expressions/user_effect.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Column of a character of a text in quotes, from 1; 0 where escapes or several lines hide it.
std::size_t ColumnOf(const toml::node& node, const std::string& text, std::size_t at) {
  const toml::source_region& where = node.source();
  const bool plain = std::all_of(text.begin(), text.end(),
                                 [](char c) { return c >= 0x20 && c < 0x7f && c != '\\' && c != '"'; });
  const bool one_line =
      where.begin.line == where.end.line && where.end.column - where.begin.column == text.size() + 2;
  return plain && one_line ? where.begin.column + 1 + at : 0;
}

/// "N m" of "Nm": units that are SI but for how people write them.
std::string SpeltAsSi(const std::string& unit) {
  const auto known = unit.empty() ? std::nullopt : FindFileUnit(unit);
  return known && known->scale == 1.0 && known->offset == 0.0 ? std::string(known->si) : unit;
}

void ReadUnit(TableReader& section, std::string& unit) {
  section.Text("unit", unit);
  unit = SpeltAsSi(unit);
  if (const auto known = FindFileUnit(unit); known && (known->scale != 1.0 || known->offset != 0.0))
    section.Wrong("unit", fmt::format("the SI unit \"{}\": balances are computed in SI", known->si));
  else if (!unit.empty() && !ParseSiUnit(unit))
    section.Wrong("unit", "an SI unit, e.g. \"m2\", \"N s/m\" or \"m3/(s Pa)\": balances are computed in SI");
}

/// The output's unit: as given, else that of the expression; "" if nobody can tell.
void ReadOutput(TableReader& section, const ExpressionNames& names, BalanceSpec& balance) {
  section.Text("output", balance.output);
  if (balance.output.empty()) {
    section.Problem("output is missing; write e.g. output = \"F\"");
    return;
  }
  const auto checked = CheckExpression(balance.output, names);
  if (!checked) {
    ExpressionProblem(section, *section.Node("output"), "output", checked.error());
    return;
  }
  const std::string expected = checked->unit.exact ? SiUnitName(checked->unit.dimension) : "";
  balance.unit = expected;
  section.Text("unit", balance.unit);
  balance.unit = SpeltAsSi(balance.unit);
  const auto dimension = ParseSiUnit(balance.unit);
  if (const auto unit = FindFileUnit(balance.unit); unit && (unit->scale != 1.0 || unit->offset != 0.0))
    section.Wrong("unit", fmt::format("the SI unit \"{}\": balances are computed in SI", unit->si));
  else if (!balance.unit.empty() && !dimension)
    section.Wrong("unit", "an SI unit, e.g. \"N\" or \"m3/s\": balances are computed in SI");
  else if (dimension && checked->unit.exact && !(*dimension == checked->unit.dimension))
    section.Wrong("unit", fmt::format("\"{}\", the SI unit of {}", expected, balance.output));
}

void ReadShape(TableReader& section, const Machine& machine, UserEffectSpec& effect) {
  const toml::table* table = section.Table("shape");
  if (table == nullptr) return;
  TableReader shape(*table, section.path() + ".shape", section.problems());
  for (const TableReader::Entry& entry : shape.Entries()) {
    const toml::table* limits = shape.Table(entry.key);
    if (limits == nullptr) continue;
    TableReader reader(*limits, shape.path() + "." + entry.key, section.problems());
    reader.AllowOnly(MachineFileKeys("shape.<name>"));
    ShapeSpec spec;
    spec.name = entry.key;
    if (!IsName(entry.key) || entry.key == "pi" || machine.SignalIndex(entry.key) >= 0)
      shape.Problem(entry.where,
                    fmt::format("\"{}\" is no name for a constant: letters, digits and _ only, no digit "
                                "first, and no signal of that name",
                                entry.key));
    std::string unit;
    reader.UnitName("unit", unit, "");
    if (!unit.empty()) spec.unit = FindFileUnit(unit).value_or(FileUnit{.si = "1"}).si;
    std::optional<double> min, max;
    const Quantity quantity{.si = spec.unit, .default_unit = unit};
    reader.Number("min", min, quantity);
    reader.Number("max", max, quantity);
    if (!min || !max) reader.Problem("min and max are needed: the data are searched between them");
    if (min && max && !(*min < *max)) reader.Wrong("min", "a limit below max");
    spec.min = min.value_or(0);
    spec.max = max.value_or(1);
    effect.shape.push_back(std::move(spec));
  }
  if (effect.shape.size() > kMaxShape)
    section.Wrong("shape", fmt::format("at most {} constants found from the data", kMaxShape));
}

void CheckId(TableReader& section, const Machine& machine, const UserEffectSpec& effect,
             std::set<std::string>& ids) {
  if (effect.id.empty()) {
    section.Problem("id is missing; write e.g. id = \"coulomb_friction\"");
    return;
  }
  if (!ids.insert(effect.id).second) section.Wrong("id", "an id that no other effect has");
  const MachineKind& kind = KindOf(machine);
  if (kind.effects == nullptr) return;
  const Machine any;
  for (const auto& built_in : kind.effects(any))
    if (built_in->id == effect.id) section.Wrong("id", "another id: an effect of the library is called so");
}

void ReadEffect(TableReader& section, std::set<std::string>& ids, Machine& machine) {
  section.AllowOnly(MachineFileKeys("effect"));
  UserEffectSpec effect;
  section.Text("id", effect.id);
  CheckId(section, machine, effect, ids);
  section.Text("description", effect.description);
  section.Text("german", effect.german);
  if (KindOf(machine).has_states) {
    // Without the equations, whose problem is known, everything in it would seem wrong.
    if (!machine.states.states.empty() || KindOf(machine).states == nullptr)
      ReadStateEffect(section, machine, effect);
    machine.user_effects.push_back(std::move(effect));
    return;
  }
  ReadShape(section, machine, effect);
  std::vector<ExpressionUnit> units;
  effect.terms = ReadTerms(section, "terms", ExpressionNamesOf(machine, effect), units);
  if (effect.terms.size() > 1)
    section.Wrong("terms", "one parameter with its expression: write a second [[effect]] for the other one");
  std::string unit;
  ReadUnit(section, unit);
  for (TermSpec& term : effect.terms)
    if (term.unit.empty()) term.unit = unit;
  const std::string output(OutputSi(machine));
  CheckTermUnits(section, "terms", effect.terms, units, output);
  section.Number("min", effect.min, {.si = ""});
  section.Number("max", effect.max, {.si = ""});
  if (effect.min && effect.max && *effect.min > *effect.max) section.Wrong("min", "a limit not above max");
  section.Number("typical", effect.typical, {.si = "", .low = 0, .above_low = true});
  machine.user_effects.push_back(std::move(effect));
}

}  // namespace

bool IsName(const std::string& text) {
  const auto tree = ParseExpression(text);
  return tree && (*tree)->kind == ExpressionNode::Kind::kName && (*tree)->text == text;
}

void ExpressionProblem(TableReader& reader, const toml::node& node, const std::string& key,
                       const ExpressionError& error) {
  const std::string& text = node.as_string()->get();
  reader.Problem(node.source(), Tell("{}: {}\n{}", "{}: {}\n{}", key, error.text, CaretLine(text, error.at)),
                 ColumnOf(node, text, error.at));
}

std::vector<TermSpec> ReadTerms(TableReader& section, const std::string& key, const ExpressionNames& names,
                                std::vector<ExpressionUnit>& units) {
  std::vector<TermSpec> terms;
  const toml::table* table = section.Table(key);
  if (table == nullptr || table->empty()) {
    section.Problem(fmt::format("{0} is missing; write e.g. {0} = {{ friction = \"sign(ddt(x))\" }}", key));
    return terms;
  }
  TableReader reader(*table, section.path() + "." + key, section.problems());
  for (const TableReader::Entry& entry : reader.Entries()) {
    TermSpec term{entry.key, "", ""};
    const toml::node* text = entry.node;
    if (!IsName(entry.key))
      reader.Problem(
          entry.where,
          fmt::format("\"{}\" is no name for a parameter: letters, digits and _ only, no digit first",
                      entry.key));
    if (const toml::table* details = entry.node->as_table()) {
      TableReader inner(*details, reader.path() + "." + entry.key, section.problems());
      inner.AllowOnly(MachineFileKeys("terms.<parameter>"));
      inner.Text("expression", term.expression);
      ReadUnit(inner, term.unit);
      text = details->get("expression");
    } else {
      reader.Text(entry.key, term.expression);
    }
    units.push_back({{}, false});
    if (term.expression.empty()) {
      reader.Wrong(entry.key, "an expression over the signals in quotes, e.g. \"p*sign(ddt(x))\"");
    } else if (const auto checked = CheckExpression(term.expression, names)) {
      units.back() = checked->unit;
    } else {
      ExpressionProblem(reader, *text, entry.key, checked.error());
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

void CheckTermUnits(TableReader& section, const std::string& key, const std::vector<TermSpec>& terms,
                    const std::vector<ExpressionUnit>& units, const std::string& output_unit) {
  const auto output = ParseSiUnit(output_unit);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const auto given = ParseSiUnit(terms[i].unit);
    if (!output || !given || !units[i].exact || *given * units[i].dimension == *output) continue;
    section.Wrong(key, fmt::format("{} in \"{}\", so that {} * ({}) is in {}; found \"{}\"",
                                   terms[i].parameter, SiUnitName(*output / units[i].dimension),
                                   terms[i].parameter, terms[i].expression, output_unit, terms[i].unit));
  }
}

/// The first place where an expression reads a name outside of ddt(...).
std::optional<std::size_t> LevelOf(const std::string& name, const ExpressionNode& node) {
  if (node.kind == ExpressionNode::Kind::kCall && node.text == "ddt") return {};
  if (node.kind == ExpressionNode::Kind::kName && node.text == name) return node.at;
  std::optional<std::size_t> first;
  for (const Expression& arg : node.args)
    if (const auto at = LevelOf(name, *arg); at && (!first || *at < *first)) first = at;
  return first;
}

/// An output that is a signal must not explain itself: its term, in the balance or in an effect, would take everything.
void RefuseOutputAsTerm(TableReader& section, const std::vector<TermSpec>& terms, const std::string& output) {
  const auto whole = ParseExpression(output);
  if (!whole || (*whole)->kind != ExpressionNode::Kind::kName) return;
  const std::string& name = (*whole)->text;
  for (const TermSpec& term : terms) {
    const auto tree = ParseExpression(term.expression);
    const auto at = tree ? LevelOf(name, **tree) : std::nullopt;
    if (!at) continue;
    const toml::node* text = section.Table("terms")->get(term.parameter);
    if (const toml::table* details = text->as_table()) text = details->get("expression");
    ExpressionProblem(section, *text, term.parameter,
                      {*at, Tell("{} is the output itself, and would explain all of it",
                                 "{} ist der Ausgang selbst und würde ihn ganz erklären", name)});
  }
}

void ReadBalance(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("balance");
  if (table == nullptr) {
    if (KindOf(machine).own_library)
      file.Problem("model \"" + machine.model + "\" needs a section [balance] with output and terms");
    return;
  }
  TableReader section(*table, "balance", file.problems());
  section.AllowOnly(MachineFileKeys("balance"));
  const ExpressionNames names = ExpressionNamesOf(machine);
  ReadOutput(section, names, machine.balance);
  std::vector<ExpressionUnit> units;
  machine.balance.terms = ReadTerms(section, "terms", names, units);
  CheckTermUnits(section, "terms", machine.balance.terms, units, machine.balance.unit);
  RefuseOutputAsTerm(section, machine.balance.terms, machine.balance.output);
  if (section.Has("derived"))
    machine.balance.derived = ReadTerms(section, "derived", NamesForDerived(machine), units);
  if (machine.balance.terms.size() > kMaxParameters)
    section.Problem(fmt::format("{} terms, at most {} can be fitted at once", machine.balance.terms.size(),
                                kMaxParameters));
  if (machine.balance.derived.size() > kMaxDerived)
    section.Problem(
        fmt::format("{} derived parameters, at most {}", machine.balance.derived.size(), kMaxDerived));
}

void ReadEffects(TableReader& file, Machine& machine) {
  if (!file.Has("effect")) return;
  const toml::array* list = file.Node("effect")->as_array();
  if (list == nullptr || !list->is_homogeneous<toml::table>()) {
    file.Wrong("effect", "sections [[effect]] with two brackets");
    return;
  }
  std::set<std::string> ids;
  for (const toml::node& effect : *list) {
    TableReader section(*effect.as_table(), "effect", file.problems());
    ReadEffect(section, ids, machine);
    RefuseOutputAsTerm(section, machine.user_effects.back().terms, machine.balance.output);
  }
}

}  // namespace hydroscope
