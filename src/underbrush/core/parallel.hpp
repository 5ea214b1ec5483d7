/// \file
/// Parallel loops. Their results must not depend on the number of threads: each index writes its
/// own place, or the pieces are merged in order of index.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace underbrush {

/// Limits the number of threads that this process uses from now on; 0 removes the limit.
void set_threads(int threads);
/// Returns the number of threads in use.
int threads();

/// Calls `body(begin, end)` for disjoint ranges that cover [0, n), on all threads. A range begins
/// at a multiple of `grain` and is at most `grain` long, whatever the number of threads. If several
/// calls throw, the exception of the first range is passed on.
void parallel_for(size_t n, size_t grain, const std::function<void(size_t, size_t)>& body);

/// Calls `work(k)` for each k in [0, n) on all threads, and after each of them `finish(k)`, in
/// order of k and never two at a time. At most `ahead` values of k are at work or wait for
/// `finish`. If several calls throw, the exception of the lowest k is passed on, once all k below
/// it are finished.
void parallel_in_order(size_t n, size_t ahead, const std::function<void(size_t)>& work,
                       const std::function<void(size_t)>& finish);

/// Sorts distinct keys of two words in ascending order, on all threads.
void sort_keys(std::vector<std::array<uint64_t, 2>>& keys);

/// Calls `a` and `b`, at the same time if a thread is free. If both throw, the exception of `a` is
/// passed on. An exception of one call does not interrupt the other.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

/// Calls that go on beside their caller while a thread is free, one at a time.
class Background {
 public:
  Background();
  ~Background();  ///< Waits, and drops an exception.
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// Begins a call. The one before must have been waited for.
  void start(std::function<void()> work);
  /// Waits for the call, if there is one; the waiting thread takes part in it. Passes its exception
  /// on.
  void wait();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace underbrush
