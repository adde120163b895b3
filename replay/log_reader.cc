#include "replay/log_reader.h"

#include <filesystem>

#include "core/told_error.h"
#include "replay/byte_source.h"
#include "replay/copied_rows.h"
#include "replay/csv_reader.h"
#include "replay/even_rows.h"
#include "replay/held_rows.h"
#include "replay/held_signals.h"
#include "replay/mat_reader.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsOfHead = 1000;

bool IsText(const std::string&) { return true; }

Result<std::unique_ptr<LogReader>> OpenText(const std::string& path, const Machine& machine) {
  auto source = TRY(OpenFileSource(path));
  return CsvReader::Open(std::move(source), machine, path);
}

Result<std::unique_ptr<LogReader>> OpenMat(const std::string& path, const Machine& machine) {
  return MatReader::Open(path, machine);
}

/// A format of logs; the first one that recognises a file reads it.
struct Format {
  bool (*recognises)(const std::string& path);
  Result<std::unique_ptr<LogReader>> (*open)(const std::string& path, const Machine& machine);
};
constexpr Format kFormats[] = {
    {IsMatFile, OpenMat},
    {IsText, OpenText},
};

Result<std::unique_ptr<LogReader>> OpenStamped(const std::string& path, const Machine& machine) {
  for (const Format& format : kFormats)
    if (format.recognises(path)) return format.open(path, machine);
  return BadInput(Tell("{}: no format of logs that is known", "{}: kein bekanntes Log-Format", path));
}

/// What can be read only once keeps its stamps.
bool CanBeReadAgain(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

}  // namespace

Result<std::unique_ptr<LogReader>> OpenLog(const std::string& path, const Machine& machine) {
  auto log = OpenStamped(path, machine);
  if (!log || machine.log.time_column.empty() || !CanBeReadAgain(path)) return log;
  SampleBlock head;
  if (const auto rows = (*log)->Read(head, kRowsOfHead); !rows) return OpenStamped(path, machine);
  const auto held = FindHeldRows(head, machine);
  const auto slow = held ? std::nullopt : FindHeldSignals(head, machine);
  const auto copied = held ? std::nullopt : FindCopiedRows(head);
  const auto open = [&] {
    auto again = OpenStamped(path, machine);
    if (again && held) again = WithoutHeldRows(std::move(*again), *held);
    if (again && copied) again = WithoutCopiedRows(std::move(*again), *copied);
    return again;
  };
  std::optional<EvenRows> even;
  if (held || copied || MayBeEvenRows(head))
    if (auto whole = open())
      if (auto found = FindEvenRows(**whole)) even = std::move(*found);
  log = open();
  if (log && even) log = WithEvenTimes(std::move(*log), std::move(*even));
  if (log && slow) log = WithDrawnSignals(std::move(*log), *slow);
  return log;
}

}  // namespace hydroscope
