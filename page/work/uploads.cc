#include "page/work/uploads.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/told_error.h"
#include "page/api_arguments.h"

namespace hydroscope {
namespace {

constexpr double kGb = 1 << 30;
constexpr std::int64_t kLeftFree = 200 << 20;  ///< bytes that others need, the database of a service say

}  // namespace

Uploads::Uploads(std::string folder, std::int64_t most) : folder_(std::move(folder)), most_(most) {
  std::filesystem::create_directory(folder_);
}

Status Uploads::MayTake(std::int64_t bytes) const {
  std::error_code ignored;
  std::int64_t used = 0;
  for (auto file = std::filesystem::recursive_directory_iterator(folder_, ignored);
       file != std::filesystem::recursive_directory_iterator(); file.increment(ignored))
    if (const std::uintmax_t size = file->file_size(ignored); !ignored)
      used += static_cast<std::int64_t>(size);
  if (used + bytes > most_)
    return BadInput(Tell(
        "the logs on the page would take {:.1f} GB together, more than the {:.1f} GB that it has; those that nobody works on any "
        "more are removed, so work with fewer at a time",
        "die Logs der Seite wären zusammen {:.1f} GB, mehr als die {:.1f} GB, die sie hat; solche, mit denen niemand mehr "
        "arbeitet, werden entfernt, also mit weniger auf einmal arbeiten",
        static_cast<double>(used + bytes) / kGb, static_cast<double>(most_) / kGb));
  const auto disk = std::filesystem::space(folder_, ignored);
  if (!ignored && static_cast<std::int64_t>(disk.available) < bytes + kLeftFree)
    return BadInput(
        Tell("the upload does not fit onto the disk of {}: {:.1f} GB are free there; make room",
             "die Datei passt nicht auf die Platte von {}: dort sind {:.1f} GB frei; Platz schaffen", folder_,
             static_cast<double>(disk.available) / kGb));
  return {};
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
