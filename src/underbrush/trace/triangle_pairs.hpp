/// \file
/// Pairs of neighbouring triangles, which the tree keeps together.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/trace/element_math.hpp"
#include "underbrush/trace/hierarchy.hpp"

namespace underbrush::trace {

/// A triangle and the one that shares an edge with it.
struct TrianglePair {
  uint32_t other = Intersection::kNone;  ///< Element number of the second; kNone if there is none.
  /// Place of the corner of the first one that the second one lacks, and the reverse.
  uint8_t apart = 0, other_apart = 0;
};

/// All triangles of a model in pairs. Two make a pair if they are of one mesh, share an edge that
/// each runs through in its own direction, and have a common box no larger than their two boxes
/// together. Each takes the first partner in the order of numbers that is left, and the smallest
/// box among its up to three; at corners of many triangles, a part of those that share an edge is
/// tried.
class TrianglePairs {
 public:
  explicit TrianglePairs(const elements::Model& model);

  /// The element numbers of the first triangles of all pairs, ascending.
  const std::vector<uint32_t>& first() const { return first_; }
  /// The pair of a first triangle.
  const TrianglePair& operator[](uint32_t element) const { return pair_[element]; }

 private:
  void add(const elements::TriangleMesh& mesh, uint32_t number);

  std::vector<uint32_t> first_;
  std::vector<TrianglePair> pair_;
};

/// Returns the box of a triangle of a mesh.
Box triangle_box(const elements::TriangleMesh& mesh, size_t triangle);

}  // namespace underbrush::trace
