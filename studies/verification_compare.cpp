#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/verification.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::studies {
namespace {

constexpr double kNearM = 0.04;        // of a face: five sigma of the instrument
constexpr double kBorderM = 0.025;     // footprints nearer to an edge are on two faces
constexpr double kHalfStepM = 0.0005;  // of the instrument's ranges
constexpr size_t kLeastPoints = 30;
constexpr size_t kMostPaired = 60000;  // points of either cloud in the registration

using Segments = std::vector<std::vector<Vec3>>;

/// Which face each point is of (`faces.size()`: none): the nearest one that it lies over, by
/// `tolerance_m` beyond its border or, if negative, so much inside.
std::vector<size_t> face_of(const Solid& solid, const std::vector<size_t>& faces,
                            const std::vector<Vec3>& cloud, const Pose& target_from_cloud,
                            double tolerance_m) {
  std::vector<Vec3> normal, corner;
  std::vector<FaceOutline> outline;
  for (const size_t f : faces) {
    outline.emplace_back(solid, f);
    normal.push_back(solid.normal(f));
    corner.push_back(solid.corners(f)[0]);
  }
  std::vector<size_t> out;
  for (const Vec3& p : cloud) {
    const Vec3 at = target_from_cloud * p;
    double least = kNearM;
    size_t best = faces.size();
    for (size_t k = 0; k < faces.size(); ++k) {
      const double off = std::abs(normal[k].dot(at - corner[k]));
      if (off < least && outline[k].covers(at, tolerance_m)) best = k, least = off;
    }
    out.push_back(best);
  }
  return out;
}

/// The points of each face, in the cloud's own frame.
Segments segmented(const Solid& solid, const std::vector<size_t>& faces,
                   const std::vector<Vec3>& cloud, const Pose& target_from_cloud) {
  const std::vector<size_t> of = face_of(solid, faces, cloud, target_from_cloud, -kBorderM);
  Segments out(faces.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (of[i] < faces.size()) out[of[i]].push_back(cloud[i]);
  }
  return out;
}

/// Leaves out what is not of the target: background, and points beyond its silhouette, from beams
/// that meet it with a part of their footprint.
void keep_target(const Solid& solid, const std::vector<size_t>& faces,
                 const Pose& target_from_cloud, std::vector<Vec3>& cloud) {
  const std::vector<size_t> of = face_of(solid, faces, cloud, target_from_cloud, 0);
  size_t kept = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (of[i] < faces.size()) cloud[kept++] = cloud[i];
  }
  cloud.resize(kept);
}

/// Triples of faces that meet in a point of all three.
std::vector<std::array<size_t, 3>> corners_of(const Solid& solid,
                                              const std::vector<size_t>& faces) {
  std::vector<std::array<size_t, 3>> out;
  const auto plane = [&](size_t k) {
    Plane p;
    p.normal = solid.normal(faces[k]);
    p.offset_m = p.normal.dot(solid.corners(faces[k])[0]);
    return p;
  };
  for (size_t a = 0; a < faces.size(); ++a) {
    for (size_t b = a + 1; b < faces.size(); ++b) {
      for (size_t c = b + 1; c < faces.size(); ++c) {
        const Plane planes[3] = {plane(a), plane(b), plane(c)};
        Mat3 normals;
        for (int i = 0; i < 3; ++i) normals.row(i) = planes[i].normal;
        if (std::abs(normals.determinant()) < 0.1) continue;
        const Vec3 p = intersection(planes[0], planes[1], planes[2]);
        const auto on = [&](size_t k) { return over_face(solid, faces[k], p, 1e-6); };
        if (on(a) && on(b) && on(c)) out.push_back({a, b, c});
      }
    }
  }
  return out;
}

std::vector<Plane> planes_of(const Segments& segments) {
  std::vector<Plane> out;
  for (const auto& points : segments) out.push_back(fit_plane(points));
  return out;
}

/// Faces, and their segments, with enough points on both sides.
void keep_seen(std::vector<size_t>& faces, Segments& real, Segments& simulated) {
  for (size_t k = faces.size(); k-- > 0;) {
    if (real[k].size() >= kLeastPoints && simulated[k].size() >= kLeastPoints) continue;
    faces.erase(faces.begin() + std::ptrdiff_t(k));
    real.erase(real.begin() + std::ptrdiff_t(k));
    simulated.erase(simulated.begin() + std::ptrdiff_t(k));
  }
  require(faces.size() >= 3, "verification: fewer than three faces have points of both clouds");
}

/// Every n-th point, so that about `kMostPaired` are left.
std::vector<Vec3> some_of(const std::vector<Vec3>& cloud) {
  std::vector<Vec3> out;
  const size_t every = 1 + cloud.size() / kMostPaired;
  for (size_t i = 0; i < cloud.size(); i += every) out.push_back(cloud[i]);
  return out;
}

double mean_over(const std::vector<PatchFigures>& patches, Distances PatchFigures::*side) {
  double sum = 0;
  for (const PatchFigures& p : patches) sum += (p.*side).mean_m / double(patches.size());
  return sum;
}

std::vector<double> ranges_of(const std::vector<Vec3>& points) {
  std::vector<double> out;
  out.reserve(points.size());
  for (const Vec3& p : points) out.push_back(p.norm());
  return out;
}

}  // namespace

Distances distances_from(const Plane& plane, const std::vector<Vec3>& points) {
  Distances out;
  out.points = points.size();
  const double n = double(points.size());
  double squares = 0;
  for (const Vec3& p : points) {
    const double d = plane.distance(p);
    out.offset_m += d / n;
    out.mean_m += std::abs(d) / n;
    squares += d * d / n;
  }
  out.sigma_m = std::sqrt(std::max(0.0, squares - out.mean_m * out.mean_m));
  return out;
}

double PairFigures::mean_distance_m() const { return mean_over(patches, &PatchFigures::simulated); }
double PairFigures::real_mean_distance_m() const { return mean_over(patches, &PatchFigures::real); }

void keep_pair(const std::filesystem::path& folder, const CloudPair& pair) {
  std::filesystem::create_directories(folder);
  const auto row = [](const Vec3& p) {
    return fmt::format("{:.6f},{:.6f},{:.6f}", p.x(), p.y(), p.z());
  };
  for (const auto& [name, cloud] :
       {std::pair{"real.csv", &pair.real}, {"simulated.csv", &pair.simulated}}) {
    std::string text = "x,y,z\n";
    for (const Vec3& p : *cloud) text += row(p) + "\n";
    io::write_atomically(folder / name, text);
  }
  std::string text = "x,y,z,x2,y2,z2\n";
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
    text += row(pair.real_from_target * p) + "," + row(p) + "\n";
  }
  io::write_atomically(folder / "conjugates.csv", text);
}

PairFigures compare(const Solid& solid, const std::vector<size_t>& faces, CloudPair pair,
                    double histogram_bin_m) {
  PairFigures out;
  IcpOptions closest;
  closest.neighbours = 60;
  out.icp =
      icp(some_of(pair.simulated), some_of(pair.real), pair.real_from_target, closest);
  out.real_from_target = out.icp.to_from_from;
  keep_target(solid, faces, out.real_from_target.inverse(), pair.real);
  keep_target(solid, faces, {}, pair.simulated);
  out.real_points = pair.real.size();
  out.simulated_points = pair.simulated.size();
  std::vector<size_t> seen = faces;
  Segments real = segmented(solid, faces, pair.real, out.icp.to_from_from.inverse());
  Segments simulated = segmented(solid, faces, pair.simulated, Pose{});
  keep_seen(seen, real, simulated);
  const std::vector<Plane> real_plane = planes_of(real),
                                    simulated_plane = planes_of(simulated);
  std::vector<Vec3> conjugate;
  for (const auto& [a, b, c] : corners_of(solid, seen)) {
    out.conjugate_real.push_back(
        intersection(real_plane[a], real_plane[b], real_plane[c]));
    conjugate.push_back(
        intersection(simulated_plane[a], simulated_plane[b], simulated_plane[c]));
  }
  out.from_corners = conjugate.size() < 3 ? out.real_from_target
                                          : align(conjugate, out.conjugate_real).pose;
  for (size_t k = 0; k < conjugate.size(); ++k) {
    const double n = double(conjugate.size());
    const Vec3 left = out.from_corners * conjugate[k] - out.conjugate_real[k];
    const Vec3 moved = (out.from_corners.inverse() * out.real_from_target) * conjugate[k];
    out.conjugate_rms_m += left.squaredNorm() / n;
    out.corners_against_icp_m += (moved - conjugate[k]).squaredNorm() / n;
  }
  out.conjugate_rms_m = std::sqrt(out.conjugate_rms_m);
  out.corners_against_icp_m = std::sqrt(out.corners_against_icp_m);
  for (size_t k = 0; k < seen.size(); ++k) {
    PatchFigures patch;
    patch.face = seen[k];
    patch.plane = real_plane[k];
    std::vector<Vec3> turned;  // x to the right, y forward
    for (const Vec3& p : real[k]) turned.emplace_back(-p.y(), p.x(), p.z());
    patch.height = fit_height_plane(turned);
    for (Vec3& p : simulated[k]) p = out.real_from_target * p;
    patch.real = distances_from(patch.plane, real[k]);
    patch.simulated = distances_from(patch.plane, simulated[k]);
    out.patches.push_back(patch);
  }
  std::vector<Vec3> laid;
  for (const Vec3& p : pair.simulated) laid.push_back(out.real_from_target * p);
  out.histograms =
      range_histograms(ranges_of(pair.real), ranges_of(laid), histogram_bin_m, kHalfStepM);
  return out;
}

}  // namespace underbrush::studies
