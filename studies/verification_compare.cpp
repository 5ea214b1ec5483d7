#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/verification.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::studies {
namespace {

constexpr double kNearM = 0.04;        // m, from a face: five sigma of the instrument.
constexpr double kBorderM = 0.025;     // m; footprints nearer to an edge lie on two faces.
constexpr double kHalfStepM = 0.0005;  // m; half a step of the instrument's ranges.
constexpr size_t kLeastPoints = 30;
constexpr size_t kMostPaired = 60000;  // Points of either cloud in the registration.

using Segments = std::vector<std::vector<Vec3>>;

/// Returns the face of each point (`faces.size()`: none): the nearest one that it lies over, at
/// least `inside_m` (one a face) within its border.
std::vector<size_t> face_of(const Solid& solid, const std::vector<size_t>& faces,
                            const std::vector<Vec3>& cloud, const Pose& target_from_cloud,
                            const std::vector<double>& inside_m) {
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
      if (off < least && outline[k].covers(at, -inside_m[k])) best = k, least = off;
    }
    out.push_back(best);
  }
  return out;
}

/// Returns the points of each face, in the cloud's own frame.
Segments segmented(const Solid& solid, const std::vector<size_t>& faces,
                   const std::vector<Vec3>& cloud, const Pose& target_from_cloud,
                   const std::vector<double>& inside_m) {
  const std::vector<size_t> of = face_of(solid, faces, cloud, target_from_cloud, inside_m);
  Segments out(faces.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (of[i] < faces.size()) out[of[i]].push_back(cloud[i]);
  }
  return out;
}

/// Leaves out points that are not on the target: the background, and points beyond its silhouette,
/// from beams that meet it with a part of their footprint.
void keep_target(const Solid& solid, const std::vector<size_t>& faces,
                 const Pose& target_from_cloud, std::vector<Vec3>& cloud) {
  const std::vector<size_t> of =
      face_of(solid, faces, cloud, target_from_cloud, std::vector<double>(faces.size()));
  size_t kept = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (of[i] < faces.size()) cloud[kept++] = cloud[i];
  }
  cloud.resize(kept);
}

/// Returns the triples of faces that meet in one point of all three.
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

/// Returns how far within each face's border a footprint reaches, as seen from `eye` (in the
/// target's frame).
std::vector<double> reach_of_footprints(const Solid& solid, const std::vector<size_t>& faces,
                                        const Vec3& eye) {
  std::vector<double> out;
  for (const size_t f : faces) {
    const double slant = std::abs(solid.normal(f).dot((solid.corners(f)[0] - eye).normalized()));
    out.push_back(kBorderM / std::max(slant, 0.01));
  }
  return out;
}

/// Keeps the faces with enough points in both clouds, and their segments.
void keep_seen(std::vector<size_t>& faces, Segments& real, Segments& simulated) {
  for (size_t k = faces.size(); k-- > 0;) {
    if (real[k].size() >= kLeastPoints && simulated[k].size() >= kLeastPoints) continue;
    faces.erase(faces.begin() + std::ptrdiff_t(k));
    real.erase(real.begin() + std::ptrdiff_t(k));
    simulated.erase(simulated.begin() + std::ptrdiff_t(k));
  }
  require(faces.size() >= 3, "verification: fewer than three faces have points of both clouds");
}

/// Returns every n-th point, so that about `kMostPaired` are left.
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

/// The faces that both clouds saw, and their points in each cloud's own frame.
struct Segmented {
  std::vector<size_t> faces;
  Segments real, simulated;
  Segments inner_real, inner_simulated;  ///< The points with their whole footprint on the face.
};

std::vector<double> ranges_of(const std::vector<Vec3>& points) {
  std::vector<double> out;
  out.reserve(points.size());
  for (const Vec3& p : points) out.push_back(p.norm());
  return out;
}

/// Lays the simulated points onto the real ones and measures them there.
Registered registered(const Segmented& both, const CloudPair& pair,
                      const std::vector<Plane>& real_plane, const Pose& real_from_target,
                      double histogram_bin_m) {
  Registered out;
  out.real_from_target = real_from_target;
  for (size_t k = 0; k < both.faces.size(); ++k) {
    PatchFigures patch;
    patch.face = both.faces[k];
    patch.plane = real_plane[k];
    std::vector<Vec3> turned, laid;  // `turned`: x points right, y forward.
    for (const Vec3& p : both.real[k]) turned.emplace_back(-p.y(), p.x(), p.z());
    for (const Vec3& p : both.simulated[k]) laid.push_back(real_from_target * p);
    patch.height = fit_height_plane(turned);
    patch.real = distances_from(patch.plane, both.real[k]);
    patch.simulated = distances_from(patch.plane, laid);
    if (std::min(both.inner_real[k].size(), both.inner_simulated[k].size()) >= kLeastPoints) {
      for (Vec3& p : laid = both.inner_simulated[k]) p = real_from_target * p;
      patch.inner_real = fit_plane(both.inner_real[k]);
      patch.inner_simulated = fit_plane(laid);
      patch.inner_real_points = both.inner_real[k].size();
      patch.inner_simulated_points = laid.size();
    }
    out.patches.push_back(patch);
  }
  std::vector<Vec3> laid;
  for (const Vec3& p : pair.simulated) laid.push_back(real_from_target * p);
  out.histograms =
      range_histograms(ranges_of(pair.real), ranges_of(laid), histogram_bin_m, kHalfStepM);
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

double Registered::mean_distance_m() const { return mean_over(patches, &PatchFigures::simulated); }
double Registered::real_mean_distance_m() const { return mean_over(patches, &PatchFigures::real); }

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
  out.icp = icp(some_of(pair.simulated), some_of(pair.real), pair.real_from_target, closest);
  const Pose by_icp = out.icp.to_from_from;
  keep_target(solid, faces, by_icp.inverse(), pair.real);
  keep_target(solid, faces, {}, pair.simulated);
  out.real_points = pair.real.size();
  out.simulated_points = pair.simulated.size();
  const std::vector<double> border(faces.size(), kBorderM);
  Segmented both{faces,
                 segmented(solid, faces, pair.real, by_icp.inverse(), border),
                 segmented(solid, faces, pair.simulated, Pose{}, border),
                 {},
                 {}};
  keep_seen(both.faces, both.real, both.simulated);
  const std::vector<double> reach =
      reach_of_footprints(solid, both.faces, by_icp.inverse().translation);
  both.inner_real = segmented(solid, both.faces, pair.real, by_icp.inverse(), reach);
  both.inner_simulated = segmented(solid, both.faces, pair.simulated, Pose{}, reach);
  const std::vector<Plane> real_plane = planes_of(both.real),
                           simulated_plane = planes_of(both.simulated);
  std::vector<Vec3> conjugate;
  for (const auto& [a, b, c] : corners_of(solid, both.faces)) {
    out.conjugate_real.push_back(intersection(real_plane[a], real_plane[b], real_plane[c]));
    conjugate.push_back(intersection(simulated_plane[a], simulated_plane[b], simulated_plane[c]));
  }
  const Pose by_corners = conjugate.size() < 3 ? by_icp : align(conjugate, out.conjugate_real).pose;
  for (size_t k = 0; k < conjugate.size(); ++k) {
    const double n = double(conjugate.size());
    const Vec3 left = by_corners * conjugate[k] - out.conjugate_real[k];
    const Vec3 moved = (by_corners.inverse() * by_icp) * conjugate[k];
    out.conjugate_rms_m += left.squaredNorm() / n;
    out.corners_against_icp_m += (moved - conjugate[k]).squaredNorm() / n;
  }
  out.conjugate_rms_m = std::sqrt(out.conjugate_rms_m);
  out.corners_against_icp_m = std::sqrt(out.corners_against_icp_m);
  out.by_icp = registered(both, pair, real_plane, by_icp, histogram_bin_m);
  out.by_corners = registered(both, pair, real_plane, by_corners, histogram_bin_m);
  return out;
}

}  // namespace underbrush::studies
