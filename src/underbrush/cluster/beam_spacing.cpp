#include "underbrush/cluster/beam_spacing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/median.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::cluster {
namespace {

constexpr size_t kScans = 4, kMostRows = size_t(1) << 19;
constexpr size_t kAsked = 2000;  // beams of a scan whose neighbours are found
constexpr double kLeastAngle = 1e-5, kMostAngle = 5 * M_PI / 180;  // rad
constexpr double kPlaceM = 0.25;

/// A beam of a ring: its azimuth, rad, and its direction.
struct RingBeam {
  double azimuth = 0;
  Vec3f direction;
  bool operator<(const RingBeam& o) const {
    return azimuth != o.azimuth ? azimuth < o.azimuth : direction.z() < o.direction.z();
  }
};

using Ring = std::vector<RingBeam>;

double angle(const Vec3f& a, const Vec3f& b) { return double((a - b).norm()); }

/// The beam of a ring that is nearest to a beam of another ring.
const RingBeam& nearest_in(const Ring& ring, const RingBeam& beam) {
  const auto next = std::lower_bound(ring.begin(), ring.end(), beam) - ring.begin();
  const auto size = std::ptrdiff_t(ring.size());
  const RingBeam& after = ring[size_t(next % size)];
  const RingBeam& before = ring[size_t((next + size - 1) % size)];
  return angle(after.direction, beam.direction) < angle(before.direction, beam.direction) ? after
                                                                                          : before;
}

/// The angle from a beam, number `at` of its ring, to the nearest other direction of the ring. It
/// searches by azimuth to both sides, because beams without rings count as one ring.
double angle_in(const Ring& ring, size_t at) {
  constexpr size_t kMostSteps = 1000;
  const RingBeam& beam = ring[at];
  const double flat = std::hypot(double(beam.direction.x()), double(beam.direction.y()));
  double least = kMostAngle;
  for (const int side : {-1, 1}) {
    for (size_t step = 1; step <= kMostSteps; ++step) {
      const size_t next = side < 0 ? at - step : at + step;
      if (next >= ring.size() || flat * std::abs(ring[next].azimuth - beam.azimuth) > least) break;
      const double found = angle(ring[next].direction, beam.direction);
      if (found > kLeastAngle) least = std::min(least, found);
    }
  }
  return least;
}

/// The mean of the angles to the nearest rings above and below, or the one that there is.
double angle_between(const std::map<uint16_t, Ring>& rings, uint16_t own, const RingBeam& beam) {
  std::array<double, 2> least{kMostAngle, kMostAngle};
  for (const auto& [number, ring] : rings) {
    if (number == own) continue;
    const RingBeam& other = nearest_in(ring, beam);
    double& side = least[other.direction.z() > beam.direction.z()];
    side = std::min(side, angle(other.direction, beam.direction));
  }
  const auto [nearer, farther] = std::minmax(least[0], least[1]);
  return farther < kMostAngle ? (nearer + farther) / 2 : nearer;
}

/// The angles between neighbours of a scan.
struct Angles {
  explicit Angles(std::map<uint16_t, Ring>& rings) {
    size_t beams = 0;
    for (auto& [number, ring] : rings) {
      std::sort(ring.begin(), ring.end());
      beams += ring.size();
    }
    const size_t step = std::max<size_t>(1, beams / kAsked);
    size_t at = 0;
    for (const auto& [number, ring] : rings) {
      for (size_t k = 0; k < ring.size(); ++k) {
        if (at++ % step != 0) continue;
        const double found = angle_in(ring, k);
        keep(found, in_ring);
        keep(rings.size() > 1 ? angle_between(rings, number, ring[k]) : found, from_ring);
      }
    }
  }

  std::vector<double> in_ring, from_ring;  ///< rad

 private:
  static void keep(double angle, std::vector<double>& angles) {
    if (angle < kMostAngle) angles.push_back(angle);
  }
};

/// A place of the sensor, and where its beams pass a cluster's first point: the parts of the gaps
/// in its ring and between rings, from 0 to 1.
struct Strokes {
  std::array<int32_t, 3> cell;
  std::array<double, 2> part;
};

/// The sums over the points of a cluster.
struct OpenSums {
  size_t n = 0;
  Vec3 first;
  std::array<Mat3, 2> squares{Mat3::Zero(), Mat3::Zero()};  // in the ring and between rings
  std::vector<Strokes> places;
};

/// By how much the strokes of several places reduce the variance of matter that reaches half way
/// from each stroke to the next. `part` has their places in a gap, which are sorted.
double share_of_gap(std::vector<double>& part) {
  std::sort(part.begin(), part.end());
  double sum = 0;
  for (size_t k = 0; k < part.size(); ++k) {
    const double gap = k + 1 < part.size() ? part[k + 1] - part[k] : part[0] + 1 - part[k];
    sum += gap * gap * gap;
  }
  return sum;
}

/// The covariance of a cluster's matter between the beams.
Mat3 open_covariance(OpenSums& of) {
  std::stable_sort(of.places.begin(), of.places.end(),
                   [](const Strokes& a, const Strokes& b) { return a.cell < b.cell; });
  const auto last =
      std::unique(of.places.begin(), of.places.end(),
                  [](const Strokes& a, const Strokes& b) { return a.cell == b.cell; });
  of.places.erase(last, of.places.end());
  Mat3 out = Mat3::Zero();
  for (size_t k = 0; k < 2; ++k) {
    std::vector<double> part;
    for (const Strokes& place : of.places) part.push_back(place.part[k]);
    out += of.squares[k] * share_of_gap(part);
  }
  return out / (12 * double(of.n));
}

}  // namespace

BeamSpacing beam_spacing(BeamSource& log) {
  std::map<uint32_t, std::map<uint16_t, Ring>> scans;
  Ring* ring = nullptr;
  std::pair<uint32_t, uint16_t> of_ring;  // its scan and its number
  size_t rows = 0;
  log.rewind();
  for (BeamLog chunk; rows < kMostRows && log.next(chunk);) {
    for (size_t i = 0; i < chunk.size() && rows < kMostRows; ++i) {
      const std::pair at(chunk.scan[i], chunk.ring[i]);
      if (!ring || at != of_ring) {
        if (scans.size() == kScans && !scans.contains(at.first)) {
          rows = kMostRows;
          break;
        }
        ring = &scans[at.first][at.second];
        of_ring = at;
      }
      const Vec3f& d = chunk.direction[i];
      ring->push_back({std::atan2(double(d.y()), double(d.x())), d});
      ++rows;
    }
  }
  std::vector<std::map<uint16_t, Ring>*> rings;
  rings.reserve(scans.size());
  for (auto& [number, of_scan] : scans) rings.push_back(&of_scan);
  std::vector<std::optional<Angles>> of_scan(rings.size());
  parallel_for(rings.size(), 1, [&](size_t k, size_t) { of_scan[k].emplace(*rings[k]); });
  std::vector<double> in_ring, from_ring;
  for (const std::optional<Angles>& a : of_scan) {
    in_ring.insert(in_ring.end(), a->in_ring.begin(), a->in_ring.end());
    from_ring.insert(from_ring.end(), a->from_ring.begin(), a->from_ring.end());
  }
  return {median(std::move(in_ring)), median(std::move(from_ring))};
}

std::vector<Eigen::Matrix3f> open_covariances(std::span<const Vec3f> points,
                                              std::span<const Vec3f> to_sensor,
                                              const Clusters& clusters,
                                              const BeamSpacing& spacing) {
  require(points.size() == to_sensor.size() && points.size() == clusters.group.size(),
          "points, directions and clusters differ in number");
  std::vector<OpenSums> sums(clusters.count);
  for (size_t i = 0; i < points.size(); ++i) {
    if (clusters.group[i] == Clusters::kNone) continue;
    OpenSums& of = sums[clusters.group[i]];
    const Vec3 sight = to_sensor[i].cast<double>(), point = points[i].cast<double>();
    if (of.n++ == 0) of.first = point;
    const Vec3 along = Vec3(-sight.y(), sight.x(), 0).normalized();
    // Both vectors have the length of a gap, r times the angle.
    const Vec3 gaps[2] = {spacing.in_ring * sight.norm() * along,
                          spacing.from_ring * along.cross(sight)};
    const Vec3f place = (points[i] + to_sensor[i]) / float(kPlaceM);
    Strokes strokes{};
    for (size_t k = 0; k < 3; ++k) strokes.cell[k] = int32_t(std::floor(place[int(k)]));
    for (size_t k = 0; k < 2; ++k) {
      of.squares[k] += gaps[k] * gaps[k].transpose();
      const double length2 = gaps[k].squaredNorm();
      const double away = length2 > 0 ? (point - of.first).dot(gaps[k]) / length2 : 0;
      strokes.part[k] = away - std::floor(away);
    }
    if (of.places.empty() || of.places.back().cell != strokes.cell) of.places.push_back(strokes);
  }
  std::vector<Eigen::Matrix3f> out;
  for (OpenSums& of : sums) {
    if (of.n > 0) out.push_back(open_covariance(of).cast<float>());
  }
  return out;
}

}  // namespace underbrush::cluster
