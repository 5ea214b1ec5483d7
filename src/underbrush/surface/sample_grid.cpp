#include "underbrush/surface/sample_grid.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "underbrush/core/linear.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::surface {
namespace {

// Integer steps to a cell, and to a unit vector's length.
constexpr double kUnit = double(1 << 20);
/// Points whose variance across is less than this share of that along lie on a line.
constexpr double kLine = 0.02;
constexpr uint32_t kOutside = std::numeric_limits<uint32_t>::max();

/// Sums over the points of one half cell.
struct Sum {
  std::array<int64_t, 3> position{}, to_sensor{};
  int64_t n = 0;
};

/// The cell of each point, counted with x fastest; kOutside for points outside `box` and where a
/// number is not finite.
std::vector<uint32_t> cells_of(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                               const CellBox& box, double cell_m) {
  std::vector<uint32_t> cell_of(points.size(), kOutside);
  parallel_for(points.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3f& p = points[i];
      if (!p.allFinite() || !to_sensor[i].allFinite()) continue;
      size_t cell = 0;
      bool inside = true;
      for (size_t a = 3; a-- > 0;) {
        const double at = std::floor(double(p[int(a)]) / cell_m) - box.first[a];
        inside &= at >= 0 && at < box.size[a];
        cell = cell * size_t(box.size[a]) + size_t(inside ? at : 0);
      }
      if (inside) cell_of[i] = uint32_t(cell);
    }
  });
  return cell_of;
}

/// The points of each cell in turn, in their order; `start[c]` (one more than cells) is the place
/// of the first of cell c.
std::vector<uint32_t> sorted_by_cell(const std::vector<uint32_t>& cell_of,
                                     std::vector<uint32_t>& start) {
  for (const uint32_t c : cell_of) {
    if (c != kOutside) ++start[size_t(c) + 1];
  }
  for (size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
  std::vector<uint32_t> sorted(start.back());
  std::vector<uint32_t> next(start.begin(), start.end() - 1);
  for (size_t i = 0; i < cell_of.size(); ++i) {
    if (cell_of[i] != kOutside) sorted[next[cell_of[i]]++] = uint32_t(i);
  }
  return sorted;
}

}  // namespace

SampleGrid::SampleGrid(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                       const CellBox& box, double cell_m)
    : box_(box), cell_m_(cell_m) {
  start_.assign(size_t(box_.count()) + 1, 0);
  const std::vector<uint32_t> sorted =
      sorted_by_cell(cells_of(points, to_sensor, box_, cell_m_), start_);
  // The samples of each cell are first written where its points are, then moved together.
  std::vector<OrientedPoint> sample(sorted.size());
  std::vector<uint8_t> count(size_t(box_.count()));
  parallel_for(size_t(box_.count()), 1 << 12, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      if (start_[c] == start_[c + 1]) continue;
      const size_t nx = size_t(box_.size[0]), ny = size_t(box_.size[1]);
      const std::array<size_t, 3> place{c % nx, c / nx % ny, c / nx / ny};
      std::array<double, 3> corner{};
      for (size_t a = 0; a < 3; ++a) corner[a] = (box_.first[a] + double(place[a])) * cell_m_;
      std::array<Sum, 8> sums;
      for (uint32_t s = start_[c]; s < start_[c + 1]; ++s) {
        const Vec3f &p = points[sorted[s]], v = to_sensor[sorted[s]].normalized();
        std::array<int64_t, 3> steps{};
        size_t half = 0;
        for (size_t a = 0; a < 3; ++a) {
          steps[a] = std::llround((double(p[int(a)]) - corner[a]) / cell_m_ * kUnit);
          half |= size_t(double(steps[a]) >= kUnit / 2) << a;
        }
        for (size_t a = 0; a < 3; ++a) {
          sums[half].position[a] += steps[a];
          sums[half].to_sensor[a] += std::llround(double(v[int(a)]) * kUnit);
        }
        ++sums[half].n;
      }
      for (const Sum& sum : sums) {
        if (sum.n == 0) continue;
        OrientedPoint& to = sample[start_[c] + count[c]++];
        for (size_t a = 0; a < 3; ++a) {
          to.position[int(a)] =
              float(corner[a] + double(sum.position[a]) / double(sum.n) / kUnit * cell_m_);
          to.normal[int(a)] = float(double(sum.to_sensor[a]) / kUnit);
        }
      }
    }
  });
  uint32_t from = 0;
  for (size_t c = 0; c < count.size(); ++c) {
    const uint32_t first = std::exchange(from, start_[c + 1]);
    start_[c] = uint32_t(samples_.size());
    samples_.insert(samples_.end(), sample.begin() + first, sample.begin() + first + count[c]);
  }
  start_.back() = uint32_t(samples_.size());
}

template <class Visit>
void SampleGrid::near(const Vec3f& x, float radius_m, const Visit& visit) const {
  for_each_near(box_, cell_m_, start_, samples_, x, radius_m, visit);
}

void SampleGrid::find_normals(std::span<const double> radii_m, int min_neighbours) {
  std::vector<Vec3f> normals(samples_.size(), Vec3f::Zero());
  parallel_for(samples_.size(), 512, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (double radius : radii_m) {
        Vec3 sum = Vec3::Zero();
        Mat3 square = Mat3::Zero();
        int n = 0;
        near(samples_[i].position, float(radius), [&](const OrientedPoint& s) {
          const Vec3 d = (s.position - samples_[i].position).cast<double>();
          sum += d;
          square += d * d.transpose();
          ++n;
        });
        if (n < min_neighbours) continue;
        const auto [values, axes] =
            quick_spectrum(square / n - sum * sum.transpose() / (double(n) * n));
        if (values[1] < kLine * values[2]) continue;
        const Vec3f normal = axes.col(0).cast<float>();
        normals[i] = normal.dot(samples_[i].normal) < 0 ? Vec3f(-normal) : normal;
        samples_[i].radius_m = float(radius);
        break;
      }
    }
  });
  for (size_t i = 0; i < samples_.size(); ++i) samples_[i].normal = normals[i];
  sort_levels(radii_m);
}

void SampleGrid::sort_levels(std::span<const double> radii_m) {
  levels_.clear();
  for (double radius : radii_m) {
    Level level;
    level.radius_m = float(radius);
    const double width = double(level.radius_m);
    for (size_t a = 0; a < 3; ++a) {
      level.box.first[a] = int(std::floor(box_.first[a] * cell_m_ / width)) - 1;
      level.box.size[a] = int(std::floor((box_.first[a] + box_.size[a]) * cell_m_ / width)) + 2 -
                          level.box.first[a];
    }
    level.start.assign(size_t(level.box.count()) + 1, 0);
    const auto cell_of = [&](const Vec3f& p) {
      size_t cell = 0;
      for (size_t a = 3; a-- > 0;) {
        const int at = int(std::floor(double(p[int(a)]) / width)) - level.box.first[a];
        cell = cell * size_t(level.box.size[a]) + size_t(at);
      }
      return cell;
    };
    const auto belongs = [&](const OrientedPoint& s) {
      return s.radius_m == level.radius_m && !s.normal.isZero();
    };
    for (const OrientedPoint& s : samples_) {
      if (belongs(s)) ++level.start[cell_of(s.position) + 1];
    }
    for (size_t c = 1; c < level.start.size(); ++c) level.start[c] += level.start[c - 1];
    level.samples.resize(level.start.back());
    std::vector<uint32_t> next(level.start.begin(), level.start.end() - 1);
    for (const OrientedPoint& s : samples_) {
      if (belongs(s)) level.samples[next[cell_of(s.position)]++] = s;
    }
    levels_.push_back(std::move(level));
  }
  samples_ = {};
  start_ = {};
}

}  // namespace underbrush::surface
