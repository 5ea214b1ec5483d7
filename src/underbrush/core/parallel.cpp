#include "underbrush/core/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/parallel_sort.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <utility>

namespace underbrush {
namespace {
std::unique_ptr<tbb::global_control>& limit() {
  static std::unique_ptr<tbb::global_control> control;
  return control;
}

/// Holds the exception of the first task (in order) that failed. No exception may reach oneTBB: it
/// would also cancel loops inside other tasks, and these would go on with half-done results.
class FirstException {
 public:
  explicit FirstException(size_t tasks) : failed_(tasks) {}
  /// Returns the number of the first task that failed; if none did, the number of tasks.
  size_t failed() const { return failed_; }
  /// Runs task k unless a task before it has failed.
  template <class Task>
  void run(size_t k, const Task& task) {
    if (k >= failed_) return;
    try {
      task();
    } catch (...) {
      const std::lock_guard lock(guard_);
      if (k >= failed_) return;
      failed_ = k;
      error_ = std::current_exception();
    }
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex guard_;
  std::exception_ptr error_;
  std::atomic<size_t> failed_;
};

}  // namespace

void set_threads(int threads) {
  limit().reset();
  if (threads > 0) {
    limit() = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    size_t(threads));
  }
}

int threads() {
  return int(std::min<size_t>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
      size_t(tbb::info::default_concurrency())));
}

void parallel_for(size_t n, size_t grain, const std::function<void(size_t, size_t)>& body) {
  if (n == 0) return;
  grain = std::max<size_t>(grain, 1);
  const size_t pieces = (n + grain - 1) / grain;
  if (pieces == 1) return body(0, n);
  FirstException first(pieces);
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, pieces, 1),
      [&](const tbb::blocked_range<size_t>& r) {
        for (size_t k = r.begin(); k < r.end(); ++k) {
          first.run(k, [&] { body(k * grain, std::min(n, (k + 1) * grain)); });
        }
      },
      tbb::simple_partitioner());
  first.rethrow();
}

void parallel_in_order(size_t n, size_t ahead, const std::function<void(size_t)>& work,
                       const std::function<void(size_t)>& finish) {
  FirstException first(n);
  size_t next = 0;
  const auto number = [&](tbb::flow_control& control) {
    if (next >= first.failed()) control.stop();
    return next++;
  };
  const auto worked = [&](size_t k) {
    first.run(k, [&] { work(k); });
    return k;
  };
  const auto finished = [&](size_t k) { first.run(k, [&] { finish(k); }); };
  tbb::parallel_pipeline(
      std::max<size_t>(ahead, 1),
      tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, number) &
          tbb::make_filter<size_t, size_t>(tbb::filter_mode::parallel, worked) &
          tbb::make_filter<size_t, void>(tbb::filter_mode::serial_in_order, finished));
  first.rethrow();
}

void sort_keys(std::vector<std::array<uint64_t, 2>>& keys) {
  tbb::parallel_sort(keys.begin(), keys.end());
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  FirstException first(2);
  tbb::parallel_invoke([&] { first.run(0, a); }, [&] { first.run(1, b); });
  first.rethrow();
}

struct Background::Impl {
  tbb::task_group group;
  std::exception_ptr error;
};

Background::Background() : impl_(std::make_unique<Impl>()) {}

Background::~Background() { impl_->group.wait(); }

void Background::start(std::function<void()> work) {
  impl_->group.run([this, work = std::move(work)] {
    try {
      work();
    } catch (...) {
      impl_->error = std::current_exception();
    }
  });
}

void Background::wait() {
  impl_->group.wait();
  if (const std::exception_ptr error = std::exchange(impl_->error, nullptr)) {
    std::rethrow_exception(error);
  }
}

}  // namespace underbrush
