#include "underbrush/compact/track.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/compact/exact_math.hpp"

namespace underbrush::compact {
namespace {

Vector vector_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Segment segment_of(const ScanInfo& a, const ScanInfo& b) {
  const Eigen::Quaterniond& q = a.world_from_sensor.rotation;
  const Eigen::AngleAxisd turn(q.conjugate() * b.world_from_sensor.rotation);
  double angle = turn.angle();
  if (angle > M_PI) angle -= 2 * M_PI;
  return {a.time_s,
          b.time_s,
          vector_of(a.world_from_sensor.translation),
          vector_of(b.world_from_sensor.translation),
          {q.w(), q.x(), q.y(), q.z()},
          angle / 2,
          vector_of(turn.axis())};
}

}  // namespace

Track::Track(const std::vector<ScanInfo>& scans, double first_s, double last_s) {
  const auto falls = [](const ScanInfo& a, const ScanInfo& b) { return !(a.time_s < b.time_s); };
  if (scans.size() < 2 || std::adjacent_find(scans.begin(), scans.end(), falls) != scans.end()) {
    return;
  }
  const auto after = [&](double time_s) {
    return std::upper_bound(scans.begin() + 1, scans.end() - 1, time_s,
                            [](double t, const ScanInfo& s) { return t < s.time_s; });
  };
  constexpr std::ptrdiff_t kMostSegments = 1000;
  const auto begin = after(first_s), end = after(last_s);
  if (end - begin >= kMostSegments) return;
  for (auto b = begin; b <= end; ++b) segments_.push_back(segment_of(*(b - 1), *b));
}

Place Track::at(double time_s) const {
  if (segments_.empty()) return {};
  size_t k = 0;
  while (k + 1 < segments_.size() && !(time_s < segments_[k].end_s)) ++k;
  const Segment& g = segments_[k];
  const double s = (time_s - g.begin_s) / (g.end_s - g.begin_s);
  const SineCosine half = sine_cosine(s * g.half_angle);
  const Turn& a = g.start;
  const Turn b = {half.cosine, half.sine * g.axis.x, half.sine * g.axis.y, half.sine * g.axis.z};
  return {
      {g.from.x + s * (g.to.x - g.from.x), g.from.y + s * (g.to.y - g.from.y),
       g.from.z + s * (g.to.z - g.from.z)},
      {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
       a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
       a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w}};
}

void Track::append_to(std::string& out) const {
  put(out, uint16_t(segments_.size()));
  for (const Segment& s : segments_) put(out, s);
}

Track Track::read(Cursor& in) {
  static_assert(sizeof(Segment) == 16 * sizeof(double));
  Track out;
  const auto n = in.get<uint16_t>();
  in.require(n * sizeof(Segment));
  out.segments_.resize(n);
  for (Segment& s : out.segments_) s = in.get<Segment>();
  return out;
}

}  // namespace underbrush::compact
