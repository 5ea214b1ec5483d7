#include "underbrush/pipeline/scan_overlap.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "underbrush/core/cells.hpp"
#include "underbrush/pipeline/check_values.hpp"

namespace underbrush::pipeline {
namespace {

constexpr double kNear = 2, kFar = 40, kCell = 0.4;  // m
constexpr int kSide = int(2 * kFar / kCell);         // cells

/// The number of the cell that holds a point, or none beyond the cells.
std::optional<size_t> cell_of(const Vec3& p) {
  size_t cell = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = std::floor((p[axis] + kFar) / kCell);
    if (!(at >= 0 && at < kSide)) return std::nullopt;
    cell = cell * size_t(kSide) + size_t(at);
  }
  return cell;
}

}  // namespace

std::vector<Vec3> upper_points(const PointScan& scan, size_t most) {
  const auto is_near = [](const Vec3f& p) {
    return is_return(p) && p.norm() > kNear && p.norm() < kFar;
  };
  std::vector<double> height;
  for (const Vec3f& p : scan.point) {
    if (is_near(p)) height.push_back(double(p.z()));
  }
  constexpr double kAbove = 0.3;  // m
  const double least = median(height) + kAbove;
  const size_t step = std::max<size_t>(1, height.size() / most / 2);
  std::vector<Vec3> out;
  size_t n = 0;
  for (const Vec3f& p : scan.point) {
    if (is_near(p) && double(p.z()) > least && n++ % step == 0) out.push_back(p.cast<double>());
  }
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

ScanMotion best_motion(const ScanCells& earlier, const std::vector<Vec3>& later) {
  constexpr int kSteps = 10, kTurns = 10;
  ScanMotion best;
  for (int turn = -kTurns; turn <= kTurns; ++turn) {
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(turn * M_PI / 180, Vec3::UnitZ()));
    for (int x = -kSteps; x <= kSteps; ++x) {
      for (int y = -kSteps; y <= kSteps; ++y) {
        const Pose pose{rotation, Vec3(x * kCell, y * kCell, 0)};
        const double share = earlier.share_of(later, pose);
        if (share > best.share) best = {pose, share};
      }
    }
  }
  return best;
}

}  // namespace underbrush::pipeline
