// The parallel loops of core/parallel.hpp for an FMU. oneTBB would be a shared library with a pool
// of threads for the whole process; here each call has threads of its own, and their number is
// that of the instance that the calling thread works for.
#include "underbrush/core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace underbrush {
namespace {

thread_local int wanted = 1;

// Runs work(k) for k in [0, n) on several threads. Returns the lowest k that threw (n if none did)
// and its exception.
std::pair<size_t, std::exception_ptr> run_all(size_t n, const std::function<void(size_t)>& work) {
  std::atomic<size_t> next = 0;
  std::mutex guard;
  size_t failed = n;
  std::exception_ptr error;
  const auto run = [&] {
    for (size_t k = next++; k < n; k = next++) {
      try {
        work(k);
      } catch (...) {
        const std::lock_guard lock(guard);
        if (k < failed) {
          failed = k;
          error = std::current_exception();
        }
      }
    }
  };
  {
    std::vector<std::jthread> helpers;  // Loops inside a loop run on the thread that they are on.
    for (size_t k = 1; k < std::min(n, size_t(wanted)); ++k) helpers.emplace_back(run);
    const int before = wanted;
    wanted = 1;
    run();
    wanted = before;
  }
  return {failed, error};
}

}  // namespace

void set_threads(int threads) {
  wanted = threads > 0 ? threads : int(std::max(1u, std::thread::hardware_concurrency()));
}

int threads() { return wanted; }

void parallel_for(size_t n, size_t grain, const std::function<void(size_t, size_t)>& body) {
  grain = std::max<size_t>(grain, 1);
  const auto piece = [&](size_t k) { body(k * grain, std::min(n, (k + 1) * grain)); };
  const auto error = run_all((n + grain - 1) / grain, piece).second;
  if (error) std::rethrow_exception(error);
}

void parallel_in_order(size_t n, size_t ahead, const std::function<void(size_t)>& work,
                       const std::function<void(size_t)>& finish) {
  ahead = std::max<size_t>(ahead, 1);
  for (size_t begin = 0; begin < n; begin += ahead) {
    const auto [failed, error] =
        run_all(std::min(ahead, n - begin), [&](size_t k) { work(begin + k); });
    for (size_t k = begin; k < begin + failed; ++k) finish(k);
    if (error) std::rethrow_exception(error);
  }
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  const auto error = run_all(2, [&](size_t k) { k == 0 ? a() : b(); }).second;
  if (error) std::rethrow_exception(error);
}

struct Background::Impl {
  std::function<void()> work;  // which is done where it is waited for
};

Background::Background() : impl_(std::make_unique<Impl>()) {}

Background::~Background() = default;

void Background::start(std::function<void()> work) { impl_->work = std::move(work); }

void Background::wait() {
  if (const auto work = std::exchange(impl_->work, nullptr)) work();
}

}  // namespace underbrush
