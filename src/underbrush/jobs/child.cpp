#include "underbrush/jobs/child.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "underbrush/core/check.hpp"

namespace underbrush::jobs {
namespace {

// Becomes the program; runs in the child, where only calls that are safe after fork may be made.
[[noreturn]] void become(const char* printed, const std::vector<char*>& words, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(126);
  const int nothing = ::open("/dev/null", O_RDONLY);
  const int file = ::open(printed, O_WRONLY | O_CREAT | O_EXCL, 0600);
  if (nothing < 0 || file < 0) ::_exit(126);
  ::dup2(nothing, 0);
  ::dup2(file, 1);
  ::dup2(file, 2);
  ::execvp(words[0], words.data());
  ::_exit(127);
}

}  // namespace

std::vector<std::string> started(std::vector<std::string> command, const std::string& program) {
  if (command.at(0) == kStudy) {
    command[0] = std::filesystem::path(program).parent_path() / "underbrush-study";
    if (!std::filesystem::exists(command[0])) {
      throw IoError(command[0] + " is not there: studies are built from the source");
    }
  } else {
    command.insert(command.begin(), program);
  }
  return command;
}

bool has_ended(const std::vector<std::string>& command, int exit_code) {
  return exit_code == 0 || (exit_code == 1 && command.at(0) == kStudy);
}

ChildEnd run_child(std::vector<std::string> words, const std::filesystem::path& printed) {
  using Clock = std::chrono::steady_clock;
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid();
  // The peak memory of a process counts what it has between fork and exec, a copy of this process.
  ::malloc_trim(0);
  const auto begin = Clock::now();
  const pid_t child = ::fork();
  if (child == 0) become(printed.c_str(), pointers, parent);
  int status = 0;
  rusage used{};
  pid_t ended = child;
  while (child > 0 && (ended = ::wait4(child, &status, 0, &used)) < 0 && errno == EINTR) {
  }
  if (ended < 0) throw IoError(words[0] + ": no new process: " + std::strerror(errno));
  ChildEnd out;
  out.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  out.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  for (const timeval& t : {used.ru_utime, used.ru_stime}) {
    out.processor_s += double(t.tv_sec) + 1e-6 * double(t.tv_usec);
  }
  out.peak_memory_bytes = uint64_t(used.ru_maxrss) * 1024;
  return out;
}

}  // namespace underbrush::jobs
