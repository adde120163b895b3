#include "page/work/machine_copy.h"

#include "core/told_error.h"
#include "host/text_file.h"
#include "host/text_sink.h"
#include "models/machine_kind.h"
#include "page/api_arguments.h"
#include "page/work/machine_versions.h"
#include "workbench/model/model_edit.h"

namespace hydroscope {
namespace {

std::string TextIn(const std::string& path) { return ReadTextFile(path).value_or(""); }

}  // namespace

Status MachineCopy::Take(const std::string& name, const std::string& text) {
  TRY(ParseMachine(text, name));
  const std::filesystem::path folder = folder_ / std::to_string(++taken_);
  std::filesystem::create_directory(folder);
  std::string plain = PlainFileName(name);
  if (!plain.ends_with(".toml")) plain += ".toml";
  TRY(WriteTextFile((folder / plain).string(), text));
  file_ = (folder / plain).string();
  target_.clear();
  saved_text_.clear();
  return {};
}

Status MachineCopy::TakeFile(const std::string& path) {
  TRY(LoadMachine(path));
  TRY(Take(std::filesystem::path(path).filename().string(), TextIn(path)));
  for (const KeptVersion& kept : KeptVersions(path))  // so that earlier versions can be gone back to
    std::filesystem::copy_file(
        kept.path, std::filesystem::path(file_).parent_path() / std::filesystem::path(kept.path).filename());
  target_ = path;
  saved_text_ = Text();
  return {};
}

void MachineCopy::Forget() {
  file_.clear();
  target_.clear();
  saved_text_.clear();
}

std::string MachineCopy::Text() const { return empty() ? "" : TextIn(file_); }

Status MachineCopy::Write(const std::string& text) { return WriteTextFile(file_, text); }

Result<std::string> MachineCopy::Save(const std::string& name) {
  const std::string text = Text();
  if (target_.empty()) {
    TRY(SaveAs(name, text));
    target_ = PlainFileName(name);
  } else if (text != saved_text_) {
    TRY(SaveBack());
  }
  saved_text_ = text;
  return std::filesystem::absolute(target_).string();
}

Status MachineCopy::SaveAs(const std::string& name, const std::string& text) {
  const std::string target = PlainFileName(name);
  if (target.empty() || !target.ends_with(".toml"))
    return BadInput(Tell("name: found '{}', expected the name of a machine file, such as press.toml",
                         "Name: gefunden '{}', erwartet: der Name einer Maschinendatei, etwa presse.toml",
                         name));
  if (std::filesystem::exists(target))
    return BadInput(Tell("{} is there already; choose another name",
                         "{} gibt es schon; bitte einen anderen Namen wählen",
                         std::filesystem::absolute(target).string()));
  return WriteTextFile(target, text);
}

Status MachineCopy::SaveBack() const {
  if (TextIn(target_) != saved_text_)
    return BadInput(
        Tell("{} was changed by somebody else meanwhile; download the machine file instead",
             "{} wurde inzwischen von jemand anderem geändert; stattdessen die Maschinendatei herunterladen",
             target_));
  const auto before = TRY(LoadMachine(target_));
  return PutVersion(target_, before.model_version, file_);
}

}  // namespace hydroscope
