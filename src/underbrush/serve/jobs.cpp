#include "underbrush/serve/jobs.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "underbrush/core/check.hpp"

namespace underbrush::serve {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kMostLog = 65536;
constexpr size_t kMostJobs = 1000;
constexpr size_t kMostRunning = 2;
constexpr std::chrono::seconds kGrace{5};

// Becomes the program; runs in the child, where only calls that are safe after fork may be made.
[[noreturn]] void become(const char* device, const std::vector<char*>& words, pid_t parent) {
  ::setsid();
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(126);
  const int nothing = ::open("/dev/null", O_RDONLY), terminal = ::open(device, O_RDWR);
  if (nothing < 0 || terminal < 0) ::_exit(126);
  ::dup2(nothing, 0);
  ::dup2(terminal, 1);
  ::dup2(terminal, 2);
  // Connections and files of the server are none of the program's business.
  constexpr int kFirst = 3, kLikely = 1024;
#ifdef SYS_close_range
  const bool closed = ::syscall(SYS_close_range, unsigned(kFirst), ~0u, 0u) == 0;
#else
  const bool closed = false;
#endif
  for (int fd = kFirst; !closed && fd < kLikely; ++fd) ::close(fd);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::signal(SIGPIPE, SIG_DFL);
  ::execv(words[0], words.data());
  ::_exit(127);
}

}  // namespace

const char* name(JobState state) {
  switch (state) {
    case JobState::kRunning:
      return "running";
    case JobState::kDone:
      return "done";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      break;
  }
  return "cancelled";
}

struct Jobs::Job {
  JobFacts facts;
  std::function<void()> done;
  Clock::time_point begin = Clock::now();
  std::atomic<bool> cancelled{false};
  std::mutex mutex;  ///< Guards `facts`.
  std::thread thread;

  // Adds what was printed. A carriage return begins the line anew, as a terminal does.
  void print(std::string_view text) {
    const std::lock_guard lock(mutex);
    for (const char c : text) {
      if (c == '\n') {
        facts.log += facts.progress + '\n';
        facts.progress.clear();
      } else if (c == '\r') {
        line_over = true;
      } else {
        if (line_over) facts.progress.clear();
        line_over = false;
        if (facts.progress.size() < 4096) facts.progress += c;
      }
      if (c == '\n') line_over = false;
    }
    if (facts.log.size() > kMostLog) facts.log.erase(0, facts.log.size() - kMostLog);
  }
  bool line_over = false;
};

Jobs::Jobs() = default;

Jobs::~Jobs() {
  for (const auto& job : jobs_) job->cancelled = true;
  for (const auto& job : jobs_) job->thread.join();
}

// Runs on the job's thread: the child dies with this thread at the latest.
void Jobs::follow(Job& job, int terminal, const std::string& device) {
  std::vector<char*> words;
  for (std::string& word : job.facts.command) words.push_back(word.data());
  words.push_back(nullptr);
  const pid_t parent = ::getpid();
  const int held = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  const pid_t child = ::fork();
  if (child == 0) become(device.c_str(), words, parent);
  if (child < 0) job.print(std::string("no new process: ") + std::strerror(errno) + "\n");
  int status = 127 << 8;  // of a child that cannot be waited for
  bool ended = child < 0, asked = false;
  Clock::time_point kill_at;
  while (true) {
    pollfd wanted{terminal, POLLIN, 0};
    const bool some = ::poll(&wanted, 1, ended ? 0 : 100) > 0 && (wanted.revents & POLLIN);
    char text[4096];
    const ssize_t got = some ? ::read(terminal, text, sizeof(text)) : 0;
    if (got > 0) {
      job.print(std::string_view(text, size_t(got)));
      continue;
    }
    if (ended) break;
    if (job.cancelled && !asked) {
      asked = true;
      kill_at = Clock::now() + kGrace;
      ::kill(child, SIGINT);
    } else if (asked && Clock::now() > kill_at) {
      ::kill(child, SIGKILL);
    }
    const pid_t found = ::waitpid(child, &status, WNOHANG);
    ended = found == child || (found < 0 && errno != EINTR);
  }
  ::close(held);
  ::close(terminal);
  JobState state = child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0 ? JobState::kDone
                   : job.cancelled                                            ? JobState::kCancelled
                                                                              : JobState::kFailed;
  try {
    if (state == JobState::kDone && job.done) job.done();
  } catch (const std::exception& e) {
    job.print(std::string(e.what()) + "\n");
    state = JobState::kFailed;
  }
  job.print(job.facts.progress.empty() ? "" : "\n");
  const std::lock_guard lock(job.mutex);
  job.facts.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  job.facts.seconds = std::chrono::duration<double>(Clock::now() - job.begin).count();
  job.facts.state = state;
}

size_t Jobs::start(std::vector<std::string> command, std::function<void()> done) {
  const std::lock_guard lock(mutex_);
  require(jobs_.size() < kMostJobs, "a thousand jobs were run: start the program anew");
  const auto running = std::count_if(jobs_.begin(), jobs_.end(), [](const auto& job) {
    const std::lock_guard inner(job->mutex);
    return job->facts.state == JobState::kRunning;
  });
  require(size_t(running) < kMostRunning, "two commands are running: wait for one of them");
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  char device[128];
  if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0 ||
      ::ptsname_r(terminal, device, sizeof(device)) != 0) {
    if (terminal >= 0) ::close(terminal);
    throw IoError(std::string("no terminal for a command: ") + std::strerror(errno));
  }
  auto job = std::make_unique<Job>();
  job->facts.number = jobs_.size();
  job->facts.command = std::move(command);
  job->done = std::move(done);
  Job& started = *job;
  jobs_.push_back(std::move(job));
  started.thread = std::thread(
      [&started, terminal, path = std::string(device)] { follow(started, terminal, path); });
  return started.facts.number;
}

Jobs::Job& Jobs::at(size_t number) const {
  const std::lock_guard lock(mutex_);
  require(number < jobs_.size(), "no such command");
  return *jobs_[number];
}

void Jobs::cancel(size_t number) { at(number).cancelled = true; }

JobFacts Jobs::facts_of(Job& job, bool with_log) {
  const std::lock_guard lock(job.mutex);
  const JobFacts& now = job.facts;
  JobFacts out{now.number, now.command, now.state, now.exit_code, now.seconds, {}, now.progress};
  if (with_log) out.log = now.log;
  if (out.state == JobState::kRunning) {
    out.seconds = std::chrono::duration<double>(Clock::now() - job.begin).count();
  }
  return out;
}

JobFacts Jobs::job(size_t number) const { return facts_of(at(number), true); }

std::vector<JobFacts> Jobs::list() const {
  std::vector<JobFacts> out;
  const size_t n = [&] {
    const std::lock_guard lock(mutex_);
    return jobs_.size();
  }();
  for (size_t k = 0; k < n; ++k) {
    out.push_back(facts_of(at(k), false));
  }
  return out;
}

}  // namespace underbrush::serve
