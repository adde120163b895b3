#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace hydroscope {

/// Removes what killed processes left of Fast DDS in the folder of shared memory: segments and ports whose
/// lock nobody holds, older than `age` seconds (younger ones may be in the making). Returns how many files
/// went. The library itself never removes the segments, 0.55 MB for each process that was killed.
int RemoveDeadSharedMemory(const std::filesystem::path& folder = "/dev/shm", double age = 10);

/// Who else has shared memory of Fast DDS in use.
struct SharedMemoryUsers {
  std::string other;  ///< a user that is not ours, or ""
  bool own = false;   ///< processes of our user, perhaps this one
};
/// The library makes its files so that processes of another user cannot write into them: what such a sender
/// says does not arrive, and the reader turns in circles.
SharedMemoryUsers UsersOfSharedMemory(const std::filesystem::path& folder = "/dev/shm");

/// Number of a port of shared memory that no process had before. The library would number ports by domain and
/// participant, so that a process started in place of a killed one gets the same: who still has the dead
/// one's port mapped then sends into nothing until a timeout tells, seen for up to 4.4 s.
std::uint32_t UnusedSharedMemoryPort();

}  // namespace hydroscope
