#pragma once

#include "core/result.h"
#include "core/told.h"

namespace hydroscope {

/// An error that people meet on the page, in its languages: BadInput(Tell("...", "...", values ...)).
inline tl::unexpected<Error> BadInput(const Told& told) {
  return tl::unexpected(Error{ErrorKind::kBadInput, told.english, told.german});
}

inline tl::unexpected<Error> InternalError(const Told& told) {
  return tl::unexpected(Error{ErrorKind::kInternal, told.english, told.german});
}

/// The text of an error, as far as it is told.
inline Told ToldOf(const Error& error) { return {error.text, error.german}; }

}  // namespace hydroscope
