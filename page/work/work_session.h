#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "page/api_arguments.h"
#include "page/http/event_feed.h"
#include "page/work/job_queue.h"
#include "page/work/machine_copy.h"
#include "page/work/measured_effect.h"
#include "page/work/own_draft.h"
#include "page/work/own_effect.h"
#include "page/work/scratch_folder.h"
#include "page/work/stored_strokes.h"
#include "page/work/uploads.h"
#include "page/work/work_results.h"
#include "setup/log_columns.h"

namespace hydroscope {

/// An example log that the page offers.
struct ExampleLog {
  std::string id;
  std::function<Status(const std::string& path)> write;  ///< CSV
  std::map<std::string, double> geometry = {};  ///< of its machine, which nobody else knows; by name, SI
};

/// One person's work on logs: which logs, the machine file being worked on, and what was worked out about them. Safe to call
/// from any thread; what takes long goes through the job queue.
class WorkSession {
 public:
  /// `machine_file` "" = to be made on the page; `niceness` of what takes long.
  /// Errors: no temporary folder, or the machine file is wrong.
  static Result<std::unique_ptr<WorkSession>> Create(const std::vector<std::string>& logs,
                                                     const std::string& machine_file,
                                                     std::vector<ExampleLog> examples, EventFeed& feed,
                                                     int niceness = 0);

  /// `logs` (`name`, `bytes`, `held_out`), `machine` (or null), `versions`, `units`, `results` (kinds that are there), `jobs`,
  /// `examples`, `unsaved`, `strokes` (`machine`, `first`, `last`; or null), `measured` (`effect`, `size`, `std`), `mapping` (of
  /// the last proposal; or null), `mapped` (the machine file came of it).
  nlohmann::json Json() const;

  /// What takes long.
  JobQueue& jobs() { return jobs_; }

  /// A file for an upload to be written to (Uploads::NewFile).
  std::string UploadFile() { return uploads_.NewFile(); }
  Status MayUpload(std::int64_t bytes) const { return uploads_.MayTake(bytes); }
  /// Takes an upload as a log. Error: it cannot be read as one.
  Status TakeLog(const std::string& name, const std::string& file);
  /// Takes the text of a machine file as the one worked on. Error: it is none.
  Status TakeMachine(const std::string& name, const std::string& text);
  Result<std::int64_t> StartExample(const std::string& id);
  /// Judges models on this log without fitting them to it; "" = on none. Error: there is no such log, or no other one.
  Status HoldOut(const std::string& log);
  /// Forgets logs and machine file.
  void StartOver(nlohmann::json asked = nullptr);

  /// Whose strokes can be worked on; "": none. To be said before anybody asks.
  void set_database(std::string path) { database_ = std::move(path); }
  /// Takes strokes of a machine of the database, as far as their raw rows are kept, and its model in place of logs and machine
  /// file. Errors as of FindKeptStrokes.
  Status TakeStrokes(const StrokeStretch& stretch);
  /// Makes the model worked on the one of the machine whose strokes these are. Error: they are of no database, or no comment.
  Result<std::int64_t> StartPromotion(const std::string& comment, const std::string& user);

  /// The proposal for the first log with columns mapped so; `asked`: the mapping as it was asked for, which Json() tells again.
  /// Error: there is no log, or it cannot be read.
  Result<nlohmann::json> Propose(const ColumnMapping& mapping, nlohmann::json asked);
  /// Makes the last proposal the machine file worked on. Error: it cannot be used yet.
  Status AcceptProposal();
  /// Back to the proposal that was accepted. Error: the machine file worked on did not come of one.
  Status ReopenProposal();

  Result<std::int64_t> Start(const WorkRequest& request);
  /// What was worked out; null if it was not. `about`: effect of a preview, log of a picture.
  nlohmann::json Find(const std::string& kind, const std::string& about, int version) const;
  /// Picture of one stroke of version `version` (0 = current); null if there is none. With an effect `with_effect`, what the
  /// model would give with it (RegionErrors::ModelledWith).
  nlohmann::json Stroke(std::int64_t stroke, int version, const std::string& effect) const;

  /// Where in the operating space version `version` (0 = current) errs, and what effects would err there (RegionErrors::In).
  Result<nlohmann::json> ErrorsIn(const Region& region, int version) const;

  /// The text of the machine file worked on; "" if there is none.
  std::string MachineText() const;
  /// Effects of the machine's library (EffectsJson).
  nlohmann::json Effects() const;
  /// Looks at an effect a person writes: its term over a stroke (TermStroke::Course; null where nothing was compared yet). One that
  /// is to be kept joins the library of the machine file worked on. Error: what is wrong with it.
  Result<nlohmann::json> TakeEffect(const OwnEffect& effect);
  /// Takes what a test off the logs said of an effect into what is explained. Error: the library does not hold it.
  Status TakeMeasured(const MeasuredEffect& measured);
  /// MachineCopy::Save
  Result<std::string> Save(const std::string& name);

 private:
  struct LogFile {
    std::string name, path;
    KeptFile upload = {};  ///< what is at the path, if it came to the page
  };
  /// A job's view: what it was started for.
  struct Subject {
    WorkInput input;
    std::vector<LogFile> logs;  ///< of the input
    int generation = 0, version = 0;
  };

  WorkSession(std::vector<ExampleLog> examples, EventFeed& feed, std::unique_ptr<ScratchFolder> folder,
              int niceness);
  Result<Subject> TakeSubject() const;
  Status Work(const WorkRequest& request);
  Status DrawLog(const std::string& log);
  Status ChangeVersion(const WorkRequest& request, const Subject& subject);
  void Store(const Subject& subject, const std::string& key, nlohmann::json result);
  Result<Machine> MachineOrDraft() const;
  int VersionOr(int version) const;  ///< of the machine file worked on where it is 0
  nlohmann::json VersionsWithErrors() const;
  void ForgetResults();
  void Changed();
  Error WithoutFolder(const Error& error) const;
  std::string WithoutFolder(std::string text) const;

  const std::vector<ExampleLog> examples_;
  EventFeed& feed_;
  const std::unique_ptr<ScratchFolder> folder_;
  Uploads uploads_;

  mutable std::mutex mutex_;
  std::vector<LogFile> logs_;
  std::string hold_out_;  ///< path of one of them; "" = none
  std::string database_;
  StrokeStretch strokes_of_;  ///< strokes of the database that are worked on; no machine: none
  MachineCopy machine_;
  std::map<std::string, MeasuredSize> measured_;  ///< by effect
  std::shared_ptr<const LogColumns> columns_;
  std::string draft_, draft_name_;  ///< text of the last proposal
  OwnDraft own_draft_;              ///< of it
  nlohmann::json asked_;            ///< what it was asked for with
  bool mapped_ = false;             ///< the machine file worked on came of it
  int generation_ = 0;              ///< of logs and machine: results of older ones are dropped
  std::map<int, std::map<std::string, nlohmann::json>> results_;  ///< by model version, then kind and about
  std::map<int, StrokeFindings> strokes_;                         ///< by model version
  std::map<std::string, nlohmann::json> pictures_;                ///< by log

  JobQueue jobs_;  ///< last: ends before what its work needs
};

}  // namespace hydroscope
