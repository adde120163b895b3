#pragma once

#include <cstdint>
#include <string>

#include "core/result.h"
#include "models/machine.h"

namespace hydroscope {

/// Identifies a log by its size and the CRC-32 of three chunks of 64 KiB (beginning, middle, end): as good as
/// a hash of the whole file for telling recordings apart, and a log is not read twice for it.
struct LogFingerprint {
  std::uint64_t size = 0;  ///< bytes
  std::uint32_t head = 0, middle = 0, tail = 0;

  /// "size-head-middle-tail", the CRCs in hex.
  std::string Text() const;
  bool operator==(const LogFingerprint&) const = default;
};

/// Errors: the file cannot be read.
Result<LogFingerprint> FingerprintLog(const std::string& path);

/// The log behind `path` begins with everything the log of `earlier` held, as far as the fingerprint tells:
/// the same recording, continued. False if they are equal.
Result<bool> Continues(const std::string& path, const LogFingerprint& earlier);

/// Everything but the log that the strokes of a replay depend on: machine file without name, description,
/// limits and history of the model, and the layout of the estimator's state. `state_layout` is that of Pipeline::SaveState.
std::string FingerprintSettings(const Machine& machine, const std::string& state_layout);

/// Fingerprint of a run as Database::BeginRun takes it: "log/settings".
struct RunFingerprint {
  LogFingerprint log;
  std::string settings;

  std::string Text() const { return log.Text() + "/" + settings; }
  /// False if `text` was not written by Text().
  static bool Parse(const std::string& text, RunFingerprint& out);
};

}  // namespace hydroscope
