// Starts a program once and runs it many times. Preloaded into the program, it waits where `main` would begin: each
// byte that arrives on the descriptor kRequests starts a copy of the process, which goes on into `main`. The answers on
// kAnswers are the copy's process number (int32), then its wait status (int32), its processor time in µs and the most
// memory that it held in KiB (int64 each).
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { kRequests = 198, kAnswers = 199 };
typedef int Main(int, char**, char**);
static Main* program_main;

static void answer(const void* bytes, size_t count) {
  if (write(kAnswers, bytes, count) != (ssize_t)count) _exit(125);
}

static int serve(int argc, char** argv, char** environment) {
  char byte;
  while (read(kRequests, &byte, 1) == 1) {
    const int32_t child = fork();
    if (child == 0) {
      close(kRequests);
      close(kAnswers);
      return program_main(argc, argv, environment);
    }
    answer(&child, sizeof child);
    int status = 0;
    struct rusage used;
    if (child < 0 || wait4(child, &status, 0, &used) != child) _exit(125);
    const int32_t ended = status;
    const int64_t used_kib = used.ru_maxrss, processor_us = (used.ru_utime.tv_sec + used.ru_stime.tv_sec) * INT64_C(1000000) +
                                 used.ru_utime.tv_usec + used.ru_stime.tv_usec;
    answer(&ended, sizeof ended);
    answer(&processor_us, sizeof processor_us);
    answer(&used_kib, sizeof used_kib);
  }
  _exit(0);
}

// Takes the place of the C library's function, which calls `main`.
int __libc_start_main(Main* program, int argc, char** argv, Main* init, void (*fini)(void),
                      void (*end)(void), void* stack) {
  __typeof__(__libc_start_main)* const real =
      (__typeof__(__libc_start_main)*)dlsym(RTLD_NEXT, "__libc_start_main");
  program_main = program;
  unsetenv("LD_PRELOAD");
  return real(serve, argc, argv, init, fini, end, stack);
}
