#include "models/expressions/general_laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "core/constants.h"
#include "models/expressions/columns.h"

namespace hydroscope {
namespace {

/// A law of one signal `a`, or of two, `a` and `b`, as people read it and as it is computed.
struct GeneralForm {
  const char* shown;
  const char* computed;
};
constexpr GeneralForm kOfOne[] = {{"{0}", "a"},
                                  {"{0}^2", "a^2"},
                                  {"{0}^3", "a^3"},
                                  {"{0}*abs({0})", "a*abs(a)"},
                                  {"sign({0})", "sign(a)"},
                                  {"sign({0})*sqrt(abs({0}))", "sign(a)*sqrt(abs(a))"}};
constexpr GeneralForm kOfTwo[] = {{"{0}*{1}", "a*b"}};
constexpr GeneralForm kAgainst[] = {{"{0}*sign({1})", "a*sign(b)"}, {"{0}^2*sign({1})", "a^2*sign(b)"}};

class LawMaker {
 public:
  explicit LawMaker(const ModelStructure& model) : model_(model) {}

  void Add(std::span<const GeneralForm> forms, int a, int b) {
    const std::map<std::string, int> channel_of = {{"a", a}, {"b", b}};
    for (const GeneralForm& form : forms) {
      const std::vector<ExpressionPart> parts = {{ParseExpression(form.computed).value(), nullptr}};
      auto ready = std::make_shared<const ExpressionParts>(parts, channel_of);
      Add(fmt::format(fmt::runtime(form.shown), model_.channel_names[static_cast<std::size_t>(a)],
                      model_.channel_names[static_cast<std::size_t>(b)]),
          FillOf(std::move(ready), model_.level_form));
    }
  }

  /// Rate of a channel, in a balance of levels.
  void AddRate(int channel) {
    const std::string& signal = model_.channel_names[static_cast<std::size_t>(channel)];
    Add(
        fmt::format("ddt({})", signal),
        [channel](const Stretch& s, double&, std::span<double> out) {
          const double* const x = s[channel];
          const int last = s.samples + s.after - 1;
          for (int k = 0; k < static_cast<int>(out.size()); ++k) {
            const int from = std::max(k - 1, -s.before), to = std::min(k + 1, last);
            out[static_cast<std::size_t>(k)] = to > from ? (x[to] - x[from]) / ((to - from) * s.period) : 0;
          }
        },
        signal);
  }

  std::vector<std::shared_ptr<const Effect>> Take() { return std::move(laws_); }

 private:
  void Add(std::string expression, Column::Fill column, std::string late_signal = "") {
    Effect law;
    law.late_signal = std::move(late_signal);
    law.id = "generic: " + expression;
    law.title = std::move(expression);
    law.generic = true;
    law.min = -kInfinity;
    law.max = law.typical = kInfinity;
    law.variant = [column = std::move(column)](const auto&) { return PlainVariant(column); };
    laws_.push_back(std::make_shared<const Effect>(std::move(law)));
  }

  const ModelStructure& model_;
  std::vector<std::shared_ptr<const Effect>> laws_;
};

}  // namespace

std::vector<std::shared_ptr<const Effect>> GeneralLaws(const ModelStructure& model,
                                                       const std::vector<int>& channels,
                                                       const std::vector<int>& late) {
  LawMaker laws(model);
  for (const int a : channels) laws.Add(kOfOne, a, a);
  for (std::size_t i = 0; i < channels.size(); ++i)
    for (std::size_t k = 0; k < channels.size(); ++k) {
      if (i < k) laws.Add(kOfTwo, channels[i], channels[k]);
      if (i != k) laws.Add(kAgainst, channels[i], channels[k]);
    }
  if (model.level_form)
    for (const int channel : late) laws.AddRate(channel);
  return laws.Take();
}

}  // namespace hydroscope
