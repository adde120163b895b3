#include "storage/schema.h"

#include <array>

#include "core/shell_word.h"
#include "core/told_error.h"

namespace hydroscope {
namespace {

constexpr const char* kVersion1 = R"sql(
CREATE TABLE machine(
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  raw_bytes INTEGER NOT NULL DEFAULT 0
) STRICT;

CREATE TABLE model_version(
  machine INTEGER NOT NULL REFERENCES machine(id),
  version INTEGER NOT NULL,
  definition TEXT NOT NULL,
  PRIMARY KEY(machine, version)
) STRICT, WITHOUT ROWID;

CREATE TABLE model_column(
  machine INTEGER NOT NULL,
  version INTEGER NOT NULL,
  position INTEGER NOT NULL,
  name TEXT NOT NULL,
  PRIMARY KEY(machine, version, position),
  FOREIGN KEY(machine, version) REFERENCES model_version(machine, version)
) STRICT, WITHOUT ROWID;

CREATE TABLE run(
  id INTEGER PRIMARY KEY,
  machine INTEGER NOT NULL,
  model_version INTEGER NOT NULL,
  source TEXT NOT NULL,
  fingerprint TEXT NOT NULL,
  first_sequence INTEGER NOT NULL,
  strokes INTEGER NOT NULL DEFAULT 0,
  state TEXT NOT NULL DEFAULT 'open' CHECK(state IN ('open', 'complete', 'abandoned')),
  summary TEXT NOT NULL DEFAULT '',
  pipeline_state BLOB,
  raw_until_s REAL,
  UNIQUE(machine, fingerprint),
  FOREIGN KEY(machine, model_version) REFERENCES model_version(machine, version)
) STRICT;

CREATE TABLE stroke(
  run INTEGER NOT NULL REFERENCES run(id),
  stroke INTEGER NOT NULL,
  begin_s REAL,
  end_s REAL,
  oil_temperature_K REAL,
  mean_speed_m_s REAL,
  mean_pressure_Pa REAL,
  max_pressure_Pa REAL,
  rms_error_m3_s REAL,
  noise_floor_m3_s REAL,
  rows_seen INTEGER NOT NULL,
  rows_gated INTEGER NOT NULL,
  rows_used INTEGER NOT NULL,
  content_hash INTEGER NOT NULL,
  PRIMARY KEY(run, stroke)
) STRICT, WITHOUT ROWID;

CREATE TABLE stroke_flag(
  run INTEGER NOT NULL,
  stroke INTEGER NOT NULL,
  flag TEXT NOT NULL,
  rows INTEGER NOT NULL,
  PRIMARY KEY(run, stroke, flag),
  FOREIGN KEY(run, stroke) REFERENCES stroke(run, stroke)
) STRICT, WITHOUT ROWID;

CREATE TABLE parameter(
  id INTEGER PRIMARY KEY,
  machine INTEGER NOT NULL REFERENCES machine(id),
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  UNIQUE(machine, name, unit)
) STRICT;

CREATE TABLE estimate(
  parameter INTEGER NOT NULL REFERENCES parameter(id),
  run INTEGER NOT NULL,
  stroke INTEGER NOT NULL,
  value REAL,
  std REAL,
  excitation REAL,
  last_excited_s REAL,
  reason TEXT NOT NULL,
  PRIMARY KEY(parameter, run, stroke),
  FOREIGN KEY(run, stroke) REFERENCES stroke(run, stroke)
) STRICT, WITHOUT ROWID;

CREATE TABLE gram(
  run INTEGER NOT NULL,
  stroke INTEGER NOT NULL,
  gram BLOB NOT NULL,
  PRIMARY KEY(run, stroke),
  FOREIGN KEY(run, stroke) REFERENCES stroke(run, stroke)
) STRICT;

CREATE TABLE gram_rollup(
  machine INTEGER NOT NULL REFERENCES machine(id),
  strokes INTEGER NOT NULL,
  first_sequence INTEGER NOT NULL,
  model_version INTEGER NOT NULL,
  gram BLOB NOT NULL,
  PRIMARY KEY(machine, strokes, first_sequence)
) STRICT;

CREATE TABLE raw_chunk(
  id INTEGER PRIMARY KEY,
  run INTEGER NOT NULL REFERENCES run(id),
  first_s REAL NOT NULL,
  last_s REAL NOT NULL,
  rows INTEGER NOT NULL,
  signals TEXT NOT NULL,
  samples BLOB NOT NULL
) STRICT;
CREATE INDEX raw_chunk_by_time ON raw_chunk(run, first_s);

CREATE VIEW trend AS
  SELECT m.name AS machine, r.id AS run, r.source AS source, e.stroke AS stroke,
         r.first_sequence + e.stroke AS sequence, s.end_s AS time_s, p.name AS parameter, e.value AS value,
         e.std AS std, p.unit AS unit, s.oil_temperature_K AS oil_temperature_K, e.reason AS reason,
         e.excitation AS excitation, e.last_excited_s AS last_excited_s
  FROM estimate e JOIN parameter p ON p.id = e.parameter JOIN run r ON r.id = e.run
  JOIN machine m ON m.id = r.machine JOIN stroke s ON s.run = e.run AND s.stroke = e.stroke;
)sql";

/// Which model replay and monitor use: that of the greatest number; 0 = never promoted.
constexpr const char* kVersion2 = R"sql(
ALTER TABLE model_version ADD COLUMN promoted INTEGER NOT NULL DEFAULT 0;
)sql";

/// The live service: flags of raw samples, how far a run has come, whose rows it holds, and valve checks.
constexpr const char* kVersion3 = R"sql(
ALTER TABLE raw_chunk ADD COLUMN flags BLOB;
ALTER TABLE run ADD COLUMN rows_taken INTEGER NOT NULL DEFAULT 0;
ALTER TABLE run ADD COLUMN sender_marks BLOB;

CREATE TABLE valve_check(
  machine INTEGER NOT NULL REFERENCES machine(id),
  number INTEGER NOT NULL,
  begin_s REAL NOT NULL,
  outcome TEXT NOT NULL,
  detail TEXT NOT NULL,
  f0_Hz REAL,
  f0_std_Hz REAL,
  damping REAL,
  damping_std REAL,
  gain REAL,
  gain_std REAL,
  dead_time_s REAL,
  dead_time_std_s REAL,
  bandwidth_Hz REAL,
  bandwidth_std_Hz REAL,
  amplitude REAL,
  supply_pressure_Pa REAL,
  oil_temperature_K REAL,
  PRIMARY KEY(machine, number)
) STRICT, WITHOUT ROWID;
)sql";

/// The oil temperature an estimate stands for, beside that of the stroke.
constexpr const char* kVersion4 = R"sql(
ALTER TABLE estimate ADD COLUMN oil_temperature_K REAL;
DROP VIEW trend;
CREATE VIEW trend AS
  SELECT m.name AS machine, r.id AS run, r.source AS source, e.stroke AS stroke,
         r.first_sequence + e.stroke AS sequence, s.end_s AS time_s, p.name AS parameter, e.value AS value,
         e.std AS std, p.unit AS unit, s.oil_temperature_K AS oil_temperature_K, e.reason AS reason,
         e.excitation AS excitation, e.last_excited_s AS last_excited_s,
         e.oil_temperature_K AS remembered_oil_temperature_K
  FROM estimate e JOIN parameter p ON p.id = e.parameter JOIN run r ON r.id = e.run
  JOIN machine m ON m.id = r.machine JOIN stroke s ON s.run = e.run AND s.stroke = e.stroke;
)sql";

/// Tells this database from every other one, so that it and its alarm journal know each other.
constexpr const char* kVersion5 = R"sql(
CREATE TABLE identity(id TEXT NOT NULL) STRICT;
INSERT INTO identity VALUES(lower(hex(randomblob(16))));
)sql";

/// What strokes were driven at is what their machine declares, in place of speed and pressures alone, and errors are in the
/// unit of its output.
constexpr const char* kVersion6 = R"sql(
ALTER TABLE stroke RENAME COLUMN mean_speed_m_s TO condition_0;
ALTER TABLE stroke RENAME COLUMN mean_pressure_Pa TO condition_1;
ALTER TABLE stroke RENAME COLUMN max_pressure_Pa TO condition_2;
ALTER TABLE stroke ADD COLUMN condition_3 REAL DEFAULT 0;
ALTER TABLE stroke ADD COLUMN condition_4 REAL DEFAULT 0;
ALTER TABLE stroke ADD COLUMN condition_5 REAL DEFAULT 0;
ALTER TABLE stroke RENAME COLUMN rms_error_m3_s TO rms_error;
ALTER TABLE stroke RENAME COLUMN noise_floor_m3_s TO noise_floor;

CREATE TABLE condition(
  machine INTEGER NOT NULL,
  version INTEGER NOT NULL,
  position INTEGER NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  PRIMARY KEY(machine, version, position),
  FOREIGN KEY(machine, version) REFERENCES model_version(machine, version)
) STRICT, WITHOUT ROWID;
INSERT INTO condition SELECT machine, version, 0, 'speed', 'm/s' FROM model_version;
INSERT INTO condition SELECT machine, version, 1, 'pressure', 'Pa' FROM model_version;
INSERT INTO condition SELECT machine, version, 2, 'max_pressure', 'Pa' FROM model_version;
)sql";

/// Estimates in order of strokes: a stroke is stored and read as a whole, on one page in place of one of every parameter.
constexpr const char* kVersion7 = R"sql(
CREATE TABLE estimate_of_stroke(
  run INTEGER NOT NULL,
  stroke INTEGER NOT NULL,
  parameter INTEGER NOT NULL REFERENCES parameter(id),
  value REAL,
  std REAL,
  excitation REAL,
  last_excited_s REAL,
  reason TEXT NOT NULL,
  oil_temperature_K REAL,
  PRIMARY KEY(run, stroke, parameter),
  FOREIGN KEY(run, stroke) REFERENCES stroke(run, stroke)
) STRICT, WITHOUT ROWID;
-- Stroke by stroke: rows that lie one behind the other need no sorting.
INSERT INTO estimate_of_stroke
  SELECT e.run, e.stroke, e.parameter, e.value, e.std, e.excitation, e.last_excited_s, e.reason, e.oil_temperature_K
  FROM stroke s CROSS JOIN run r ON r.id = s.run CROSS JOIN parameter p ON p.machine = r.machine
  CROSS JOIN estimate e ON e.parameter = p.id AND e.run = s.run AND e.stroke = s.stroke;
DROP VIEW trend;
DROP TABLE estimate;
ALTER TABLE estimate_of_stroke RENAME TO estimate;
CREATE VIEW trend AS
  SELECT m.name AS machine, r.id AS run, r.source AS source, e.stroke AS stroke,
         r.first_sequence + e.stroke AS sequence, s.end_s AS time_s, p.name AS parameter, e.value AS value,
         e.std AS std, p.unit AS unit, s.oil_temperature_K AS oil_temperature_K, e.reason AS reason,
         e.excitation AS excitation, e.last_excited_s AS last_excited_s,
         e.oil_temperature_K AS remembered_oil_temperature_K
  FROM estimate e JOIN parameter p ON p.id = e.parameter JOIN run r ON r.id = e.run
  JOIN machine m ON m.id = r.machine JOIN stroke s ON s.run = e.run AND s.stroke = e.stroke;
)sql";

/// Element i brings version i to version i + 1; version 0 is an empty file.
constexpr std::array<const char*, kFormatVersion> kMigrations = {kVersion1, kVersion2, kVersion3, kVersion4,
                                                                 kVersion5, kVersion6, kVersion7};

struct FileKind {
  int application = 0;
  int version = 0;
  bool empty = false;
};

FileKind Inspect(SQLite::Database& db) {
  FileKind kind;
  kind.application = db.execAndGet("PRAGMA application_id").getInt();
  kind.version = db.execAndGet("PRAGMA user_version").getInt();
  kind.empty = kind.application == 0 && kind.version == 0 &&
               db.execAndGet("SELECT count(*) FROM sqlite_master").getInt() == 0;
  return kind;
}

Status CheckOurs(const FileKind& kind, const std::string& path) {
  if (!kind.empty && kind.application != kApplicationId)
    return BadInput(Tell(
        "{} is a database of another program (application id {:#x}, expected {:#x}); it was left as it "
        "is. Give the file that `hydroscope replay --db` wrote, or a new name",
        "{} ist die Datenbank eines anderen Programms (application id {:#x}, erwartet {:#x}); sie wurde gelassen, wie "
        "sie war. Die Datei angeben, die `hydroscope replay --db` schrieb, oder einen neuen Namen",
        path, static_cast<unsigned>(kind.application), static_cast<unsigned>(kApplicationId)));
  if (kind.version > kFormatVersion)
    return BadInput(Tell(
        "{} has database format {}, this program knows formats up to {}; it was left as it is. Use the "
        "newer hydroscope that wrote it, or replay the logs into a new database",
        "{} hat das Datenbankformat {}, dieses Programm kennt Formate bis {}; sie wurde gelassen, wie sie war. Das "
        "neuere hydroscope benutzen, das sie schrieb, oder die Logs in eine neue Datenbank einspielen",
        path, kind.version, kFormatVersion));
  return {};
}

}  // namespace

Status PrepareForWriting(SQLite::Database& db, const std::string& path) {
  FileKind kind = Inspect(db);
  TRY(CheckOurs(kind, path));
  if (kind.empty) db.exec("PRAGMA page_size = 16384");
  db.exec("PRAGMA journal_mode = WAL");
  db.exec("PRAGMA synchronous = NORMAL");
  db.exec("PRAGMA journal_size_limit = 67108864");
  db.exec("PRAGMA wal_autocheckpoint = 1024");  // pages: 16 MB; a checkpoint waits for the disk
  db.exec("PRAGMA foreign_keys = ON");
  if (kind.version == kFormatVersion) return {};

  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  kind = Inspect(db);  // another process may have been faster
  TRY(CheckOurs(kind, path));
  for (int version = kind.version; version < kFormatVersion; ++version) db.exec(kMigrations[version]);
  db.exec(fmt::format("PRAGMA application_id = {}", kApplicationId));
  db.exec(fmt::format("PRAGMA user_version = {}", kFormatVersion));
  transaction.commit();
  return {};
}

Status CheckForReading(SQLite::Database& db, const std::string& path) {
  const FileKind kind = Inspect(db);
  if (kind.empty)
    return BadInput(
        Tell("{} is an empty database; fill it with `hydroscope replay LOG --machine M.toml --db {}`",
             "{} ist eine leere Datenbank; füllen mit `hydroscope replay LOG --machine M.toml --db {}`", path,
             ShellWord(path)));
  TRY(CheckOurs(kind, path));
  if (kind.version < kFormatVersion)
    return BadInput(
        Tell("{} has the older database format {}; replaying any log into it brings it to format {}",
             "{} hat das ältere Datenbankformat {}; irgendein Log einzuspielen bringt sie auf Format {}",
             path, kind.version, kFormatVersion));
  return {};
}

}  // namespace hydroscope
