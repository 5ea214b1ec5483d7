// Debian's static libraries read this variable of glibc in a way that only programs can. The FMU
// has one of its own, which says that there may be several threads.
extern "C" {
__attribute__((visibility("hidden"))) char __libc_single_threaded = 0;  // NOLINT
}
