#include "page/work/own_draft.h"

#include <nlohmann/json.hpp>

#include "page/first_run/log_proposal.h"

namespace hydroscope {

void OwnDraft::Take(const Machine& machine) {
  std::string text = TextWithoutBalance(machine);
  if (text == text_) return;
  machine_ = machine;
  text_ = std::move(text);
  stroke_.reset();
}

void OwnDraft::Draw(const std::string& text, std::shared_ptr<const TermStroke> stroke) {
  if (!text.empty() && text == text_) stroke_ = std::move(stroke);
}

Result<nlohmann::json> OwnDraft::Look(const OwnEffect& term) const {
  const auto text = TRY(WithOwnEffect(TextWithoutBalance(machine_, term.output), term));
  const auto machine = TRY(ParseMachine(text, "machine file"));
  return stroke_ == nullptr ? nlohmann::json() : stroke_->Course(machine, machine.user_effects.back());
}

}  // namespace hydroscope
