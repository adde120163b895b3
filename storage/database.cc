#include "storage/database.h"

#include <filesystem>

#include "core/shell_word.h"
#include "core/told_error.h"
#include "storage/connection.h"
#include "storage/schema.h"

namespace hydroscope {
namespace {

std::int64_t FindMachine(Connection& connection, const std::string& name) {
  Query query(connection, "SELECT id FROM machine WHERE name = ?", name);
  return query.Step() ? query.Int(0) : 0;
}

/// Version number of the machine's latest model, 0 if there is none.
int LatestVersion(Connection& connection, std::int64_t machine) {
  Query query(connection, "SELECT coalesce(max(version), 0) FROM model_version WHERE machine = ?", machine);
  query.Step();
  return static_cast<int>(query.Int(0));
}

std::string Definition(Connection& connection, std::int64_t machine, int version) {
  Query query(connection, "SELECT definition FROM model_version WHERE machine = ? AND version = ?", machine,
              version);
  return query.Step() ? query.Text(0) : std::string();
}

/// One version, or all of them (0), in order.
std::vector<ModelVersion> ReadVersions(Connection& connection, std::int64_t machine, int version) {
  Query query(connection,
              "SELECT version, definition, promoted FROM model_version WHERE machine = ?1 AND (?2 = 0 OR "
              "version = ?2) ORDER BY version",
              machine, version);
  std::vector<ModelVersion> versions;
  while (query.Step())
    versions.push_back({static_cast<int>(query.Int(0)), query.Text(1), {}, static_cast<int>(query.Int(2))});
  return versions;
}

bool MachineExists(Connection& connection, std::int64_t machine) {
  Query query(connection, "SELECT 1 FROM machine WHERE id = ?", machine);
  return query.Step();
}

Status CheckPath(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || path == ":memory:")
    return UsageError("the database needs a file name, for example press.db");
  if (std::filesystem::is_directory(path, ignored))
    return BadInput(Tell(
        "{} is a folder; give the name of a database file, for example {}/press.db",
        "{} ist ein Ordner; den Namen einer Datenbankdatei angeben, zum Beispiel {}/press.db", path, path));
  return {};
}

}  // namespace

Database::Database(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;
Database::~Database() = default;

Result<Database> Database::Open(const std::string& path) {
  TRY(CheckPath(path));
  std::unique_ptr<Impl> impl;
  TRY(Guarded(path, nullptr, [&]() -> Status {
    CreateForOwnerAndGroup(path);
    impl = std::make_unique<Impl>(path, path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    return PrepareForWriting(impl->db, path);
  }));
  return Database(std::move(impl));
}

std::optional<int> Database::OlderFormat(const std::string& path) {
  try {
    SQLite::Database db(path, SQLite::OPEN_READONLY);
    const int version = db.execAndGet("PRAGMA user_version").getInt();
    const bool ours = db.execAndGet("PRAGMA application_id").getInt() == kApplicationId;
    if (ours && version < kFormatVersion) return version;
  } catch (const SQLite::Exception&) {
    // What is wrong with the file Open says.
  }
  return std::nullopt;
}

Result<Database> Database::OpenReadOnly(const std::string& path) {
  TRY(CheckPath(path));
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    return BadInput(
        Tell("there is no database {}; fill one with `hydroscope replay LOG --machine M.toml --db {}`",
             "es gibt keine Datenbank {}; füllen mit `hydroscope replay LOG --machine M.toml --db {}`", path,
             ShellWord(path)));
  auto impl = TRY(OpenForReading<Impl>(path, CheckForReading));
  return Database(std::move(impl));
}

Result<std::string> Database::Identity() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::string> {
    Query query(*impl_, "SELECT id FROM identity");
    if (!query.Step())
      return BadInput(Tell("{} is damaged: table identity is empty",
                           "{} ist beschädigt: die Tabelle identity ist leer", impl_->path));
    return query.Text(0);
  });
}

Result<std::int64_t> Database::MachineId(const std::string& name) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::int64_t> {
    if (const std::int64_t id = FindMachine(*impl_, name); id != 0) return id;
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    std::int64_t id = FindMachine(*impl_, name);
    if (id == 0) {
      Query(*impl_, "INSERT INTO machine(name) VALUES(?)", name).Run();
      id = FindMachine(*impl_, name);
    }
    transaction.commit();
    return id;
  });
}

Result<std::vector<std::string>> Database::MachineNames() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<std::string>> {
    Query query(*impl_, "SELECT name FROM machine ORDER BY id");
    std::vector<std::string> names;
    while (query.Step()) names.push_back(query.Text(0));
    return names;
  });
}

Result<int> Database::PutModelVersion(std::int64_t machine, const ModelVersion& model) {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<int> {
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    if (!MachineExists(*impl_, machine))
      return BadInput(Tell("{} has no machine {}", "{} hat keine Maschine {}", impl_->path, machine));
    const int latest = LatestVersion(*impl_, machine);
    if (latest > 0 && Definition(*impl_, machine, latest) == model.definition &&
        impl_->Columns(machine, latest) == model.columns)
      return latest;
    const int version = latest + 1;
    Query(*impl_, "INSERT INTO model_version(machine, version, definition) VALUES(?, ?, ?)", machine, version,
          model.definition)
        .Run();
    for (std::size_t i = 0; i < model.columns.size(); ++i)
      Query(*impl_, "INSERT INTO model_column(machine, version, position, name) VALUES(?, ?, ?, ?)", machine,
            version, static_cast<std::int64_t>(i), model.columns[i])
          .Run();
    for (std::size_t i = 0; i < model.conditions.size(); ++i)
      Query(*impl_, "INSERT INTO condition VALUES(?, ?, ?, ?, ?)", machine, version,
            static_cast<std::int64_t>(i), model.conditions[i].name, model.conditions[i].unit)
          .Run();
    transaction.commit();
    return version;
  });
}

Result<ModelVersion> Database::GetModelVersion(std::int64_t machine, int version) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<ModelVersion> {
    const int latest = LatestVersion(*impl_, machine);
    if (version < 1 || version > latest)
      return BadInput(
          Tell("{} has no model version {} of machine {}; versions 1 to {} are stored",
               "{} hat keine Modellversion {} von Maschine {}; gespeichert sind die Versionen 1 bis {}",
               impl_->path, version, machine, latest));
    ModelVersion model = ReadVersions(*impl_, machine, version).front();
    model.columns = impl_->Columns(machine, version);
    return model;
  });
}

Result<std::vector<ModelVersion>> Database::ModelVersions(std::int64_t machine) const {
  return Guarded(impl_->path, &impl_->db,
                 [&]() -> Result<std::vector<ModelVersion>> { return ReadVersions(*impl_, machine, 0); });
}

Status Database::PromoteModel(std::int64_t machine, int version) {
  TRY(GetModelVersion(machine, version));
  return Guarded(impl_->path, &impl_->db, [&]() -> Status {
    Query(*impl_,
          "UPDATE model_version SET promoted = (SELECT max(promoted) + 1 FROM model_version WHERE machine = "
          "?1) WHERE machine = ?1 AND version = ?2",
          machine, version)
        .Run();
    return {};
  });
}

Result<std::optional<ModelVersion>> Database::PromotedModel(std::int64_t machine) const {
  using Found = std::optional<ModelVersion>;
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<Found> {
    Query query(
        *impl_,
        "SELECT version FROM model_version WHERE machine = ? AND promoted > 0 ORDER BY promoted DESC LIMIT 1",
        machine);
    if (!query.Step()) return Found();
    const int version = static_cast<int>(query.Int(0));
    ModelVersion model = ReadVersions(*impl_, machine, version).front();
    model.columns = impl_->Columns(machine, version);
    return Found(std::move(model));
  });
}

}  // namespace hydroscope
