#pragma once

#include <cerrno>
#include <cstring>
#include <string>

#include "core/told_error.h"

namespace hydroscope {

/// That a file cannot be written, why, and what to do. `error` is errno of the write or 0 if it is not known. Where the system
/// has no room or fails the kind is kInternal, where the name or its folder is wrong kBadInput.
inline tl::unexpected<Error> CannotWrite(const std::string& path, int error = errno) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return InternalError(Tell("cannot write {}: the disk is full; make room there",
                                "{} kann nicht geschrieben werden: die Platte ist voll; bitte Platz schaffen",
                                path));
    case EFBIG:
      return InternalError(Tell("cannot write {}: files may not grow so large here (`ulimit -f`)",
                                "{} kann nicht geschrieben werden: so groß dürfen Dateien hier nicht werden "
                                "(`ulimit -f`)",
                                path));
    case EIO:
      return InternalError(Tell("cannot write {}: the disk reports an error",
                                "{} kann nicht geschrieben werden: die Platte meldet einen Fehler", path));
    case ENOENT:
    case ENOTDIR:
      return BadInput(Tell("cannot write {}: there is no such folder",
                           "{} kann nicht geschrieben werden: den Ordner gibt es nicht", path));
    case EISDIR:
      return BadInput(
          Tell("cannot write {}: it is a folder; give the name of a file in it",
               "{} kann nicht geschrieben werden: das ist ein Ordner; bitte eine Datei darin nennen", path));
    case EACCES:
    case EPERM:
    case EROFS:
      return BadInput(Tell(
          "cannot write {}: not allowed here; give another folder",
          "{} kann nicht geschrieben werden: hier nicht erlaubt; bitte einen anderen Ordner nennen", path));
    default:
      return BadInput(Tell("cannot write {}: check that the folder exists and the disk is not full",
                           "{} kann nicht geschrieben werden: gibt es den Ordner, und hat die Platte Platz?",
                           path));
  }
}

}  // namespace hydroscope
