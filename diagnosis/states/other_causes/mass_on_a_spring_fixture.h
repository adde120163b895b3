#pragma once

#include <gtest/gtest.h>

#include "models/machine.h"

namespace hydroscope {

/// A mass on a spring that is moved by the spring's other end; drag may be missing.
inline Machine MassOnASpring() {
  const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "1" }
y = { column = "y", unit = "1" }
[states]
x = { ddt = "v", initial = "estimate" }
v = { ddt = "w0^2*(u - x) - d*v", initial = "estimate" }
[outputs]
y = "x"
[parameters]
w0 = { start = 170, min = 30, max = 800 }
d = { start = 15, min = 1, max = 300 }

[[effect]]
id = "drag"
adds = { v = "-q*v*abs(v)" }
parameters = { q = { start = 0.1, min = 0, max = 100 } }
)toml",
                                    "mass");
  EXPECT_TRUE(machine) << machine.error().text;
  return *machine;
}

}  // namespace hydroscope
