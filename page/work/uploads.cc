#include "page/work/uploads.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/told_error.h"
#include "page/api_arguments.h"

namespace hydroscope {

Uploads::Uploads(std::string folder) : folder_(std::move(folder)) {
  std::filesystem::create_directory(folder_);
}

std::string Uploads::NewFile() { return fmt::format("{}/.{}", folder_, ++made_); }

Result<KeptFile> Uploads::Keep(const std::string& file, const std::string& name) {
  const std::string plain = PlainFileName(name);
  if (plain.empty())
    return BadInput(Told("name: expected the name of the log, such as press.csv",
                         "Name: erwartet der Name des Logs, zum Beispiel press.csv"));
  const std::string own = fmt::format("{}/{}", folder_, ++kept_);
  const KeptFile kept(new std::string(own + "/" + plain), [own](const std::string* path) {
    std::error_code ignored;
    std::filesystem::remove_all(own, ignored);
    delete path;
  });
  std::error_code failure;
  std::filesystem::create_directory(own, failure);
  if (!failure) std::filesystem::rename(file, *kept, failure);
  if (failure)
    return InternalError(Tell("the upload cannot be kept: {}", "die Datei kann nicht aufbewahrt werden: {}",
                              failure.message()));
  return kept;
}

}  // namespace hydroscope
