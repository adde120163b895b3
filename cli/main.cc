#include <csignal>

#include "cli/commands.h"
#include "host/resident_memory.h"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error of the write, as a full disk is
  hydroscope::KeepFreedMemory();
  hydroscope::UseHugePages();
  return hydroscope::RunCommandLine(argc, argv);
}
