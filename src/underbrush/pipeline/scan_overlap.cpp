#include "underbrush/pipeline/scan_overlap.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "underbrush/core/cells.hpp"
#include "underbrush/pipeline/check_values.hpp"

namespace underbrush::pipeline {
namespace {

constexpr double kNear = 2, kFar = 40, kCell = 0.4;  // m
constexpr int kSide = int(2 * kFar / kCell);         // cells

/// The place of a coordinate among the cells along an axis, or none beyond them.
std::optional<int> step_of(double coordinate) {
  const double at = std::floor((coordinate + kFar) / kCell);
  return at >= 0 && at < kSide ? std::optional(int(at)) : std::nullopt;
}

/// The number of the cell that holds a point, or none beyond the cells.
std::optional<size_t> cell_of(const Vec3& p) {
  size_t cell = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<int> at = step_of(p[axis]);
    if (!at) return std::nullopt;
    cell = cell * size_t(kSide) + size_t(*at);
  }
  return cell;
}

/// Leaves out points whose column of cells has no other 0.3 m above or below, as those on a flat
/// ceiling.
void keep_upright(std::vector<Vec3>& points) {
  constexpr double kLeast = 0.3;                                  // m
  std::unordered_map<size_t, std::pair<double, double>> heights;  // The least and the greatest.
  const auto column_of = [](const Vec3& p) { return cell_of({p.x(), p.y(), 0}).value_or(0); };
  for (const Vec3& p : points) {
    auto& [low, high] = heights.try_emplace(column_of(p), p.z(), p.z()).first->second;
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  }
  std::erase_if(points, [&](const Vec3& p) {
    const auto& [low, high] = heights.at(column_of(p));
    return high - low < kLeast;
  });
}

constexpr int kSteps = 10;           // A motion is by up to as many cells forward and to the side.
constexpr int kNoCell = -(1 << 29);  // A sum with it is below 0.

/// Returns what each point adds to the number of its cell, for each step along an axis.
std::vector<std::vector<int>> moved(const std::vector<Vec3>& points, int axis, int stride) {
  std::vector<std::vector<int>> out(2 * kSteps + 1);
  for (int step = -kSteps; step <= kSteps; ++step) {
    std::vector<int>& cells = out[size_t(step) + kSteps];
    cells.reserve(points.size());
    for (const Vec3& p : points) {
      const std::optional<int> at = step_of(p[axis] + step * kCell);
      cells.push_back(at ? *at * stride : kNoCell);
    }
  }
  return out;
}

}  // namespace

std::vector<Vec3> upper_points(const PointScan& scan, const Eigen::Quaterniond& upright,
                               size_t most) {
  constexpr double kAbove = 0.3;  // m
  std::vector<Vec3> near, out;
  std::vector<double> own, height;
  for (const Vec3f& p : scan.point) {
    if (!is_return(p) || p.norm() < kNear || p.norm() > kFar) continue;
    near.push_back(p.cast<double>());
    own.push_back(near.back().z());
    height.push_back((upright * near.back()).z());
  }
  const double least_own = median(own) + kAbove, least = median(height) + kAbove;
  std::erase_if(near,
                [&](const Vec3& p) { return p.z() <= least_own || (upright * p).z() <= least; });
  for (Vec3& p : near) p = upright * p;
  keep_upright(near);
  const size_t step = std::max<size_t>(1, near.size() / most);
  for (size_t i = 0; i < near.size(); i += step) out.push_back(near[i]);
  return out;
}

ScanCells::ScanCells(const std::vector<Vec3>& points)
    : filled_(size_t(kSide) * size_t(kSide) * size_t(kSide)) {
  for (const Vec3& p : points) {
    if (const auto cell = cell_of(p)) filled_[*cell] = true;
  }
}

double ScanCells::share_of(const std::vector<Vec3>& points, const Pose& this_from_points) const {
  const Eigen::Matrix3d turn = this_from_points.rotation.toRotationMatrix();
  size_t n = 0;
  for (const Vec3& p : points) {
    const auto cell = cell_of(turn * p + this_from_points.translation);
    n += cell && filled_[*cell];
  }
  return points.empty() ? 0 : double(n) / double(points.size());
}

double ScanCells::share_of(const std::vector<int>& some, const std::vector<int>& rest) const {
  size_t n = 0;
  for (size_t i = 0; i < some.size(); ++i) {
    const int cell = some[i] + rest[i];
    n += cell >= 0 && filled_[size_t(cell)];
  }
  return some.empty() ? 0 : double(n) / double(some.size());
}

ScanMotion best_motion(const ScanCells& earlier, const std::vector<Vec3>& later) {
  constexpr int kTurns = 10;
  ScanMotion best;
  for (int turn = -kTurns; turn <= kTurns; ++turn) {
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(turn * M_PI / 180, Vec3::UnitZ()));
    const Eigen::Matrix3d matrix = rotation.toRotationMatrix();
    std::vector<Vec3> turned;
    turned.reserve(later.size());
    for (const Vec3& p : later) turned.push_back(matrix * p);
    const auto along_x = moved(turned, 0, kSide * kSide), along_y = moved(turned, 1, kSide);
    for (int x = -kSteps; x <= kSteps; ++x) {
      std::vector<int> rest = along_x[size_t(x) + kSteps];
      for (size_t i = 0; i < rest.size(); ++i) rest[i] += step_of(turned[i].z()).value_or(kNoCell);
      for (int y = -kSteps; y <= kSteps; ++y) {
        const double share = earlier.share_of(rest, along_y[size_t(y) + kSteps]);
        if (share > best.share) best = {Pose{rotation, Vec3(x * kCell, y * kCell, 0)}, share};
      }
    }
  }
  return best;
}

}  // namespace underbrush::pipeline
