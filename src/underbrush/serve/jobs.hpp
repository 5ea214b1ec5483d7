/// \file
/// Commands that run as programs of their own, with their output and a way to end them.
#pragma once
#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace underbrush::serve {

/// The state of a job: running, or the way in which it ended.
enum class JobState { kRunning, kDone, kFailed, kCancelled };

/// Returns "running", "done", "failed" or "cancelled".
const char* name(JobState state);

/// The present state of a job.
struct JobFacts {
  size_t number = 0;
  std::vector<std::string> command;
  JobState state = JobState::kRunning;
  int exit_code = 0;
  double seconds = 0;
  std::string log;       ///< The last 64 KiB of the program's output, without `progress`.
  std::string progress;  ///< The line that the program is drawing.
};

/// Runs programs. Each has a terminal of its own for its output, so that it shows its progress;
/// nothing can be typed into it. A job ends with this process, however that ends.
class Jobs {
 public:
  Jobs();
  /// Ends the jobs that are running.
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  /// Starts a program; the first word is its path. `done` is called on another thread once it has
  /// ended well, before its state becomes `kDone`. Returns the job's number. Throws
  /// `std::invalid_argument` while two jobs are running or after a thousand jobs, and `IoError`.
  size_t start(std::vector<std::string> command, std::function<void()> done = {});
  /// Ends a job: by SIGINT, and by SIGKILL if it still runs 5 s later.
  void cancel(size_t number);
  /// All jobs, the oldest first; logs are left out.
  std::vector<JobFacts> list() const;
  /// A job. Throws `std::invalid_argument` for a number that there is not.
  JobFacts job(size_t number) const;

 private:
  struct Job;
  Job& at(size_t number) const;
  static JobFacts facts_of(Job& job, bool with_log);
  static void follow(Job& job, int terminal, const std::string& device);

  mutable std::mutex mutex_;  ///< Guards the list.
  std::vector<std::unique_ptr<Job>> jobs_;
};

}  // namespace underbrush::serve
