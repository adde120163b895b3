#include "page/watch/learn_request.h"

#include "core/told_error.h"
#include "page/http/json_arguments.h"

namespace hydroscope {

Result<LearnRequest> ParseLearnRequest(const std::string& body) {
  const auto strokes = TRY(ParseStrokeStretch(body));
  const auto json = TRY(ParseObject(body));
  const auto only_look = FlagOf(json, "only_look"), insist = FlagOf(json, "insist");
  for (const auto* flag : {&only_look, &insist})
    if (!*flag) return tl::unexpected(flag->error());
  const auto user = TextOf(json, "user"), comment = TextOf(json, "comment", kLongestComment);
  for (const auto* text : {&user, &comment})
    if (!*text) return tl::unexpected(text->error());
  if (*insist && comment->find_first_not_of(" \t\n") == std::string::npos)
    return BadInput(
        Told("comment: expected why these strokes are learned in spite of what speaks against them",
             "Bemerkung: erwartet: warum diese Hübe gelernt werden, obwohl etwas dagegen spricht"));
  return LearnRequest{strokes, *only_look, *insist, *user, *comment};
}

}  // namespace hydroscope
