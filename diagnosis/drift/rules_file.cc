#include <toml++/toml.h>

#include <fstream>
#include <set>
#include <sstream>

#include "core/contains.h"
#include "core/told_error.h"
#include "diagnosis/drift/default_rules.h"
#include "diagnosis/drift/rules.h"
#include "models/machine_file/table.h"

namespace hydroscope::drift {
namespace {

const std::vector<std::string>& Keys(const std::string& section) {
  for (const RuleSection& s : RuleFileSections())
    if (s.name == section) return s.keys;
  static const std::vector<std::string> none;
  return none;
}

/// A plain number is a share of the healthy value; { value, unit } is absolute, divided by `per`.
void ReadChange(TableReader& table, const toml::table& source, const char* key, double per,
                ChangeSpec& change) {
  if (!table.Has(key)) return;
  change.relative = !source.get(key)->is_table();
  table.Number(key, change.value,
               {change.relative ? "1" : "", {}, true, 0, std::numeric_limits<double>::infinity(), true});
  if (!change.relative) change.value /= per;
}

void ReadMonitor(const toml::table& source, FileProblems& problems, RuleBook& book) {
  TableReader table(source, "monitor", problems);
  table.AllowOnly(Keys("monitor"));
  table.Integer("commissioning", book.commissioning, 100);
  if (const auto choice = table.Choice("freeze", {"automatic", "command"})) book.automatic = *choice == 0;
  table.Number("minimum_temperature", book.minimum_temperature, {"K", "degC", false, 200, 400});
  table.Integer("warn_delay", book.warn_delay, 1);
  table.Integer("clear_delay", book.clear_delay, 1);
  table.Number("deadband", book.deadband, {"1", {}, false, 0});
}

void ReadWatch(const std::string& quantity, const toml::table& source, FileProblems& problems,
               RuleBook& book) {
  TableReader table(source, "watch." + quantity, problems);
  table.AllowOnly(Keys("watch.<quantity>"));
  WatchSpec watch;
  watch.quantity = quantity;
  double per = 1.0;
  table.Number("at", per, {"Pa", {}, false, 0, std::numeric_limits<double>::infinity(), true});
  ReadChange(table, source, "change", per, watch.smallest);
  ReadChange(table, source, "alarm_change", per, watch.alarm);
  table.Flag("only_upwards", watch.only_upwards);
  book.watches.push_back(std::move(watch));
}

void ReadWhen(const toml::table& source, const std::string& path, const std::vector<std::string>& quantities,
              FileProblems& problems, Rule& rule) {
  TableReader when(source, path, problems);
  when.AllowOnly(quantities);
  for (const auto& entry : when.Entries())
    if (const auto choice = when.Choice(entry.key, {"up", "down", "any"}))
      rule.when[entry.key] = static_cast<Movement>(*choice);
}

void ReadRule(const toml::table& source, std::size_t number, const std::vector<std::string>& quantities,
              FileProblems& problems, RuleBook& book) {
  TableReader table(source, fmt::format("rule {}", number), problems);
  table.AllowOnly(Keys("rule"));
  Rule rule;
  table.Text("id", rule.id);
  table.Text("name", rule.name.english);
  table.Text("guidance", rule.guidance.english);
  if (const toml::table* german = table.Table("german")) {
    TableReader words(*german, fmt::format("rule {}.german", number), problems);
    words.AllowOnly(Keys("rule.german"));
    words.Text("name", rule.name.german);
    words.Text("guidance", rule.guidance.german);
  }
  for (const char* key : {"id", "name", "guidance", "when"})
    if (!table.Has(key)) table.Problem(fmt::format("{} is missing", key));
  if (const toml::table* when = table.Table("when"))
    ReadWhen(*when, fmt::format("rule {}.when", number), quantities, problems, rule);
  if (table.Has("when") && rule.when.empty())
    table.Wrong("when", "at least one movement, e.g. { K = \"down\" }");
  table.Texts("may", rule.may);
  for (const std::string& name : rule.may)
    if (!Contains(quantities, name))
      table.Wrong("may", fmt::format("{}watched quantities: {}", DidYouMean(name, quantities).english,
                                     Listed(quantities)));
  if (const auto choice = table.Choice("severity", {"advisory", "warning", "alarm"}))
    rule.severity = static_cast<RuleSeverity>(*choice);
  table.Integer("axes", rule.axes, 1);
  table.Integer("within", rule.within, 1);
  for (const Rule& other : book.rules)
    if (other.id == rule.id) table.Wrong("id", "an id no other rule has");
  book.rules.push_back(std::move(rule));
}

}  // namespace

const std::vector<RuleSection>& RuleFileSections() {
  static const std::vector<RuleSection> sections = {
      {"", {"monitor", "watch", "rule"}},
      {"monitor",
       {"commissioning", "freeze", "minimum_temperature", "warn_delay", "clear_delay", "deadband"}},
      {"watch.<quantity>", {"change", "alarm_change", "at", "only_upwards"}},
      {"rule", {"id", "name", "guidance", "german", "when", "may", "severity", "axes", "within"}},
      {"rule.german", {"name", "guidance"}},
  };
  return sections;
}

Result<RuleBook> ParseRules(const std::string& text, const std::string& origin) {
  toml::table root;
  try {
    root = toml::parse(text, origin);
  } catch (const toml::parse_error& error) {
    return BadInput("{}:{}: {}", origin, error.source().begin.line, error.description());
  }
  FileProblems problems(origin);
  RuleBook book;
  TableReader top(root, "", problems);
  top.AllowOnly(Keys(""));
  if (const toml::table* monitor = top.Table("monitor")) ReadMonitor(*monitor, problems, book);
  if (const toml::table* watch = top.Table("watch")) {
    TableReader watches(*watch, "watch", problems);
    for (const auto& entry : watches.Entries())
      if (const toml::table* one = watches.Table(entry.key)) ReadWatch(entry.key, *one, problems, book);
  }
  std::vector<std::string> quantities;
  for (const WatchSpec& w : book.watches) quantities.push_back(w.quantity);
  const toml::array* rules = root.get_as<toml::array>("rule");
  if (top.Has("rule") && (rules == nullptr || !(rules->empty() || rules->is_array_of_tables())))
    top.Wrong("rule", "tables, each of them under [[rule]]");
  else if (rules != nullptr)
    for (std::size_t i = 0; i < rules->size(); ++i)
      ReadRule(*rules->get_as<toml::table>(i), i + 1, quantities, problems, book);
  if (problems.any()) return tl::unexpected(problems.ToError());
  return book;
}

Result<RuleBook> LoadRules(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return BadInput(
        Tell("cannot read the rules file {}", "die Regeldatei {} kann nicht gelesen werden", path));
  std::stringstream text;
  text << file.rdbuf();
  Result<RuleBook> book = ParseRules(text.str(), path);
  if (book) book->file = path;
  return book;
}

const RuleBook& DefaultRules() {
  // A test parses the very file, so the text is known to be right.
  static const RuleBook book = ParseRules(kDefaultRules, "built-in rules").value();
  return book;
}

}  // namespace hydroscope::drift
