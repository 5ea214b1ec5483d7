/// \file
/// Long calls: other Python threads run meanwhile, Ctrl-C ends them, and they report progress.
#pragma once
#include <nanobind/nanobind.h>

#include <functional>
#include <string_view>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::python {
namespace nb = nanobind;

/// A function of (stage, done, total), for any thread. It throws where the call is to end early.
using Hook = std::function<void(std::string_view, size_t, size_t)>;

/// Returns a function for the progress of one stage, (done, total). The hook must outlive it.
inline std::function<void(size_t, size_t)> of_stage(const Hook& hook, std::string_view stage) {
  return [&hook, stage](size_t done, size_t total) { hook(stage, done, total); };
}

/// Runs `work` on a thread of its own, while the calling thread, without the GIL, waits for it. Up
/// to 20 times a second it calls `progress(stage, done, total)` (unless that is None) and lets
/// Python run its signal handlers. Where either raises, the next call of the hook ends the work and
/// the exception is passed on. The GIL must be held.
void run_watched(const nb::object& progress, const std::function<void(const Hook&)>& work);

/// A source that calls the hook with `stage` before it reads a chunk of another source, which must
/// outlive it, as must the hook.
class WatchedSource : public BeamSource {
 public:
  WatchedSource(BeamSource& source, const Hook& hook, std::string_view stage)
      : source_(source), hook_(hook), stage_(stage) {}
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return source_.size(); }
  void rewind() override;
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  const Hook& hook_;
  std::string_view stage_;
  size_t done_ = 0;
};

}  // namespace underbrush::python
