#include "underbrush/sensor/scan_motion.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/rays.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kSigmaRad = 1e-3;     // spread of a direction about its place in the layout
constexpr double kTurnPriorRad = 0.1;  // weak priors, for what the samples leave open
constexpr double kMovePriorM = 2;

/// The knot before a share, and how far the share lies from it to the next.
struct Knot {
  int before;
  double part;
};

Knot knot_at(double share, int knots) {
  const double at = std::clamp(share, 0.0, 1.0) * (knots - 1);
  const int before = std::min(int(at), knots - 2);
  return {before, at - before};
}

}  // namespace

Eigen::Quaterniond ScanMotion::rotation(double share) const {
  const Knot k = knot_at(share, kKnots);
  const Vec3 v =
      (1 - k.part) * turn_rad_[size_t(k.before)] + k.part * turn_rad_[size_t(k.before) + 1];
  const double angle = v.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle));
}

Vec3 ScanMotion::direction_of_points(double share, const Vec3& direction) const {
  return rotation(share) * direction;
}

Vec3 ScanMotion::point_of_beams(double share, const Vec3& point) const {
  return rotation(share).conjugate() * (point - translation(share));
}

// With p = R p' + T and small turns ω and moves T, the direction of p differs from the expected d
// by ω × d + T / range. Its parts along the unit vectors of azimuth (a) and elevation (e) are ω · e
// + T · a / range and −ω · a + T · e / range.
void ScanMotion::improve(const std::vector<Sample>& samples) {
  struct Row {
    Knot knot;
    double share, range, off;
    Vec3 a, e;
    double along_a, along_e;
  };
  std::vector<Row> rows;
  std::vector<double> offs;
  for (const Sample& s : samples) {
    const Vec3 p = point_of_beams(s.share, s.point);
    const double range = p.norm(), flat = std::hypot(s.direction.x(), s.direction.y());
    if (!(range > 0) || flat < 1e-6) continue;
    const Vec3 a(-s.direction.y() / flat, s.direction.x() / flat, 0);
    const Vec3 e = s.direction.cross(a), rest = p / range - s.direction;
    offs.push_back(rest.norm());
    rows.push_back(
        {knot_at(s.share, kKnots), s.share, range, rest.norm(), a, e, rest.dot(a), rest.dot(e)});
  }
  const double limit = 4 * std::max(median(offs), kSigmaRad);
  using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  using Vector = Eigen::Matrix<double, kUnknowns, 1>;
  Matrix normal = Matrix::Zero();
  Vector right = Vector::Zero();
  constexpr double kWeight = 1 / (kSigmaRad * kSigmaRad);
  const auto add = [&](const Row& row, const Vec3& turn, const Vec3& move, double value) {
    // The twelve entries of the row that are not 0: two knots, start and end.
    const Eigen::Index at[4] = {3 * row.knot.before, 3 * row.knot.before + 3, 3 * kKnots,
                                3 * kKnots + 3};
    const Vec3 part[4] = {(1 - row.knot.part) * turn, row.knot.part * turn, (1 - row.share) * move,
                          row.share * move};
    for (int i = 0; i < 4; ++i) {
      right.segment<3>(at[i]) += kWeight * value * part[i];
      for (int j = 0; j < 4; ++j)
        normal.block<3, 3>(at[i], at[j]) += kWeight * part[i] * part[j].transpose();
    }
  };
  for (const Row& row : rows) {
    if (row.off > limit) continue;
    add(row, row.e, row.a / row.range, row.along_a);
    add(row, -row.a, row.e / row.range, row.along_e);
  }
  for (int i = 0; i < kUnknowns; ++i) {
    const double prior = i < 3 * kKnots ? kTurnPriorRad : kMovePriorM;
    normal(i, i) += 1 / (prior * prior);
  }
  const Vector step = normal.ldlt().solve(right);
  for (int k = 0; k < kKnots; ++k) turn_rad_[size_t(k)] += step.segment<3>(3 * k);
  start_ += step.segment<3>(3 * kKnots);
  end_ += step.segment<3>(3 * kKnots + 3);
}

}  // namespace underbrush::sensor
