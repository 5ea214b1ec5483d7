#include "underbrush/core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace underbrush {
namespace {

TEST(ParallelFor, VisitsEachIndexOnceInPiecesThatDoNotDependOnThreads) {
  for (int n_threads : {1, 2, 0}) {
    set_threads(n_threads);
    std::vector<int> seen(1003);
    std::atomic<int> odd_starts{0};
    parallel_for(seen.size(), 10, [&](size_t begin, size_t end) {
      if (begin % 10 || end - begin > 10) ++odd_starts;
      for (size_t i = begin; i < end; ++i) ++seen[i];
    });
    EXPECT_EQ(odd_starts, 0);
    EXPECT_EQ(seen, std::vector<int>(1003, 1));
  }
  set_threads(0);
}

TEST(ParallelFor, PassesAnExceptionOn) {
  EXPECT_THROW(parallel_for(100, 1,
                            [](size_t i, size_t) {
                              if (i == 57) throw std::runtime_error("x");
                            }),
               std::runtime_error);
}

TEST(ParallelFor, OfNothingDoesNothing) {
  parallel_for(0, 1, [](size_t, size_t) { FAIL(); });
}

}  // namespace
}  // namespace underbrush
