#include "underbrush/update/kept_triangles.hpp"

#include <gtest/gtest.h>

namespace underbrush::update {
namespace {

elements::TriangleMesh two_triangles() {
  elements::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  mesh.hit.resize(2);
  return mesh;
}

TEST(KeptTriangles, OrderAndFirstCornerDoNotMatter) {
  const elements::TriangleMesh before = two_triangles();
  elements::TriangleMesh now = before;
  now.triangles = {{3, 2, 1}, {2, 0, 1}};
  EXPECT_EQ(kept_triangles(before, now), (std::vector<uint32_t>{1, 0}));
}

TEST(KeptTriangles, OtherCornersAndHeightsAreNew) {
  const elements::TriangleMesh before = two_triangles();
  elements::TriangleMesh now = before;
  now.vertices[0].z() = 0.05f;
  EXPECT_EQ(kept_triangles(before, now), (std::vector<uint32_t>{kNewTriangle, 1}));
  now = before;
  now.vertices[3].z() = 0.005f;
  EXPECT_EQ(kept_triangles(before, now), (std::vector<uint32_t>{0, 1}));
  now.vertices[3].x() = 2;
  EXPECT_EQ(kept_triangles(before, now), (std::vector<uint32_t>{0, kNewTriangle}));
  now = before;
  now.triangles[0] = {0, 2, 1};  // It faces down.
  EXPECT_EQ(kept_triangles(before, now), (std::vector<uint32_t>{kNewTriangle, 1}));
}

}  // namespace
}  // namespace underbrush::update
