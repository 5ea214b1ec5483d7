#include "studies/analytic_scanner.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace underbrush::studies {
namespace {

/// A face prepared for rays: its plane, and its outline without the axis along which the normal is
/// largest.
struct FlatFace {
  Vec3 normal;
  double offset;
  int across, up;
  std::vector<std::array<double, 2>> outline;
  Vec3 centre;    ///< The centre of a ball about its corners.
  double radius;  ///< The ball's.
};

std::vector<FlatFace> faces_of(const Solid& solid) {
  std::vector<FlatFace> out;
  for (size_t f = 0; f < solid.faces.size(); ++f) {
    const std::vector<Vec3> corner = solid.corners(f);
    FlatFace face;
    face.normal = (corner[1] - corner[0]).cross(corner[2] - corner[1]).normalized();
    face.offset = face.normal.dot(corner[0]);
    int drop = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(face.normal[i]) > std::abs(face.normal[drop])) drop = i;
    }
    face.across = (drop + 1) % 3;
    face.up = (drop + 2) % 3;
    for (const Vec3& c : corner) face.outline.push_back({c[face.across], c[face.up]});
    Eigen::AlignedBox3d box;
    for (Vec3 c : corner) {  // Onto the plane, in which a face of a file lies only about.
      c[drop] += (face.offset - face.normal.dot(c)) / face.normal[drop];
      box.extend(c);
    }
    face.centre = box.center();
    face.radius = box.diagonal().norm() / 2;
    out.push_back(std::move(face));
  }
  return out;
}

/// Tests by the crossing number, by which a border belongs to one of its two sides.
bool inside(const FlatFace& face, const Vec3& p) {
  const double x = p[face.across], y = p[face.up];
  bool in = false;
  for (size_t i = 0, j = face.outline.size() - 1; i < face.outline.size(); j = i++) {
    const auto& [xi, yi] = face.outline[i];
    const auto& [xj, yj] = face.outline[j];
    if ((yi > y) != (yj > y) && x < xi + (y - yi) * (xj - xi) / (yj - yi)) in = !in;
  }
  return in;
}

struct Meeting {
  double range = std::numeric_limits<double>::infinity();
  double cosine = 0;
};

/// Finds the faces, in their order, that rays may meet which start within `exit` of `eye` and lead
/// away from the unit vector `axis` by at most `spread` a metre.
void find_faces_near(const std::vector<FlatFace>& faces, const Vec3& eye, const Vec3& axis,
                     double exit, double spread, std::vector<const FlatFace*>& near) {
  constexpr double kRounding = 1e-6;  // m
  near.clear();
  for (const FlatFace& face : faces) {
    const Vec3 to = face.centre - eye;
    const double ahead = to.dot(axis), farthest = std::max(ahead + face.radius, 0.0);
    const double reach = face.radius + exit + spread * farthest + kRounding;
    if ((to - ahead * axis).squaredNorm() <= reach * reach) near.push_back(&face);
  }
}

Meeting nearest(const std::vector<const FlatFace*>& faces, const Vec3& from, const Vec3& along) {
  Meeting best;
  for (const FlatFace* one : faces) {
    const FlatFace& face = *one;
    const double slope = face.normal.dot(along);
    if (slope >= 0) continue;  // The ray meets the face from behind, or runs along it.
    const double t = (face.offset - face.normal.dot(from)) / slope;
    if (t > 0 && t < best.range && inside(face, from + t * along)) best = {t, -slope};
  }
  return best;
}

/// A place on the beam's cross-section, in half-widths at half power, and its share of the energy.
struct Place {
  double u, v, share;
};

constexpr double kReach = 2.9;  ///< Radius of the cross-section in half-widths.

/// Returns rings of equal width out to 3.4 σ of the Gaussian 2^−(u² + v²).
std::vector<Place> footprint() {
  constexpr int kRings = 8, kSpokes = 12;
  std::vector<Place> out;
  double sum = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double inner = kReach * ring / kRings, outer = kReach * (ring + 1) / kRings;
    const double energy = (std::exp2(-inner * inner) - std::exp2(-outer * outer)) / kSpokes;
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double angle = 2 * M_PI * (spoke + 0.5 * (ring % 2)) / kSpokes;
      const double r = (inner + outer) / 2;
      out.push_back({r * std::cos(angle), r * std::sin(angle), energy});
      sum += energy;
    }
  }
  for (Place& p : out) p.share /= sum;
  return out;
}

/// Draws a normal number by Box and Muller's method on the Mersenne twister.
double gaussian(std::mt19937_64& random) {
  const double a = (double(random() >> 11) + 0.5) * 0x1p-53;
  const double b = (double(random() >> 11) + 0.5) * 0x1p-53;
  return std::sqrt(-2 * std::log(a)) * std::cos(2 * M_PI * b);
}

}  // namespace

AnalyticScan analytic_scan(const Solid& solid, const Pose& target_from_scanner,
                           const AnalyticScanOptions& options) {
  const std::vector<FlatFace> faces = faces_of(solid);
  const std::vector<Place> places = footprint();
  std::mt19937_64 random(options.seed);
  double bound = 0;  // Bound of the target about the origin of its frame.
  for (const Vec3& v : solid.vertices) bound = std::max(bound, v.norm() + 0.1);
  const Vec3 eye = target_from_scanner.translation;
  const Mat3 turn = target_from_scanner.rotation.toRotationMatrix();
  const double spread = std::tan(options.divergence_rad / 2);
  const int half = int(std::ceil(options.half_field_rad / options.step_rad));
  AnalyticScan out;
  std::vector<const FlatFace*> near;
  for (int column = -half; column < half; ++column) {
    for (int row = -half; row < half; ++row) {
      ++out.shots;
      const double azimuth = (column + options.azimuth_phase) * options.step_rad;
      const double elevation = (row + options.elevation_phase) * options.step_rad;
      const Vec3 local(std::cos(elevation) * std::cos(azimuth),
                       std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Vec3 axis = turn * local;
      if ((eye - eye.dot(axis) * axis).norm() > bound) continue;
      const Vec3 right = axis.cross(Vec3::UnitZ()).normalized(), up = right.cross(axis);
      find_faces_near(faces, eye, axis, kReach * options.exit_m / 2, kReach * spread, near);
      double energy = 0, moment = 0;
      for (const Place& p : places) {
        const Vec3 off = p.u * right + p.v * up;
        const Vec3 along = (axis + spread * off).normalized();
        const Meeting met = nearest(near, eye + options.exit_m / 2 * off, along);
        if (met.cosine <= 0) continue;
        energy += p.share * met.cosine;
        moment += p.share * met.cosine * met.range;
      }
      if (energy < options.least_energy) continue;
      const double noisy = moment / energy + options.range_sigma_m * gaussian(random);
      out.points.push_back(std::round(noisy / options.range_step_m) * options.range_step_m * local);
    }
  }
  return out;
}

}  // namespace underbrush::studies
