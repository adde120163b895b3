#pragma once

namespace hydroscope {

/// A DDS domain for tests and benchmarks, which run beside one another: none that another process of this computer holds by now
/// (until it ends), and none whose ports (7400 + 250 for each domain) lie where the system gives out ports of its own, from 32768
/// on: a participant whose port for announcements is taken hears nobody. The demo has domain 92.
int FreeDomain();

}  // namespace hydroscope
