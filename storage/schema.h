#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>

#include "core/result.h"

namespace hydroscope {

/// Version of the tables this program writes, in `PRAGMA user_version`; docs/database.md describes it.
inline constexpr int kFormatVersion = 7;
/// "HYDR", in `PRAGMA application_id`: tells our files from those of other programs.
inline constexpr int kApplicationId = 0x48594452;

/// Brings an open file to kFormatVersion: creates the tables in an empty file, migrates an older one, each
/// step in one transaction. A file of another program or of a newer version is left untouched and is an error.
Status PrepareForWriting(SQLite::Database& db, const std::string& path);

/// The same check without writing anything; an older version is an error too.
Status CheckForReading(SQLite::Database& db, const std::string& path);

}  // namespace hydroscope
