#include "underbrush/osi/readable.hpp"

#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <vector>

namespace underbrush::osi {
namespace {

constexpr size_t kAtOnce = 1024;  // pieces of one system call (IOV_MAX)

}  // namespace

// Lets the system read a byte of each page: it says where it cannot, and raises no signal.
bool is_readable(std::string_view bytes) {
  if (bytes.empty()) return true;
  const auto page = uint64_t(::sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<uint64_t>(bytes.data());
  const uint64_t last = begin + (bytes.size() - 1);
  if (last < begin) return false;
  std::vector<iovec> from;
  char byte = 0;
  for (uint64_t at = begin;; at = (at / page + 1) * page) {
    if (at <= last) from.push_back({reinterpret_cast<void*>(at), 1});  // NOLINT
    const bool is_end = at > last || at / page == last / page;
    if (from.size() == kAtOnce || (is_end && !from.empty())) {
      std::vector<iovec> to(from.size(), iovec{&byte, 1});
      const ssize_t got =
          ::process_vm_readv(::getpid(), to.data(), to.size(), from.data(), from.size(), 0);
      if (got < 0 && errno != EFAULT) return true;  // not allowed here
      if (got != ssize_t(from.size())) return false;
      from.clear();
    }
    if (is_end) return true;
  }
}

}  // namespace underbrush::osi
