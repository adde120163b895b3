#pragma once

namespace hydroscope {

/// Fast DDS locks and waits in shared memory until a time of the computer's clock, a second or a third of one ahead
/// (`pthread_mutex_timedlock`, `sem_timedwait`; a lock that comes too late counts as a broken port, and what was to be sent
/// is lost). Both functions are replaced in this program: they wait as long as there was to go when they were called, by the
/// monotonic clock, so that a step of the computer's clock neither ends a wait nor makes it last for hours.
///
/// Whether the library meets these functions and not those of somebody else.
bool TimedWaitsAreSteady();

}  // namespace hydroscope
