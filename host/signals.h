#pragma once

#include <csignal>
#include <initializer_list>

namespace hydroscope {

/// Blocks `numbers` in this thread and in all that it begins, for sigtimedwait to take them. A thread that is there
/// already, as a library of linear algebra begins some when it is loaded, passes on what reaches it, in place of ending
/// the program. Returns the set.
sigset_t LeaveToSignalWait(std::initializer_list<int> numbers);

}  // namespace hydroscope
