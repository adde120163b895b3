#include "storage/database_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <fstream>

#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;

/// Whether SQLite's shared lock keeps another process from taking the file for its own (sqlite.org/lockingv3.html).
bool IsKeptFromOthers(const std::string& path) {
  constexpr off_t kShared = 0x40000002, kBytes = 510;
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = kShared;
  lock.l_len = kBytes;
  // As another process would ask: an open file description holds none of the process's locks.
  EXPECT_EQ(fcntl(file, F_OFD_GETLK, &lock), 0);
  close(file);  // and now no lock is left
  return lock.l_type != F_UNLCK;
}

TEST(DatabaseFile, IsRecognisedByWhatIsInIt) {
  const Folder folder;
  { Press press(folder.File()); }
  std::ofstream(folder.File("log.csv")) << "t,u,y\n0,1,2\n";
  std::ofstream(folder.File("empty.db"));
  EXPECT_TRUE(IsDatabaseFile(folder.File()));
  EXPECT_FALSE(IsDatabaseFile(folder.File("log.csv")));
  EXPECT_FALSE(IsDatabaseFile(folder.File("empty.db")));
  EXPECT_FALSE(IsDatabaseFile(folder.File("none.db")));
  EXPECT_FALSE(IsDatabaseFile(folder.path()));
}

TEST(DatabaseFile, LooksLeaveTheLocksOfWhoWritesIt) {
  const Folder folder;
  Press press(folder.File());
  EXPECT_OK(press.database.StoreStrokes(press.Begin("a.csv").id, MakeStrokes(0, 2)));
  EXPECT_TRUE(IsDatabaseFile(folder.File()));
  EXPECT_TRUE(IsKeptFromOthers(folder.File()));
  EXPECT_FALSE(IsKeptFromOthers(folder.File()));  // the asking closed the file by itself
}

}  // namespace
}  // namespace hydroscope
