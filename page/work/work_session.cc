#include "page/work/work_session.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/told_error.h"
#include "host/real_clock.h"
#include "host/text_file.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "page/first_run/log_picture.h"
#include "page/first_run/log_proposal.h"
#include "page/work/machine_info.h"
#include "page/work/machine_versions.h"
#include "page/work/valve_results.h"
#include "replay/log_head.h"
#include "workbench/model/model_edit.h"
#include "workbench/model/model_output.h"

namespace hydroscope {
namespace {

using Kind = WorkRequest::Kind;

const Told kNoLog = {"there is no log yet", "es gibt noch kein Log"};
const Told kNoMachineFile = {"there is no machine file yet", "es gibt noch keine Maschinendatei"};

std::string KeyOf(const std::string& kind, const std::string& about) {
  return about.empty() ? kind : kind + " " + about;
}

}  // namespace

WorkSession::WorkSession(std::vector<ExampleLog> examples, EventFeed& feed,
                         std::unique_ptr<ScratchFolder> folder, int niceness)
    : examples_(std::move(examples)),
      feed_(feed),
      folder_(std::move(folder)),
      uploads_(folder_->path() + "/uploads"),
      machine_(folder_->path() + "/machine"),
      jobs_(feed, niceness) {}

Result<std::unique_ptr<WorkSession>> WorkSession::Create(const std::vector<std::string>& logs,
                                                         const std::string& machine_file,
                                                         std::vector<ExampleLog> examples, EventFeed& feed,
                                                         int niceness) {
  auto folder = TRY(ScratchFolder::Make());
  std::unique_ptr<WorkSession> session(
      new WorkSession(std::move(examples), feed, std::move(folder), niceness));
  std::filesystem::create_directory(session->folder_->path() + "/machine");
  for (const std::string& log : logs) {
    const bool part = log.find('#') != log.npos;  // "press.db#cushion_1" is opened when it is read
    if (!part && !std::filesystem::exists(log))
      return BadInput(Tell("Log '{}' does not exist", "Log '{}' gibt es nicht", log));
    session->logs_.push_back({log, log});
  }
  if (!machine_file.empty()) TRY(session->machine_.TakeFile(machine_file));
  return session;
}

void WorkSession::ForgetResults() {
  ++generation_;
  results_.clear();
  strokes_.clear();
  pictures_.clear();
}

void WorkSession::Changed() { feed_.Publish(R"({"state":"changed"})"); }

Error WorkSession::WithoutFolder(const Error& error) const {
  return {error.kind, WithoutFolder(error.text), WithoutFolder(error.german)};
}

std::string WorkSession::WithoutFolder(std::string text) const {
  for (const char* name : {"/uploads/", "/machine/"}) {
    const std::string folder = folder_->path() + name;
    for (std::size_t at = text.find(folder); at != text.npos; at = text.find(folder)) {
      const std::size_t numbered = text.find('/', at + folder.size());
      text.erase(at, numbered == text.npos ? folder.size() : numbered + 1 - at);
    }
  }
  return text;
}

Status WorkSession::TakeLog(const std::string& name, const std::string& file) {
  const auto upload = TRY(uploads_.Keep(file, name));
  const std::string& path = *upload;
  if (const auto head = ReadLogHead(path); !head) return tl::unexpected(WithoutFolder(head.error()));
  const std::lock_guard lock(mutex_);
  logs_.push_back({PlainFileName(name), path, upload});
  columns_.reset();
  ForgetResults();
  Changed();
  return {};
}

Status WorkSession::TakeMachine(const std::string& name, const std::string& text) {
  const std::lock_guard lock(mutex_);
  TRY(machine_.Take(name, text));
  mapped_ = false;
  ForgetResults();
  Changed();
  return {};
}

Result<std::int64_t> WorkSession::StartExample(const std::string& id) {
  for (const ExampleLog& example : examples_) {
    if (example.id != id) continue;
    const std::string file = UploadFile();
    return jobs_.Add("example", id, [this, &example, file]() -> Status {
      TRY(example.write(file));
      StartOver({{"geometry", example.geometry}});
      return TakeLog(example.id + ".csv", file);
    });
  }
  return BadInput(Tell("id: there is no example '{}'", "es gibt kein Beispiel '{}'", id));
}

Status WorkSession::HoldOut(const std::string& name) {
  const std::lock_guard lock(mutex_);
  std::string path;
  for (const LogFile& log : logs_)
    if (log.name == name) path = log.path;
  if (path.empty() && !name.empty())
    return BadInput(Tell("log: there is no log '{}'", "es gibt kein Log '{}'", name));
  if (!path.empty() && logs_.size() < 2)
    return BadInput(Tell("{}: a model needs another log that it is fitted to",
                         "{}: ein Modell braucht ein anderes Log, an das es angepasst wird", name));
  hold_out_ = path;
  ForgetResults();
  Changed();
  return {};
}

Status WorkSession::TakeStrokes(const StrokeStretch& stretch) {
  if (database_.empty())
    return BadInput(Told("no database is watched here", "hier wird keine Datenbank beobachtet"));
  const auto kept = TRY(FindKeptStrokes(database_, stretch));
  StartOver();
  const std::string axis = stretch.machine.substr(stretch.machine.rfind('/') + 1);
  const std::lock_guard lock(mutex_);
  TRY(machine_.Take(axis + ".toml", kept.definition));
  for (const KeptStrokes::Piece& piece : kept.pieces)
    logs_.push_back({fmt::format("{} {}–{}", axis, piece.first, piece.last), piece.log});
  machine_.MarkSaved(kept.definition);  // the database has it
  strokes_of_ = {stretch.machine, kept.pieces.front().first, kept.pieces.back().last};
  ForgetResults();
  Changed();
  return {};
}

Result<std::int64_t> WorkSession::StartPromotion(const std::string& comment, const std::string& user) {
  if (comment.find_first_not_of(" \t\n") == std::string::npos)
    return BadInput(Told("comment: expected a text", "Bemerkung: erwartet ein Text"));
  const std::lock_guard lock(mutex_);
  if (strokes_of_.machine.empty())
    return BadInput(
        Told("these strokes are of no database: take those of an alarm or of a trend",
             "diese Hübe sind aus keiner Datenbank: die eines Alarms oder eines Verlaufs nehmen"));
  const Promotion promotion{strokes_of_.machine, 0, machine_.Text(), 0, user, comment, WallSeconds()};
  const auto promote = [this, promotion]() -> Status {
    TRY(PromoteWorkedOn(database_, promotion));
    const std::lock_guard lock(mutex_);
    machine_.MarkSaved(promotion.text);  // what was added since is not
    Changed();
    return {};
  };
  return jobs_.Add("promote", "", promote, JobQueue::Length::kShort);
}

void WorkSession::StartOver(nlohmann::json asked) {
  const std::lock_guard lock(mutex_);
  logs_.clear();
  strokes_of_ = {};
  hold_out_.clear();
  machine_.Forget();
  measured_.clear();
  draft_.clear();
  own_draft_.Forget();
  asked_ = std::move(asked);
  mapped_ = false;
  columns_.reset();
  ForgetResults();
  Changed();
}

Result<nlohmann::json> WorkSession::Propose(const ColumnMapping& mapping, nlohmann::json asked) {
  LogFile log;
  std::shared_ptr<const LogColumns> columns;
  {
    const std::lock_guard lock(mutex_);
    if (logs_.empty()) return BadInput(kNoLog);
    log = logs_.front();
    columns = columns_;
  }
  if (columns == nullptr) {
    auto read = ReadLogColumns(log.path);
    if (!read) return tl::unexpected(WithoutFolder(read.error()));
    read->path = log.name;  // names the machine
    columns = std::make_shared<const LogColumns>(std::move(*read));
  }
  const MachineProposal proposal = ProposeMapped(*columns, mapping);
  const nlohmann::json json = ProposalJson(*columns, proposal);
  const std::lock_guard lock(mutex_);
  columns_ = columns;
  asked_ = std::move(asked);
  draft_ = proposal.text;
  own_draft_.Take(proposal.machine);
  draft_name_ = proposal.machine.name + ".toml";
  pictures_.clear();
  return json;
}

Status WorkSession::AcceptProposal() {
  const auto [text, name] = [this] {
    const std::lock_guard lock(mutex_);
    return std::pair(draft_, draft_name_);
  }();
  if (text.empty()) return BadInput(Told("there is no proposal yet", "es gibt noch keinen Vorschlag"));
  TRY(TakeMachine(name, text));
  const std::lock_guard lock(mutex_);
  mapped_ = true;
  Changed();
  return {};
}

Status WorkSession::ReopenProposal() {
  const std::lock_guard lock(mutex_);
  if (!mapped_)
    return BadInput(Told("this machine file was not made from the columns of a log",
                         "diese Maschinendatei entstand nicht aus den Spalten eines Logs"));
  machine_.Forget();
  measured_.clear();
  mapped_ = false;
  ForgetResults();
  Changed();
  return {};
}

Result<WorkSession::Subject> WorkSession::TakeSubject() const {
  Subject subject;
  {
    const std::lock_guard lock(mutex_);
    subject.logs = logs_;
    subject.input.hold_out = hold_out_;
    subject.input.machine_file = machine_.file();
    subject.input.measured = measured_;
    subject.generation = generation_;
  }
  for (const LogFile& log : subject.logs) subject.input.logs.push_back(log.path);
  if (subject.logs.empty()) return BadInput(kNoLog);
  if (subject.input.machine_file.empty()) return BadInput(kNoMachineFile);
  const auto machine = TRY(LoadMachine(subject.input.machine_file));
  subject.version = machine.model_version;
  return subject;
}

Result<std::int64_t> WorkSession::Start(const WorkRequest& request) {
  const std::string about =
      request.kind == Kind::kRestore ? std::to_string(request.version) : request.effect + request.log;
  return jobs_.Add(WorkName(request.kind), about, [this, request]() -> Status {
    const Status done = Work(request);
    if (!done) return tl::unexpected(WithoutFolder(done.error()));
    return {};
  });
}

Status WorkSession::Work(const WorkRequest& request) {
  if (request.kind == Kind::kPicture) return DrawLog(request.log);
  const auto subject = TRY(TakeSubject());
  if (request.kind == Kind::kAdd || request.kind == Kind::kRemove || request.kind == Kind::kRestore)
    return ChangeVersion(request, subject);
  if (request.kind == Kind::kPreview) {
    auto preview =
        TRY(TryChange(request.effect, WithEffect, subject.input, folder_->path() + "/preview.toml"));
    Store(subject, KeyOf("preview", request.effect), std::move(preview));
    return {};
  }
  if (request.kind == Kind::kFrf) {
    auto measured = TRY(WorkOutValve(subject.input, request.response));
    Store(subject, WorkName(request.kind), std::move(measured));
    return {};
  }
  StrokeFindings strokes;
  {
    const std::lock_guard lock(mutex_);
    strokes = strokes_[subject.version];
  }
  auto result = TRY(WorkOut(request.kind, subject.input, strokes));
  {
    const std::lock_guard lock(mutex_);
    if (subject.generation == generation_) strokes_[subject.version] = std::move(strokes);
  }
  Store(subject, WorkName(request.kind), std::move(result));
  return {};
}

Status WorkSession::DrawLog(const std::string& name) {
  const auto machine = TRY(MachineOrDraft());
  LogFile log;
  int generation = 0;
  std::string draft;
  {
    const std::lock_guard lock(mutex_);
    if (machine_.empty()) draft = own_draft_.text();
    for (const LogFile& known : logs_)
      if (log.path.empty() && (name.empty() || name == known.name)) log = known;
    generation = generation_;
  }
  if (log.path.empty()) return BadInput(Tell("there is no log {}", "es gibt kein Log {}", name));
  auto picture = TRY(LogPictureJson(log.path, machine));
  auto stroke = draft.empty() ? nullptr : TermStroke::Of(log.path, machine);
  const std::lock_guard lock(mutex_);
  own_draft_.Draw(draft, std::move(stroke));
  if (generation == generation_) pictures_[name] = std::move(picture);
  return {};
}

Status WorkSession::ChangeVersion(const WorkRequest& request, const Subject& subject) {
  // Judged beside the file, then put in place at once: nobody reads half a change.
  const std::string next = folder_->path() + "/next.toml";
  if (request.kind != Kind::kRestore) {
    const auto change = request.kind == Kind::kAdd ? WithEffect : WithoutEffect;
    const auto changed = TRY(TryChange(request.effect, change, subject.input, next));
  }
  {
    const std::lock_guard lock(mutex_);
    if (subject.generation != generation_)
      return BadInput(Told("other logs were chosen meanwhile", "inzwischen wurden andere Logs gewählt"));
    TRY(request.kind == Kind::kRestore ? RestoreKept(subject.input.machine_file, request.version)
                                       : PutVersion(subject.input.machine_file, subject.version, next));
  }
  Changed();
  return {};
}

void WorkSession::Store(const Subject& subject, const std::string& key, nlohmann::json result) {
  const std::lock_guard lock(mutex_);
  if (subject.generation == generation_) results_[subject.version][key] = std::move(result);
}

Result<Machine> WorkSession::MachineOrDraft() const {
  std::string file, draft;
  {
    const std::lock_guard lock(mutex_);
    file = machine_.file();
    draft = own_draft_.text().empty() ? draft_ : own_draft_.text();
  }
  return file.empty() ? ParseMachine(draft, "proposal") : LoadMachine(file);
}

int WorkSession::VersionOr(int version) const {
  if (version != 0) return version;
  const auto machine = LoadMachine(machine_.file());
  return machine ? machine->model_version : 0;
}

nlohmann::json WorkSession::Find(const std::string& kind, const std::string& about, int version) const {
  const std::lock_guard lock(mutex_);
  if (kind == "picture") {
    const auto picture = pictures_.find(about);
    return picture == pictures_.end() ? nlohmann::json() : picture->second;
  }
  const auto results = results_.find(VersionOr(version));
  if (results == results_.end()) return nullptr;
  const auto result = results->second.find(KeyOf(kind, about));
  return result == results->second.end() ? nlohmann::json() : result->second;
}

nlohmann::json WorkSession::Stroke(std::int64_t stroke, int version, const std::string& effect) const {
  const std::lock_guard lock(mutex_);
  const auto strokes = strokes_.find(VersionOr(version));
  if (strokes == strokes_.end()) return nullptr;
  for (const nlohmann::json& known : strokes->second.pictures) {
    if (known["stroke"] != stroke) continue;
    nlohmann::json picture = known;
    if (!effect.empty()) picture["with_effect"] = strokes->second.errors.ModelledWith(effect, stroke);
    return picture;
  }
  return nullptr;
}

Result<nlohmann::json> WorkSession::ErrorsIn(const Region& region, int version) const {
  const std::lock_guard lock(mutex_);
  const auto strokes = strokes_.find(VersionOr(version));
  return strokes == strokes_.end() ? nlohmann::json() : strokes->second.errors.In(region);
}

/// The versions of the machine file; of those that no change has judged, what `compare` found.
nlohmann::json WorkSession::VersionsWithErrors() const {
  auto versions = VersionsJson(machine_.file());
  if (!versions) return nlohmann::json::array();
  for (nlohmann::json& version : *versions) {
    const auto results = results_.find(version["version"].get<int>());
    if (!version["rms_holdout"].is_null() || results == results_.end()) continue;
    const auto compared = results->second.find("compare");
    if (compared == results->second.end()) continue;
    for (const char* key : {"rms_holdout", "noise_floor", "unit", "strokes", "parameters"})
      version[key] = compared->second.value(key, nlohmann::json());
  }
  return *versions;
}

nlohmann::json WorkSession::Json() const {
  nlohmann::json jobs = jobs_.Json();
  const std::lock_guard lock(mutex_);
  nlohmann::json out = {
      {"logs", nlohmann::json::array()},
      {"machine", nullptr},
      {"versions", nlohmann::json::array()},
      {"units", nlohmann::json::object()},
      {"results", nlohmann::json::array()},
      {"jobs", std::move(jobs)},
      {"examples", nlohmann::json::array()},
      {"unsaved", false},
      {"strokes", nullptr},
      {"measured", nlohmann::json::array()},
      {"mapping", asked_},
      {"mapped", mapped_},
      {"file", machine_.target().empty() ? nlohmann::json() : nlohmann::json(machine_.target())}};
  for (const ExampleLog& example : examples_) out["examples"].push_back(example.id);
  for (const auto& [effect, known] : measured_)
    out["measured"].push_back({{"effect", effect}, {"size", known.size}, {"std", known.std}});
  for (const LogFile& log : logs_) {
    std::error_code gone;
    const auto bytes = std::filesystem::file_size(log.path, gone);
    out["logs"].push_back({{"name", log.name},
                           {"bytes", gone ? nlohmann::json() : nlohmann::json(bytes)},
                           {"held_out", log.path == hold_out_}});
  }
  if (!strokes_of_.machine.empty())
    out["strokes"] = {
        {"machine", strokes_of_.machine}, {"first", strokes_of_.first}, {"last", strokes_of_.last}};
  const auto machine = LoadMachine(machine_.file());
  if (machine_.empty() || !machine) return out;
  out["machine"] = ModelJson(*machine);
  out["machine"].update(MachineInfoJson(*machine));
  out["machine"]["suggested_file"] = std::filesystem::path(machine_.file()).filename().string();
  out["versions"] = VersionsWithErrors();
  out["units"] = UnitsJson(*machine);
  out["unsaved"] = machine_.Unsaved();
  if (const auto results = results_.find(machine->model_version); results != results_.end())
    for (const auto& [key, result] : results->second) out["results"].push_back(key);
  return out;
}

std::string WorkSession::MachineText() const {
  const std::lock_guard lock(mutex_);
  return machine_.Text();
}

nlohmann::json WorkSession::Effects() const {
  const auto machine = MachineOrDraft();
  return machine ? EffectsJson(&*machine) : nlohmann::json{{"effects", nlohmann::json::array()}};
}

Result<nlohmann::json> WorkSession::TakeEffect(const OwnEffect& effect) {
  const std::lock_guard lock(mutex_);
  if (machine_.empty() && !effect.keep && !own_draft_.text().empty()) return own_draft_.Look(effect);
  if (machine_.empty()) return BadInput(kNoMachineFile);
  const auto text = TRY(WithOwnEffect(machine_.Text(), effect));
  if (!effect.keep) {
    const auto tried = ParseMachine(text, "machine file");
    const auto strokes = tried ? strokes_.find(tried->model_version) : strokes_.end();
    if (strokes == strokes_.end() || strokes->second.term == nullptr) return nlohmann::json();
    return strokes->second.term->Course(*tried, tried->user_effects.back());
  }
  TRY(machine_.Write(text));
  ++generation_;  // what is being worked out knows another library
  const auto machine = LoadMachine(machine_.file());
  if (machine) results_[machine->model_version].erase("explain");
  Changed();
  return nlohmann::json();
}

Status WorkSession::TakeMeasured(const MeasuredEffect& measured) {
  const std::lock_guard lock(mutex_);
  if (machine_.empty()) return BadInput(kNoMachineFile);
  const auto machine = TRY(LoadMachine(machine_.file()));
  TRY(CheckInLibrary(measured, machine));
  if (measured.size)
    measured_[measured.effect] = *measured.size;
  else
    measured_.erase(measured.effect);
  ++generation_;  // what is being worked out does not know it
  for (auto& [version, results] : results_) results.erase("explain");
  Changed();
  return {};
}

Result<std::string> WorkSession::Save(const std::string& name) {
  const std::lock_guard lock(mutex_);
  if (machine_.empty()) return BadInput(kNoMachineFile);
  auto saved = machine_.Save(name);
  if (saved) Changed();
  return saved;
}

}  // namespace hydroscope
