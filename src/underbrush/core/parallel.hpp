/// \file
/// Parallel loops. Results must not depend on the number of threads: each index writes its own
/// place, or the pieces are merged in order of index.
#pragma once
#include <cstddef>
#include <functional>

namespace underbrush {

/// Limits the threads used from here on by this process; 0 = all of the machine's.
void set_threads(int threads);
/// Number of threads in use.
int threads();

/// Calls `body(begin, end)` for disjoint ranges that cover [0, n), each at most `grain` long, on
/// all threads. The ranges' bounds are multiples of `grain`, whatever the number of threads. Of
/// exceptions in `body` the first in order is passed on.
void parallel_for(size_t n, size_t grain, const std::function<void(size_t, size_t)>& body);

/// Calls `work(k)` for k in [0, n) on all threads, and after each `finish(k)`, in order and never
/// two at a time. At most `ahead` of them are under way or wait for their turn to finish. Of
/// exceptions the first in order is passed on, once all before it are finished.
void parallel_in_order(size_t n, size_t ahead, const std::function<void(size_t)>& work,
                       const std::function<void(size_t)>& finish);

/// Calls both, at the same time if a thread is free. Of exceptions that of `a` is passed on before
/// that of `b`; the other call is not cut short.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

}  // namespace underbrush
