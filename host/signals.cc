#include "host/signals.h"

#include <ucontext.h>
#include <unistd.h>

namespace hydroscope {
namespace {

/// Runs in a thread that does not block the signal: it does from now on, and the signal is sent once more.
void PassOn(int number, siginfo_t*, void* context) {
  sigaddset(&static_cast<ucontext_t*>(context)->uc_sigmask, number);
  kill(getpid(), number);
}

}  // namespace

sigset_t LeaveToSignalWait(std::initializer_list<int> numbers) {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : numbers) sigaddset(&set, number);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  struct sigaction action = {};
  action.sa_sigaction = PassOn;
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  for (const int number : numbers) sigaction(number, &action, nullptr);
  return set;
}

}  // namespace hydroscope
