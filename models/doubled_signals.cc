#include "models/doubled_signals.h"

#include "models/source_kind.h"

namespace hydroscope {
namespace {

bool FromOnePlace(const Machine& machine, const SignalSpec& a, const SignalSpec& b) {
  if (!a.origin || !b.origin || a.origin->part() != b.origin->part()) return false;
  const SourceKind* kind = FindSourceKind(a.origin->part());
  return kind->overlap == nullptr ? *a.origin == *b.origin : kind->overlap(machine, a, b);
}

}  // namespace

std::vector<DoubledSignals> DoubledSignalsOf(const Machine& machine) {
  std::vector<DoubledSignals> doubled;
  for (int second = 1; second < std::ssize(machine.signals); ++second)
    for (int first = 0; first < second; ++first) {
      const SignalSpec &a = machine.signals[first], &b = machine.signals[second];
      if (!a.column.empty() && a.column == b.column)
        doubled.push_back(
            {first, second, false,
             Tell("{} and {} both read column '{}': unless that is meant, give each its own in [signals]",
                  "{} und {} lesen beide Spalte '{}': wenn das nicht so gemeint ist, "
                  "in [signals] jedem seine eigene geben",
                  a.name, b.name, a.column)});
      if (FromOnePlace(machine, a, b)) {
        const SourceKind& kind = *FindSourceKind(a.origin->part());
        doubled.push_back(
            {first, second, true,
             Tell(
                 "{} and {} come from one place ({}; {}): unless that is meant, give each its own in [signals]",
                 "{} und {} kommen von derselben Stelle ({}; {}): wenn das nicht so gemeint ist, "
                 "in [signals] jedem seine eigene geben",
                 a.name, b.name, kind.write_origin(*a.origin), kind.write_origin(*b.origin))});
      }
    }
  return doubled;
}

}  // namespace hydroscope
