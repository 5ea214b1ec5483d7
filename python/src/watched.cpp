#include "watched.hpp"

#include <nanobind/stl/string.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

namespace underbrush::python {
namespace {

/// Ends the work of a call whose caller has raised.
struct Ended : std::exception {
  const char* what() const noexcept override { return "the call was ended"; }
};

/// What the working and the waiting thread share.
struct Watch {
  std::mutex mutex;
  std::condition_variable finish;
  bool finished = false, changed = false;
  std::string stage;
  size_t done = 0, total = 0;
  std::atomic<bool> stop = false;

  void report(std::string_view at, size_t d, size_t t) {
    if (stop) throw Ended();
    const std::lock_guard lock(mutex);
    stage = at;
    done = d;
    total = t;
    changed = true;
  }

  /// Waits a moment; returns whether the work has ended.
  bool wait() {
    std::unique_lock lock(mutex);
    return finish.wait_for(lock, std::chrono::milliseconds(50), [&] { return finished; });
  }
};

/// Runs signal handlers and reports the progress. Throws `nb::python_error`. The GIL must be held.
void look_up(Watch& watch, const nb::object& progress) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  std::string stage;
  size_t done = 0, total = 0;
  {
    const std::lock_guard lock(watch.mutex);
    if (!watch.changed || progress.is_none()) return;
    watch.changed = false;
    stage = watch.stage;
    done = watch.done;
    total = watch.total;
  }
  progress(stage, done, total);
}

}  // namespace

void run_watched(const nb::object& progress, const std::function<void(const Hook&)>& work) {
  Watch watch;
  const Hook hook = [&](std::string_view s, size_t d, size_t t) { watch.report(s, d, t); };
  std::exception_ptr failure, raised;
  {
    const nb::gil_scoped_release released;
    std::thread worker([&] {
      try {
        work(hook);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(watch.mutex);
      watch.finished = true;
      watch.finish.notify_all();
    });
    while (!watch.wait()) {
      if (watch.stop) continue;
      const nb::gil_scoped_acquire held;
      try {
        look_up(watch, progress);
      } catch (...) {
        raised = std::current_exception();
        watch.stop = true;
      }
    }
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (failure) std::rethrow_exception(failure);
  look_up(watch, progress);
}

void WatchedSource::rewind() {
  source_.rewind();
  done_ = 0;
}

bool WatchedSource::next(BeamLog& chunk) {
  hook_(stage_, done_, source_.size());
  const bool more = source_.next(chunk);
  done_ += chunk.size();
  return more;
}

}  // namespace underbrush::python
