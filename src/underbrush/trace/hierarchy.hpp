/// \file
/// This file has a tree of boxes with eight children per node, over anything that has a box.
#pragma once
#include <cstdint>
#include <cstring>
#include <vector>

#include "underbrush/trace/huge_vector.hpp"

namespace underbrush::trace {

inline constexpr int kWidth = 8;

/// The bits of a child reference. It is either the index of an inner node, or kLeaf | kind | index.
inline constexpr uint32_t kLeaf = 0x80000000u, kKindMask = 0x60000000u, kIndexMask = 0x1fffffffu;
/// The reference to the root of an empty tree.
inline constexpr uint32_t kEmpty = 0xffffffffu;

/// A node: the boxes of eight children as lo[axis][child] and hi[axis][child], with inverted boxes
/// where there is no child.
struct alignas(64) Node {
  float lo[3][kWidth], hi[3][kWidth];
  uint32_t child[kWidth];
  uint32_t unused[kWidth];
};

/// Four floats for vector instructions.
typedef float Float4 __attribute__((vector_size(16)));

/// An axis-aligned box. Its fourth lane is unused.
struct Box {
  Float4 lo{__builtin_inff(), __builtin_inff(), __builtin_inff(), 0};
  Float4 hi{-__builtin_inff(), -__builtin_inff(), -__builtin_inff(), 0};

  void add(const Float4& low, const Float4& high) {
    lo = low < lo ? low : lo;
    hi = high > hi ? high : hi;
  }
  void add(const Box& b) { add(b.lo, b.hi); }
  /// Half of the surface area; 0 for an empty box.
  float area() const {
    const Float4 d = hi - lo;
    return d[0] >= 0 ? d[0] * d[1] + d[1] * d[2] + d[2] * d[0] : 0;
  }
};

/// A reference to something with a box. Its number and its kind are stored in the fourth lanes.
struct Ref {
  Float4 lo, hi;

  Ref() = default;
  Ref(const Box& box, uint32_t id, uint32_t kind) : lo(box.lo), hi(box.hi) {
    std::memcpy(reinterpret_cast<char*>(&lo) + 12, &id, 4);
    std::memcpy(reinterpret_cast<char*>(&hi) + 12, &kind, 4);
  }
  uint32_t id() const { return word(lo); }
  uint32_t kind() const { return word(hi); }
  /// Twice the centre, with zero in the fourth lane.
  Float4 centre2() const {
    typedef uint32_t Bits __attribute__((vector_size(16)));
    constexpr Bits kPlace{~0u, ~0u, ~0u, 0};  // else their bits would be added as denormals
    return (Float4)((Bits)lo & kPlace) + (Float4)((Bits)hi & kPlace);
  }

 private:
  static uint32_t word(const Float4& v) {
    uint32_t w;
    std::memcpy(&w, reinterpret_cast<const char*>(&v) + 12, 4);
    return w;
  }
};

/// A run of references of one kind.
struct Leaf {
  uint32_t begin, count;
};

/// A tree. Its leaf children are kLeaf | index into `leaves`; the code that stores the leaves
/// rewrites these references.
struct Hierarchy {
  HugeVector<Node> nodes;
  std::vector<Leaf> leaves;
  uint32_t root = kEmpty;
  Box box;
};

/// Builds a tree by binned surface-area splits, directly with eight children per node. A leaf holds
/// up to `leaf_size` references of one kind. `refs` is reordered. The tree does not depend on the
/// number of threads.
Hierarchy build_hierarchy(HugeVector<Ref>& refs, uint32_t leaf_size);

}  // namespace underbrush::trace
