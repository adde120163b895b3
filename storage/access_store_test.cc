#include "storage/access_store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

const StoredUser kAnna{"anna", "admin", "$argon2id$...", 1.5};

TEST(AccessStore, IsForItsOwnerAlone) {
  const Folder folder;
  EXPECT_OK(AccessStore::Open(folder.File()));
  struct stat found {};
  ASSERT_EQ(stat(folder.File("press.access.db").c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0600u);
}

TEST(AccessStore, IsNotUsedWhereOthersReadIt) {
  const Folder folder;
  EXPECT_OK(AccessStore::Open(folder.File()));
  std::filesystem::permissions(folder.File("press.access.db"), std::filesystem::perms(0644));
  const auto again = AccessStore::OpenExisting(folder.File());
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().text, HasSubstr("may be read by every user"));
}

TEST(AccessStore, IsMadeByWhoAddsAUserAndNobodyElse) {
  const Folder folder;
  const auto none = AccessStore::OpenExisting(folder.File());
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text, HasSubstr("add NAME --role admin"));
  EXPECT_FALSE(std::filesystem::exists(folder.File("press.access.db")));
}

TEST(AccessStore, KeepsUsersAndLoginsOverARestart) {
  const Folder folder;
  {
    auto store = AccessStore::Open(folder.File());
    ASSERT_TRUE(store) << store.error().text;
    EXPECT_OK(store->PutUser(kAnna));
    EXPECT_OK(store->AddSession({"id", "anna", "token", 10, 10}));
    EXPECT_OK(store->SeeSession("id", 20));
  }
  const auto store = AccessStore::OpenExisting(folder.File());
  ASSERT_TRUE(store) << store.error().text;
  EXPECT_EQ(store->User("anna")->value().password, kAnna.password);
  EXPECT_FALSE(store->User("bert")->has_value());
  const auto session = store->Session("id");
  ASSERT_TRUE(session && *session);
  EXPECT_EQ((*session)->token, "token");
  EXPECT_EQ((*session)->seen, 20);
}

TEST(AccessStore, AChangedOrRemovedUserIsLoggedOut) {
  const Folder folder;
  auto store = AccessStore::Open(folder.File());
  ASSERT_TRUE(store) << store.error().text;
  for (const auto& change : {std::function<Status()>([&] { return store->PutUser(kAnna); }),
                             std::function<Status()>([&] { return store->RemoveUser("anna"); })}) {
    EXPECT_OK(store->PutUser(kAnna));
    EXPECT_OK(store->AddSession({"id", "anna", "token", 10, 10}));
    EXPECT_OK(change());
    EXPECT_FALSE(store->Session("id")->has_value());
  }
  EXPECT_FALSE(store->RemoveUser("anna"));
  EXPECT_FALSE(store->AddSession({"id", "anna", "token", 10, 10})) << "nobody logs in as a user who is gone";
}

TEST(AccessStore, EndsLoginsThatAreOldOrIdle) {
  const Folder folder;
  auto store = AccessStore::Open(folder.File());
  ASSERT_TRUE(store) << store.error().text;
  EXPECT_OK(store->PutUser(kAnna));
  EXPECT_OK(store->AddSession({"old", "anna", "", 10, 100}));
  EXPECT_OK(store->AddSession({"idle", "anna", "", 50, 60}));
  EXPECT_OK(store->AddSession({"used", "anna", "", 50, 100}));
  EXPECT_OK(store->EndOldSessions(20, 70));
  EXPECT_FALSE(store->Session("old")->has_value());
  EXPECT_FALSE(store->Session("idle")->has_value());
  EXPECT_TRUE(store->Session("used")->has_value());
}

TEST(AccessStore, NobodyChangesTheAuditTable) {
  const Folder folder;
  auto store = AccessStore::Open(folder.File());
  ASSERT_TRUE(store) << store.error().text;
  for (const char* what : {"first", "second"})
    EXPECT_OK(store->Append({0, 5, "anna", "admin", "::1", what, "{}", ""}));
  SQLite::Database other(folder.File("press.access.db"), SQLite::OPEN_READWRITE);
  EXPECT_THROW(other.exec("DELETE FROM audit"), SQLite::Exception);
  EXPECT_THROW(other.exec("UPDATE audit SET user = 'bert'"), SQLite::Exception);
  const auto rows = store->Audit(10);
  ASSERT_EQ(rows->size(), 2u);
  EXPECT_EQ(rows->front().what, "second");
  EXPECT_EQ(rows->front().sequence, 2);
}

TEST(AccessStore, LeavesOtherFilesAlone) {
  const Folder folder;
  std::filesystem::path file = folder.File("press.access.db");
  SQLite::Database(file, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE mine(x)");
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  const auto store = AccessStore::Open(folder.File());
  ASSERT_FALSE(store);
  EXPECT_THAT(store.error().text, HasSubstr("holds no users"));
}

TEST(AccessStore, ItsDocumentDescribesEveryTableAndColumn) {
  const Folder folder;
  EXPECT_OK(AccessStore::Open(folder.File()));
  std::ifstream file(HYDROSCOPE_SOURCE_DIR "/docs/access.md");
  std::stringstream page;
  page << file.rdbuf();
  SQLite::Database db(folder.File("press.access.db"));
  SQLite::Statement columns(db,
                            "SELECT m.name, c.name FROM sqlite_master m, pragma_table_info(m.name) c "
                            "WHERE m.type = 'table'");
  int seen = 0;
  for (; columns.executeStep(); ++seen) {
    EXPECT_THAT(page.str(), HasSubstr("`" + columns.getColumn(0).getString() + "`"));
    EXPECT_THAT(page.str(), HasSubstr("`" + columns.getColumn(1).getString() + "`"));
  }
  EXPECT_EQ(seen, 17);
  EXPECT_THAT(page.str(), HasSubstr("**format version " + std::to_string(kAccessFormat) + "**"));
}

}  // namespace
}  // namespace hydroscope
