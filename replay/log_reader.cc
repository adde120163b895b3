#include "replay/log_reader.h"

#include "replay/byte_source.h"
#include "replay/csv_reader.h"
#include "replay/mat_reader.h"

namespace hydroscope {

Result<std::unique_ptr<LogReader>> OpenLog(const std::string& path, const Machine& machine) {
  if (IsMatFile(path)) return MatReader::Open(path, machine);
  auto source = OpenFileSource(path);
  if (!source) return tl::unexpected(source.error());
  return CsvReader::Open(std::move(*source), machine, path);
}

}  // namespace hydroscope
