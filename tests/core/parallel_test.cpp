#include "underbrush/core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
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

TEST(ParallelInOrder, FinishesInOrderAndKeepsFewWaiting) {
  for (int n_threads : {1, 2, 0}) {
    set_threads(n_threads);
    std::atomic<size_t> begun{0};
    std::vector<size_t> finished;
    parallel_in_order(
        500, 7,
        [&](size_t k) {
          ++begun;
          volatile double x = 0;  // the first of every ten takes longest
          for (int i = 0; i < (k % 10 ? 10 : 20000); ++i) x = x + 1;
        },
        [&](size_t k) {
          EXPECT_LE(begun, finished.size() + 7);
          finished.push_back(k);
        });
    ASSERT_EQ(finished.size(), 500u);
    for (size_t k = 0; k < 500; ++k) EXPECT_EQ(finished[k], k);
  }
  set_threads(0);
  parallel_in_order(
      0, 4, [](size_t) { FAIL(); }, [](size_t) { FAIL(); });
}

TEST(ParallelInOrder, PassesAnExceptionOn) {
  const auto fails = [](size_t k) {
    if (k == 57) throw std::runtime_error("x");
  };
  const auto nothing = [](size_t) {};
  EXPECT_THROW(parallel_in_order(100, 4, fails, nothing), std::runtime_error);
  EXPECT_THROW(parallel_in_order(100, 4, nothing, fails), std::runtime_error);
}

// An exception in one call does not cut short a loop inside another call.
TEST(ParallelInvoke, AnExceptionCutsNoOtherLoopShort) {
  for (int round = 0; round < 100; ++round) {
    std::atomic<bool> begun = false;
    std::atomic<size_t> done = 0;
    const auto loop = [&] {
      parallel_for(1000, 1, [&](size_t, size_t) {
        begun = true;
        volatile double x = 0;
        for (int i = 0; i < 1000; ++i) x = x + 1;
        ++done;
      });
      EXPECT_EQ(done, 1000u);
    };
    const auto fail = [&] {
      for (int k = 0; k < 100000 && !begun; ++k) std::this_thread::yield();
      throw std::runtime_error("x");
    };
    EXPECT_THROW(parallel_invoke(loop, fail), std::runtime_error);
    EXPECT_EQ(done, 1000u);
  }
}

// Whichever call throws first in time, the caller gets the exception that is first in order, and
// everything before it is finished. Nothing crashes where many calls throw.
TEST(ParallelInOrder, TheFirstExceptionInOrderCounts) {
  for (int round = 0; round < 2000; ++round) {
    std::vector<size_t> finished;
    const auto fail = [](size_t k) {
      if (k >= 11) throw std::runtime_error(std::to_string(k));
    };
    try {
      parallel_in_order(200, 16, fail, [&](size_t k) { finished.push_back(k); });
      FAIL();
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "11");
    }
    ASSERT_EQ(finished.size(), 11u);
  }
}

}  // namespace
}  // namespace underbrush
