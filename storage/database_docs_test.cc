#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "storage/schema.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;

std::string Page() {
  std::ifstream file(HYDROSCOPE_SOURCE_DIR "/docs/database.md");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The part of the page that begins with the table's name in bold, up to the next one or the next heading.
std::string SectionOf(const std::string& page, const std::string& table) {
  const std::size_t from = page.find("**`" + table + "`**");
  if (from == std::string::npos) return "";
  return page.substr(from, std::min(page.find("\n**`", from), page.find("\n## ", from)) - from);
}

std::vector<std::string> Queries(const std::string& page) {
  std::vector<std::string> queries;
  const std::string fence = "```sql\n";
  for (std::size_t at = page.find(fence); at != std::string::npos; at = page.find(fence, at)) {
    at += fence.size();
    queries.push_back(page.substr(at, page.find("```", at) - at));
  }
  return queries;
}

TEST(DatabasePage, DescribesEveryTableAndColumn) {
  const Folder folder;
  EXPECT_OK(Database::Open(folder.File()));
  SQLite::Database db(folder.File());
  const std::string page = Page();
  SQLite::Statement columns(db,
                            "SELECT m.name, c.name FROM sqlite_master m, pragma_table_info(m.name) c "
                            "WHERE m.type IN ('table', 'view') ORDER BY m.name, c.cid");
  int seen = 0;
  for (; columns.executeStep(); ++seen) {
    const std::string table = columns.getColumn(0).getString(), column = columns.getColumn(1).getString();
    EXPECT_THAT(SectionOf(page, table), HasSubstr("`" + column + "`"))
        << "column " << column << " of table " << table;
  }
  EXPECT_GT(seen, 60);
  EXPECT_THAT(page, HasSubstr("**format version " + std::to_string(kFormatVersion) + "**"));
  EXPECT_THAT(page, HasSubstr("`PRAGMA user_version = " + std::to_string(kFormatVersion) + "`"));
}

TEST(DatabasePage, ItsQueriesRunAndFindSomething) {
  const Folder folder;
  {
    Press press(folder.File());
    auto strokes = MakeStrokes(0, 20);
    strokes[4].summary.rms_error = 1;
    EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, strokes));
  }
  SQLite::Database db(folder.File());
  const auto queries = Queries(Page());
  EXPECT_GE(queries.size(), 5u);
  for (const std::string& query : queries) EXPECT_TRUE(SQLite::Statement(db, query).executeStep()) << query;
}

}  // namespace
}  // namespace hydroscope
