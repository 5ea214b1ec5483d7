#include "underbrush/sites/window.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/sites/distances.hpp"

namespace underbrush::sites {
namespace {

constexpr double kCellM = 1;
constexpr double kMostCells = 4096;  // Along a side.
constexpr double kLeastReachM = 10, kReachOfDistance = 1.5, kFarShare = 0.95;

/// What a cell is while the area around the objects is found.
enum Mark : uint8_t { kOff, kIn, kOnMesh, kBeyond };

}  // namespace

Window::Window(const primitives::GroundSurface& ground, double margin_m) {
  require(margin_m >= 0, "a margin must not be negative");
  const Eigen::AlignedBox2d& all = ground.bounds();
  corner_ = all.min();
  cell_m_ = std::max(kCellM, all.sizes().maxCoeff() / (kMostCells - 1));
  columns_ = int(all.sizes().x() / cell_m_) + 1;
  rows_ = int(all.sizes().y() / cell_m_) + 1;
  inside_.assign(size_t(columns_) * size_t(rows_), kOff);
  const Eigen::AlignedBox2d inner(all.min() + Eigen::Vector2d::Constant(margin_m),
                                  all.max() - Eigen::Vector2d::Constant(margin_m));
  std::vector<uint8_t> below(size_t(columns_ + 1), 0), above = below;  // Corners on the ground.
  for (int y = 0; y <= rows_; ++y) {
    std::swap(below, above);
    for (int x = 0; x <= columns_; ++x) {
      const Eigen::Vector2d at = corner_ + cell_m_ * Eigen::Vector2d(x, y);
      above[size_t(x)] = inner.contains(at) && ground.at(at.x(), at.y());
    }
    for (int x = 0; x < columns_ && y > 0; ++x) {
      const auto k = size_t(x);
      if (below[k] && below[k + 1] && above[k] && above[k + 1]) *cell({x, y - 1}) = kIn;
    }
  }
  collect();
}

Window::Index Window::index_of(const Eigen::Vector2d& at) const {
  const Eigen::Vector2d place = (at - corner_) / cell_m_;
  return {int(std::floor(place.x())), int(std::floor(place.y()))};
}

uint8_t* Window::cell(const Index& i) {
  if (i.x < 0 || i.y < 0 || i.x >= columns_ || i.y >= rows_) return nullptr;
  return &inside_[size_t(i.y) * size_t(columns_) + size_t(i.x)];
}

bool Window::contains(const Eigen::Vector2d& at) const {
  const Index i = index_of(at);
  return i.x >= 0 && i.y >= 0 && i.x < columns_ && i.y < rows_ &&
         inside_[size_t(i.y) * size_t(columns_) + size_t(i.x)] == kIn;
}

void Window::mark_disc(const Eigen::Vector2d& at, double radius_m, uint8_t from, uint8_t to) {
  const Index low = index_of(at.array() - radius_m), high = index_of(at.array() + radius_m);
  for (int y = std::max(low.y, 0); y <= std::min(high.y, rows_ - 1); ++y) {
    for (int x = std::max(low.x, 0); x <= std::min(high.x, columns_ - 1); ++x) {
      const Eigen::Vector2d middle = corner_ + cell_m_ * Eigen::Vector2d(x + 0.5, y + 0.5);
      uint8_t& c = *cell({x, y});
      if (c == from && (middle - at).norm() <= radius_m) c = to;
    }
  }
}

void Window::keep_around(std::span<const Eigen::Vector2d> at) {
  if (at.empty()) return;
  std::vector<double> nearest = nearest_distances(at, at);
  std::sort(nearest.begin(), nearest.end());
  double sum = 0;
  for (const double d : nearest) sum += d;
  const double far = nearest[size_t(kFarShare * double(nearest.size() - 1))];
  const double reach = std::isfinite(far) ? std::max(kLeastReachM, kReachOfDistance * far)
                                          : bounds_.sizes().maxCoeff();
  for (uint8_t& c : inside_) c = c == kIn ? kOnMesh : kOff;
  for (const Eigen::Vector2d& p : at) mark_disc(p, reach, kOnMesh, kIn);
  const double mean = sum / double(nearest.size());
  const double back = std::isfinite(mean) ? reach - 0.5 * mean : 0;
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      if (*cell({x, y}) != kOnMesh) continue;
      constexpr Index kSides[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
      const bool ends = std::any_of(std::begin(kSides), std::end(kSides), [&](const Index& side) {
        const uint8_t* beside = cell({x + side.x, y + side.y});
        return beside && (*beside == kIn || *beside == kBeyond);
      });
      if (ends)
        mark_disc(corner_ + cell_m_ * Eigen::Vector2d(x + 0.5, y + 0.5), back, kIn, kBeyond);
    }
  }
  collect();
}

void Window::collect() {
  cells_.clear();
  bounds_.setEmpty();
  for (uint32_t k = 0; k < inside_.size(); ++k) {
    if (inside_[k] != kIn) continue;
    cells_.push_back(k);
    const Eigen::Vector2d low =
        corner_ + cell_m_ * Eigen::Vector2d(int(k) % columns_, int(k) / columns_);
    bounds_.extend(low);
    bounds_.extend(low + Eigen::Vector2d::Constant(cell_m_));
  }
}

Eigen::Vector2d Window::draw(Stream& random) const {
  const uint32_t k = cells_[random.below(cells_.size())];
  const double x = random.uniform(), y = random.uniform();
  return corner_ + cell_m_ * Eigen::Vector2d(int(k) % columns_ + x, int(k) / columns_ + y);
}

Eigen::Vector2d Window::relative(const Eigen::Vector2d& at) const {
  return (2 * (at - bounds_.center()).array() / bounds_.sizes().array()).matrix();
}

std::vector<Eigen::Vector2d> Window::middles() const {
  std::vector<Eigen::Vector2d> out;
  out.reserve(cells_.size());
  for (const uint32_t k : cells_) {
    out.emplace_back(corner_ +
                     cell_m_ * Eigen::Vector2d(int(k) % columns_ + 0.5, int(k) / columns_ + 0.5));
  }
  return out;
}

}  // namespace underbrush::sites
