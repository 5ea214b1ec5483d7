#include "underbrush/ground/height_map.hpp"

#include <cmath>

namespace underbrush::ground {

size_t HeightMap::size() const {
  size_t n = 0;
  for (const auto& [key, block] : exists) {
    for (uint8_t e : block) n += e;
  }
  return n;
}

bool HeightMap::has(int i, int j) const {
  const auto block = exists.find(block_of(i, j));
  return block != exists.end() && block->second[size_t(place_in_block(i, j))];
}

double HeightMap::node(int i, int j) const {
  return height.at(block_of(i, j))[size_t(place_in_block(i, j))];
}

std::optional<double> HeightMap::at(double x, double y) const {
  const double u = (x - origin.x()) / spacing_m, v = (y - origin.y()) / spacing_m;
  if (!(std::abs(u) < 1e9 && std::abs(v) < 1e9)) return std::nullopt;
  const int i = int(std::floor(u)), j = int(std::floor(v));
  if (!(has(i, j) && has(i + 1, j) && has(i, j + 1) && has(i + 1, j + 1))) return std::nullopt;
  const double a = u - i, b = v - j;
  return origin.z() + (1 - b) * ((1 - a) * node(i, j) + a * node(i + 1, j)) +
         b * ((1 - a) * node(i, j + 1) + a * node(i + 1, j + 1));
}

}  // namespace underbrush::ground
