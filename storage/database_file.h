#pragma once

#include <string>

namespace hydroscope {

/// Whether a file is an SQLite database, by its first bytes; false if there is none or it cannot be read. Read by SQLite: a process
/// that opens a database by itself loses all of SQLite's locks on it as soon as it closes it (POSIX locks belong to the process;
/// sqlite.org, "How To Corrupt An SQLite Database File", 2.2), and the next program that closes the database deletes the
/// write-ahead log under the one that still writes into it.
bool IsDatabaseFile(const std::string& path);

}  // namespace hydroscope
