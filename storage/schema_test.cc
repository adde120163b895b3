#include "storage/schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void Execute(const std::string& path, const std::string& sql) {
  SQLite::Database db(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  db.exec(sql);
}

Error OpenError(const std::string& path) {
  const auto opened = Database::Open(path);
  EXPECT_FALSE(opened.has_value());
  return opened ? Error{} : opened.error();
}

TEST(Schema, ANewFileCarriesOurIdAndVersion) {
  const Folder folder;
  EXPECT_OK(Database::Open(folder.File()));
  SQLite::Database db(folder.File());
  EXPECT_EQ(db.execAndGet("PRAGMA application_id").getInt(), kApplicationId);
  EXPECT_EQ(db.execAndGet("PRAGMA user_version").getInt(), kFormatVersion);
  EXPECT_EQ(db.execAndGet("PRAGMA page_size").getInt(), 16384);
  EXPECT_EQ(db.execAndGet("PRAGMA journal_mode").getString(), "wal");
}

TEST(Schema, AnEmptyFileBecomesADatabase) {
  const Folder folder;
  std::ofstream(folder.File()).close();
  EXPECT_OK(Database::Open(folder.File()));
  EXPECT_OK(Database::OpenReadOnly(folder.File()));
}

TEST(Schema, ANewerVersionIsRefusedAndLeftAsItIs) {
  const Folder folder;
  EXPECT_OK(Database::Open(folder.File()));
  Execute(folder.File(), "PRAGMA user_version = 999");
  const std::string before = Bytes(folder.File());
  const Error error = OpenError(folder.File());
  EXPECT_EQ(error.kind, ErrorKind::kBadInput);
  EXPECT_THAT(error.text, HasSubstr(fmt::format("database format 999, this program knows formats up to {}",
                                                kFormatVersion)));
  EXPECT_THAT(Database::OpenReadOnly(folder.File()).error().text, HasSubstr("database format 999"));
  EXPECT_EQ(Bytes(folder.File()), before);
}

TEST(Schema, AnOlderVersionIsBroughtUpToDateWithWhatItHolds) {
  const Folder folder;
  {
    Press press(folder.File());
    EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 3)));
  }
  const auto trend = [&] {
    const Database database = Value(Database::OpenReadOnly(folder.File()));
    std::vector<std::string> points;
    for (const TrendPoint& p : Value(database.Trend(1, "")))
      points.push_back(fmt::format("{} {} {} {} {}", p.sequence, p.estimate.parameter, p.estimate.value,
                                   p.estimate.std, ReasonName(p.estimate.reason)));
    return points;
  };
  const auto points = trend();
  EXPECT_EQ(points.size(), 12u);
  Execute(
      folder.File(),
      "DROP TABLE condition; ALTER TABLE stroke DROP COLUMN condition_3; ALTER TABLE stroke DROP COLUMN "
      "condition_4; ALTER TABLE stroke DROP COLUMN condition_5; ALTER TABLE stroke RENAME COLUMN "
      "condition_0 TO mean_speed_m_s; ALTER TABLE stroke RENAME COLUMN condition_1 TO mean_pressure_Pa; "
      "ALTER TABLE stroke RENAME COLUMN condition_2 TO max_pressure_Pa; ALTER TABLE stroke RENAME COLUMN "
      "rms_error TO rms_error_m3_s; ALTER TABLE stroke RENAME COLUMN noise_floor TO noise_floor_m3_s; "
      "DROP TABLE identity; DROP VIEW trend; CREATE TABLE by_parameter(parameter INTEGER NOT NULL, run INTEGER "
      "NOT NULL, stroke INTEGER NOT NULL, value REAL, std REAL, excitation REAL, last_excited_s REAL, reason "
      "TEXT NOT NULL, PRIMARY KEY(parameter, run, stroke)) STRICT, WITHOUT ROWID; INSERT INTO by_parameter "
      "SELECT parameter, run, stroke, value, std, excitation, last_excited_s, reason FROM estimate; DROP TABLE "
      "estimate; ALTER TABLE by_parameter RENAME TO estimate; CREATE VIEW trend AS SELECT 1; DROP TABLE valve_check; ALTER TABLE run DROP COLUMN sender_marks; ALTER "
      "TABLE run DROP COLUMN rows_taken; ALTER TABLE raw_chunk DROP COLUMN flags; ALTER TABLE "
      "model_version DROP COLUMN promoted; PRAGMA user_version = 1");
  EXPECT_THAT(Database::OpenReadOnly(folder.File()).error().text, HasSubstr("older database format 1"));
  EXPECT_EQ(Database::OlderFormat(folder.File()), 1);
  Press press(folder.File());
  EXPECT_EQ(press.version, 1);
  EXPECT_EQ(Value(press.database.EndSequence(press.machine)), 3);
  EXPECT_FALSE(Value(press.database.PromotedModel(press.machine)).has_value());
  EXPECT_EQ(trend(), points);
  EXPECT_EQ(Database::OlderFormat(folder.File()), std::nullopt);
  EXPECT_EQ(Database::OlderFormat(folder.File("none.db")), std::nullopt);
  const auto strokes = Value(press.database.Strokes(1));
  ASSERT_EQ(strokes.size(), 3u);
  EXPECT_EQ(strokes[1].conditions, (std::array<double, kMaxConditions>{0.2, 1.2e7, 1.9e7 + 1, 0, 0, 0}));
}

TEST(Schema, ADatabaseOfAnotherProgramIsRefusedAndLeftAsItIs) {
  const Folder folder;
  Execute(folder.File(), "CREATE TABLE customer(name TEXT)");
  const std::string before = Bytes(folder.File());
  const Error error = OpenError(folder.File());
  EXPECT_EQ(error.kind, ErrorKind::kBadInput);
  EXPECT_THAT(error.text, HasSubstr("database of another program"));
  EXPECT_THAT(error.german, HasSubstr("Datenbank eines anderen Programms"));
  EXPECT_THAT(Database::OpenReadOnly(folder.File()).error().text, HasSubstr("database of another program"));
  EXPECT_EQ(Bytes(folder.File()), before);
}

TEST(Schema, AFileThatIsNoDatabaseIsRefusedAndLeftAsItIs) {
  const Folder folder;
  std::ofstream(folder.File("press.csv")) << std::string(5000, 't') << "\n1,2,3\n";
  const std::string before = Bytes(folder.File("press.csv"));
  const Error error = OpenError(folder.File("press.csv"));
  EXPECT_EQ(error.kind, ErrorKind::kBadInput);
  EXPECT_THAT(error.text, HasSubstr("press.csv is no hydroscope database"));
  EXPECT_FALSE(Database::OpenReadOnly(folder.File("press.csv")).has_value());
  EXPECT_EQ(Bytes(folder.File("press.csv")), before);
}

TEST(Schema, AFileCutInHalfIsAnErrorNotACrash) {
  const Folder folder;
  {
    Press press(folder.File());
    EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 40)));
  }
  std::filesystem::resize_file(folder.File(), std::filesystem::file_size(folder.File()) / 2);
  const auto opened = Database::OpenReadOnly(folder.File());
  const Status checked = opened ? opened->CheckIntegrity() : Status(tl::unexpected(opened.error()));
  ASSERT_FALSE(checked.has_value());
  EXPECT_EQ(checked.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(checked.error().text, HasSubstr("is damaged"));
}

TEST(Schema, OpeningForReadingNeverCreatesAFile) {
  const Folder folder;
  const auto opened = Database::OpenReadOnly(folder.File());
  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(opened.error().text, HasSubstr("hydroscope replay LOG"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Schema, ReadingLeavesNothingBehind) {
  const Folder folder;
  EXPECT_OK(Database::Open(folder.File()));
  const std::string before = Bytes(folder.File());
  EXPECT_TRUE(Value(Value(Database::OpenReadOnly(folder.File())).MachineNames()).empty());
  EXPECT_EQ(Bytes(folder.File()), before);
  const std::filesystem::directory_iterator files(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1) << "only the database itself";
}

TEST(Schema, AnEmptyFileOpenedForReadingSaysHowToFillIt) {
  const Folder folder;
  std::ofstream(folder.File()).close();
  EXPECT_THAT(Database::OpenReadOnly(folder.File()).error().text,
              HasSubstr("is an empty database; fill it with"));
  EXPECT_EQ(std::filesystem::file_size(folder.File()), 0u);
}

TEST(Schema, WritingThroughAReadOnlyDatabaseIsAnError) {
  const Folder folder;
  EXPECT_OK(Database::Open(folder.File()));
  Database reader = Value(Database::OpenReadOnly(folder.File()));
  const auto id = reader.MachineId("press 7");
  ASSERT_FALSE(id.has_value());
  EXPECT_THAT(id.error().text, HasSubstr("cannot be written"));
}

TEST(Schema, AFolderAMissingFolderAndAnEmptyNameAreNamed) {
  const Folder folder;
  EXPECT_THAT(OpenError(folder.path()).text, HasSubstr("is a folder"));
  EXPECT_THAT(OpenError(folder.File("no/such/press.db")).text, HasSubstr("check that the folder exists"));
  EXPECT_EQ(OpenError("").kind, ErrorKind::kUsage);
}

TEST(Schema, TwoWritersCreateOneFileTogether) {
  const Folder folder;
  Database one = Value(Database::Open(folder.File()));
  Database two = Value(Database::Open(folder.File()));
  EXPECT_EQ(Value(one.MachineId("press 7")), Value(two.MachineId("press 7")));
  EXPECT_NE(Value(one.MachineId("press 8")), Value(two.MachineId("press 9")));
}

}  // namespace
}  // namespace hydroscope
