#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// An effect that a person writes on the page: size * expression over the signals of the machine, in SI.
struct OwnEffect {
  std::string id;            ///< letters, digits, _
  std::string expression;    ///< docs/user_physics.md
  std::string unit;          ///< SI, of the size; "" = follows from the expression
  bool not_negative = true;  ///< physics allows no negative size
  bool keep = false;         ///< into the machine file, not looked at only
  std::string output = {};   ///< of a balance that is being written: what it is of, which no term may read
};
/// Of {"id", "expression", "unit", "not_negative", "keep", "output"}. Errors as ParseWorkRequest.
Result<OwnEffect> ParseOwnEffect(const std::string& body);

/// Name of the size of every effect written on the page.
inline constexpr const char* kOwnEffectSize = "k";
/// Error: an effect cannot be called so.
Status CheckOwnEffectId(const std::string& id);

/// The text of a machine file with the effect in its library. Error: what is wrong with the expression, with a mark
/// under the place.
Result<std::string> WithOwnEffect(const std::string& machine_text, const OwnEffect& effect);

}  // namespace hydroscope
