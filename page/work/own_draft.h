#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/result.h"
#include "models/machine.h"
#include "page/work/own_effect.h"
#include "page/work/term_course.h"

namespace hydroscope {

/// A machine of one's own whose balance is being written: what its expressions can name, and a stroke to draw them over.
class OwnDraft {
 public:
  void Take(const Machine& machine);
  void Forget() { *this = {}; }
  /// Its machine file without what is being written (TextWithoutBalance).
  const std::string& text() const { return text_; }
  /// `stroke` is of the draft that had this text.
  void Draw(const std::string& text, std::shared_ptr<const TermStroke> stroke);
  /// TermStroke::Course; null where nothing is drawn yet. Error: what is wrong with the expression.
  Result<nlohmann::json> Look(const OwnEffect& term) const;

 private:
  Machine machine_;
  std::string text_;  ///< "" = no machine of one's own
  std::shared_ptr<const TermStroke> stroke_;
};

}  // namespace hydroscope
