#pragma once

#include <string>

#include "page/api_arguments.h"

namespace hydroscope {

/// Strokes that a person takes for those of the healthy machine.
struct LearnRequest {
  StrokeStretch strokes;
  bool only_look = false;  ///< tell what speaks against it, learn nothing
  bool insist = false;     ///< learn in spite of what refuses
  std::string user;        ///< "" = who is logged in
  std::string comment;     ///< why
};
/// Of {"machine", "first", "last", "only_look", "insist", "user", "comment"}. Who insists says why. Errors name the key and
/// what was expected.
Result<LearnRequest> ParseLearnRequest(const std::string& body);

}  // namespace hydroscope
