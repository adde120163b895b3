#include <fmt/format.h>

#include "core/contains.h"
#include "core/limits.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

struct Form {
  Condition::Of of;
  std::string_view open, close;
};
constexpr Form kForms[] = {
    {Condition::Of::kMeanRate, "abs(ddt(", "))"},
    {Condition::Of::kLargest, "max(", ")"},
    {Condition::Of::kMean, "", ""},
};

/// "max(p)" into signal and what is taken of it.
void ReadForm(const std::string& text, Condition& condition) {
  for (const Form& form : kForms) {
    if (!text.starts_with(form.open) || !text.ends_with(form.close)) continue;
    condition.of = form.of;
    condition.signal = text.substr(form.open.size(), text.size() - form.open.size() - form.close.size());
    return;
  }
}

}  // namespace

std::string ConditionText(const Condition& condition) {
  for (const Form& form : kForms)
    if (form.of == condition.of) return fmt::format("{}{}{}", form.open, condition.signal, form.close);
  return condition.signal;
}

void ReadConditions(TableReader& file, Machine& machine) {
  const toml::table* table = file.Table("conditions");
  if (table == nullptr) return;
  TableReader section(*table, "conditions", file.problems());
  std::vector<std::string> signals;
  for (const SignalSpec& signal : machine.signals) signals.push_back(signal.name);
  std::vector<std::string> taken;
  for (const Condition& condition : KindOf(machine).conditions) taken.push_back(condition.name);
  for (const TableReader::Entry& entry : section.Entries()) {
    Condition condition;
    condition.name = entry.key;
    condition.title = condition.vary = Told(entry.key, entry.key);
    std::string text;
    section.Text(entry.key, text);
    ReadForm(text, condition);
    const int signal = machine.SignalIndex(condition.signal);
    if (Contains(taken, entry.key))
      section.Problem(entry.where,
                      fmt::format("{} is a condition of every such machine; take another name", entry.key));
    if (signal < 0) {
      section.Problem(entry.where,
                      fmt::format("\"{}\": expected a signal, its speed \"abs(ddt(<signal>))\" or its "
                                  "largest value \"max(<signal>)\". {}",
                                  text, DidYouMean(condition.signal, signals).english));
      continue;
    }
    condition.unit = SiOf(machine.signals[static_cast<std::size_t>(signal)].unit);
    if (condition.of == Condition::Of::kMeanRate) condition.unit += "/s";
    machine.conditions.push_back(std::move(condition));
  }
  const std::size_t most = kMaxConditions - taken.size();
  if (machine.conditions.size() > most)
    section.Problem(fmt::format("{} conditions, at most {} can be stored", machine.conditions.size(), most));
}

}  // namespace hydroscope
