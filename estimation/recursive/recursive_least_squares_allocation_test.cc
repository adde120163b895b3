#include <gtest/gtest.h>

#include <vector>

#include "estimation/recursive/recursive_least_squares.h"
#include "simulator/random.h"
#include "tests/counting_new.h"

namespace hydroscope {
namespace {

TEST(RecursiveLeastSquares, UpdatesDoNotTouchTheHeap) {
  RandomStream random(1);
  for (Forgetting form : {Forgetting::kNone, Forgetting::kExponential, Forgetting::kDirectional}) {
    RecursiveLeastSquares::Options options;
    options.forgetting = form;
    options.clip = 4;
    RecursiveLeastSquares rls(std::vector<double>(6, 0.0), options);
    std::vector<double> u(6);
    const AllocationCount count;
    for (int k = 0; k < 10'000; ++k) {
      for (double& x : u) x = random.Normal();
      rls.Update(u, u[0] + random.Normal());
    }
    EXPECT_EQ(count.value(), 0);
  }
}

TEST(CountingNew, SeesAnAllocation) {
  const AllocationCount count;
  const std::vector<double> grows(100, 1.0);
  EXPECT_EQ(grows.size(), 100u);
  EXPECT_GE(count.value(), 1);
}

}  // namespace
}  // namespace hydroscope
