/// \file
/// A vector on huge pages where the system grants them: a traversal touches memory at random, and
/// with small pages half of its time would go into address translation.
#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

namespace underbrush::trace {

/// Aligns to 64 bytes, large blocks to 2 MiB and asks for huge pages there.
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
    if (align == kHuge) madvise(p, bytes, MADV_HUGEPAGE);  // a hint: refused is fine
    return static_cast<T*>(p);
  }
  void deallocate(T* p, size_t) { std::free(p); }
  /// Nothing is written before its owner writes it.
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

template <class T>
using HugeVector = std::vector<T, HugeAllocator<T>>;

}  // namespace underbrush::trace
