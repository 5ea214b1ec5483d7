/// \file
/// This file has a vector on huge pages. A traversal accesses memory at random and would spend half
/// of its time on address translation with small pages.
#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

namespace underbrush::trace {

/// An allocator that aligns to 64 bytes, and blocks of 2 MiB or more to 2 MiB. It asks for huge
/// pages for the latter.
template <class T>
struct HugeAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard's name
  HugeAllocator() = default;
  template <class U>
  HugeAllocator(const HugeAllocator<U>&) {}

  T* allocate(size_t n) {
    constexpr size_t kHuge = size_t(2) << 20;
    const size_t align = n * sizeof(T) >= kHuge ? kHuge : 64;
    const size_t bytes = (n * sizeof(T) + align - 1) / align * align;
    void* p = std::aligned_alloc(align, bytes);
    if (!p) throw std::bad_alloc();
    if (align == kHuge) madvise(p, bytes, MADV_HUGEPAGE);  // a hint, which the system may refuse
    return static_cast<T*>(p);
  }
  void deallocate(T* p, size_t) { std::free(p); }
  /// Leaves an element uninitialised, so that the thread that fills it is the first to touch its
  /// memory.
  template <class U>
  void construct(U* p) {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
  bool operator==(const HugeAllocator&) const { return true; }
};

/// A vector whose memory comes from `HugeAllocator`. Its elements begin uninitialised.
template <class T>
using HugeVector = std::vector<T, HugeAllocator<T>>;

}  // namespace underbrush::trace
