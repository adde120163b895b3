#include "models/machine_file/table.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/contains.h"
#include "core/units.h"
#include "models/machine_file/keys.h"

namespace hydroscope {
namespace {

/// The value as it stands in the file, cut to a readable length.
std::string Shown(const toml::node& node) {
  if (node.is_table()) return "{...} (a table)";
  if (node.is_array()) return "[...] (a list)";
  std::ostringstream text;
  if (const auto* string = node.as_string())
    text << string->get();
  else
    node.visit([&](const auto& value) { text << value; });
  std::string shown = text.str();
  if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
  if (node.is_string()) return fmt::format("\"{}\" (text)", shown);
  if (node.is_boolean()) return shown + " (true/false)";
  if (node.is_number()) return shown;
  return shown + " (date or time)";
}

std::string RangeText(const Quantity& quantity, std::string_view si) {
  const std::string unit = si.empty() || si == "1" ? "" : fmt::format(" {}", si);
  if (std::isfinite(quantity.low) && std::isfinite(quantity.high))
    return fmt::format("a number from {} to {}{}", quantity.low, quantity.high, unit);
  if (std::isfinite(quantity.low))
    return fmt::format("a number {} {}{}", quantity.above_low ? "greater than" : "not less than",
                       quantity.low, unit);
  return "a number";
}

std::vector<std::string> UnitsOf(std::string_view si) {
  std::vector<std::string> names;
  for (const std::string& name : UnitNames())
    if (si.empty() || FindUnit(name)->si == si) names.push_back(name);
  if (names.empty() && !si.empty()) names.emplace_back(si);
  return names;
}

}  // namespace

void FileProblems::Add(const toml::source_region& where, const Told& text, std::size_t column) {
  const auto trimmed = [](const std::string& said) { return said.substr(0, said.find_last_not_of(' ') + 1); };
  problems_.push_back({where.begin.line, column, {trimmed(text.english), trimmed(text.german)}});
}

Error FileProblems::ToError() const {
  auto problems = problems_;
  std::stable_sort(problems.begin(), problems.end(),
                   [](const auto& a, const auto& b) { return a.line < b.line; });
  Told all;
  bool german = true;
  for (std::size_t i = 0; i < std::min(problems.size(), kReported); ++i) {
    const Problem& problem = problems[i];
    const std::string place = fmt::format("{}{}:{}{}: ", i == 0 ? "" : "\n", origin_, problem.line,
                                          problem.column > 0 ? fmt::format(":{}", problem.column) : "");
    all.english += place + problem.text.english;
    all.german += place + problem.text.german;
    german = german && !problem.text.german.empty();
  }
  if (problems.size() > kReported) {
    const Told more = Tell("\n... and {} more", "\n... und {} weitere", problems.size() - kReported);
    all = {all.english + more.english, all.german + more.german};
  }
  return Error{ErrorKind::kBadInput, all.english, german ? all.german : ""};
}

std::optional<FileUnit> FindFileUnit(std::string_view name) {
  if (const auto unit = FindUnit(name)) return FileUnit{unit->scale, unit->offset, std::string(unit->si)};
  return std::nullopt;
}

Told DidYouMean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string nearest = Nearest(name, candidates);
  return nearest.empty() ? Told() : Tell("did you mean \"{}\"? ", "war \"{}\" gemeint? ", nearest);
}

std::string Listed(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

TableReader::TableReader(const toml::table& table, std::string path, FileProblems& problems)
    : table_(table), path_(std::move(path)), problems_(problems) {}

std::vector<TableReader::Entry> TableReader::Entries() const {
  std::vector<Entry> entries;
  for (const auto& [key, node] : table_) entries.push_back({std::string(key.str()), &node, key.source()});
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::pair(a.where.begin.line, a.where.begin.column) <
           std::pair(b.where.begin.line, b.where.begin.column);
  });
  return entries;
}

void TableReader::AllowOnly(const std::vector<std::string>& known) {
  for (const Entry& entry : Entries()) {
    if (Contains(known, entry.key)) continue;
    Problem(entry.where, fmt::format("unknown {} \"{}\"; {}known here: {}", path_.empty() ? "section" : "key",
                                     entry.key, DidYouMean(entry.key, known).english, Listed(known)));
  }
}

void TableReader::Text(std::string_view key, std::string& value) {
  if (!Has(key)) return;
  if (const auto* text = table_.get_as<std::string>(key))
    value = text->get();
  else
    Wrong(key, "a text in quotes");
}

void TableReader::Flag(std::string_view key, bool& value) {
  if (!Has(key)) return;
  if (const auto* flag = table_.get_as<bool>(key))
    value = flag->get();
  else
    Wrong(key, "true or false");
}

void TableReader::Integer(std::string_view key, int& value, int low, int high) {
  if (!Has(key)) return;
  const auto* number = table_.get_as<std::int64_t>(key);
  if (number != nullptr && number->get() >= low && number->get() <= high)
    value = static_cast<int>(number->get());
  else if (high == std::numeric_limits<int>::max())
    Wrong(key, fmt::format("a whole number not less than {}", low));
  else
    Wrong(key, fmt::format("a whole number from {} to {}", low, high));
}

void TableReader::Integer(std::string_view key, std::optional<int>& value, int low, int high) {
  if (Has(key)) Integer(key, value.emplace(low), low, high);
}

std::optional<std::size_t> TableReader::Choice(std::string_view key,
                                               const std::vector<std::string>& choices) {
  if (!Has(key)) return std::nullopt;
  std::string suggestion;
  if (const auto* text = table_.get_as<std::string>(key)) {
    const auto found = std::find(choices.begin(), choices.end(), text->get());
    if (found != choices.end()) return found - choices.begin();
    suggestion = DidYouMean(text->get(), choices).english;
  }
  std::string quoted;
  for (const std::string& choice : choices)
    quoted += fmt::format("{}\"{}\"", quoted.empty() ? "" : ", ", choice);
  Wrong(key, fmt::format("one of {}{}{}", quoted, suggestion.empty() ? "" : "; ", suggestion));
  return std::nullopt;
}

void TableReader::Texts(std::string_view key, std::vector<std::string>& values) {
  if (!Has(key)) return;
  const toml::array* list = table_.get_as<toml::array>(key);
  std::vector<std::string> texts;
  if (list != nullptr)
    for (const toml::node& node : *list)
      if (node.is_string()) texts.push_back(node.as_string()->get());
  if (list == nullptr || texts.size() != list->size())
    Wrong(key, "a list of texts, e.g. [\"internal_leakage\"]");
  else
    values = texts;
}

void TableReader::Number(std::string_view key, double& value, const Quantity& quantity) {
  std::optional<double> number;
  Number(key, number, quantity);
  if (number) value = *number;
}

void TableReader::Number(std::string_view key, std::optional<double>& value, const Quantity& quantity) {
  if (!Has(key)) return;
  const auto number = Convert(key, *table_.get(key), quantity);
  if (!number) return;
  const bool too_low = quantity.above_low ? *number <= quantity.low : *number < quantity.low;
  if (too_low || *number > quantity.high)
    Wrong(key, RangeText(quantity, quantity.si));
  else
    value = number;
}

std::optional<double> TableReader::Convert(std::string_view key, const toml::node& node,
                                           const Quantity& quantity) {
  const toml::node* number = &node;
  std::string unit(quantity.default_unit.empty() ? quantity.si : quantity.default_unit);
  if (const toml::table* table = node.as_table()) {
    TableReader inner(*table, path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key), problems_);
    inner.AllowOnly(MachineFileKeys("<quantity>"));
    inner.UnitName("unit", unit, quantity.si);
    number = table->get("value");
    if (number == nullptr) {
      inner.Problem("value is missing; write e.g. { value = 1.5, unit = \"bar\" }");
      return std::nullopt;
    }
  }
  std::optional<double> raw;
  if (const auto* whole = number->as_integer()) raw = static_cast<double>(whole->get());
  if (const auto* fraction = number->as_floating_point()) raw = fraction->get();
  if (!raw || !std::isfinite(*raw)) {
    Wrong(key, fmt::format("a finite number{}", unit.empty() || unit == "1" ? "" : " in " + unit));
    return std::nullopt;
  }
  const FileUnit si = FindFileUnit(unit).value_or(FileUnit{});
  const double converted = *raw * si.scale + (quantity.difference ? 0.0 : si.offset);
  if (!std::isfinite(converted)) {
    Wrong(key, "a number that stays finite in SI units");
    return std::nullopt;
  }
  return converted;
}

void TableReader::UnitName(std::string_view key, std::string& value, std::string_view si) {
  if (!Has(key)) return;
  const auto* text = table_.get_as<std::string>(key);
  const auto unit = text == nullptr ? std::nullopt : FindFileUnit(text->get());
  if (unit && (si.empty() || unit->si == si)) {
    value = text->get();
    return;
  }
  const std::vector<std::string> candidates = UnitsOf(si);
  const std::string suggestion = text == nullptr || unit ? "" : DidYouMean(text->get(), candidates).english;
  Wrong(key, fmt::format("{}; {}units: {}",
                         unit ? fmt::format("a unit of the same quantity as {}", si) : "a known unit",
                         suggestion, Listed(candidates)));
}

const toml::table* TableReader::Table(std::string_view key) {
  if (!Has(key)) return nullptr;
  const toml::table* table = table_.get_as<toml::table>(key);
  if (table == nullptr) Wrong(key, path_.empty() ? fmt::format("a section [{}]", key) : "a table { ... }");
  return table;
}

void TableReader::Wrong(std::string_view key, const std::string& expected) {
  const toml::node* node = table_.get(key);
  Problem(Where(key), fmt::format("{} = {}: expected {}", key, node ? Shown(*node) : "nothing", expected));
}

void TableReader::Problem(const std::string& text) { Problem(table_.source(), text); }

void TableReader::Problem(const toml::source_region& where, const Told& text, std::size_t column) {
  const auto placed = [&](const std::string& said) {
    return path_.empty() || said.empty() ? said : fmt::format("[{}] {}", path_, said);
  };
  problems_.Add(where, {placed(text.english), placed(text.german)}, column);
}

toml::source_region TableReader::Where(std::string_view key) const {
  const auto found = table_.find(key);
  return found == table_.end() ? table_.source() : found->first.source();
}

}  // namespace hydroscope
