#include "underbrush/perception/resolution.hpp"

#include <algorithm>
#include <limits>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {
namespace {

constexpr size_t kMostSampled = 64;  // Points of a segment between which distances are measured.

}  // namespace

void ResolutionOptions::check() const {
  require(least_gap_m >= 0 && gap_rad >= 0, "resolution: gaps must not be negative");
  require(split_factor >= 1, "resolution: the factor of a split must be at least 1");
}

Resolution::Resolution(const ResolutionOptions& options) : options_(options) { options_.check(); }

void Resolution::sample(const Segments& segments) {
  samples_.clear();
  points_.clear();
  for (size_t s = 0; s < segments.size(); ++s) {
    const auto points = segments.points(s);
    Sample out{uint32_t(points_.size()), 0, Vec3::Zero(), 0};
    const size_t step = points.size() / kMostSampled + 1;
    for (size_t i = 0; i < points.size(); i += step) {
      points_.push_back(points[i]);
      out.centre += points[i];
    }
    out.end = uint32_t(points_.size());
    if (out.end > out.begin) out.centre /= double(out.end - out.begin);
    for (uint32_t i = out.begin; i < out.end; ++i) {
      out.radius = std::max(out.radius, (points_[i] - out.centre).head<2>().norm());
    }
    samples_.push_back(out);
  }
}

double Resolution::gap(const Sample& a, const Sample& b) const {
  double least = std::numeric_limits<double>::infinity();
  for (uint32_t i = a.begin; i < a.end; ++i) {
    for (uint32_t j = b.begin; j < b.end; ++j) {
      least = std::min(least, (points_[i] - points_[j]).head<2>().squaredNorm());
    }
  }
  return std::sqrt(least);
}

bool Resolution::merge(std::span<const uint64_t> ids, std::span<const uint8_t> listed,
                       const Vec3& viewpoint, Segments& segments) {
  if (!options_.enabled) return false;
  sample(segments);
  now_.clear();
  const auto n = uint32_t(segments.size());
  target_.resize(n);
  for (uint32_t s = 0; s < n; ++s) target_[s] = s;
  const auto root = [&](uint32_t s) {
    while (target_[s] != s) s = target_[s];
    return s;
  };
  const auto is_stronger = [&](uint32_t a, uint32_t b) {
    if (listed[a] != listed[b]) return listed[a] > listed[b];
    return segments.points(a).size() >= segments.points(b).size();
  };
  for (uint32_t a = 0; a < n; ++a) {
    for (uint32_t b = a + 1; b < n; ++b) {
      const Sample &p = samples_[a], &q = samples_[b];
      if (p.begin == p.end || q.begin == q.end) continue;
      const double range = ((p.centre + q.centre) / 2 - viewpoint).head<2>().norm();
      double limit = std::max(options_.least_gap_m, options_.gap_rad * range);
      const MergedPair pair{std::min(ids[a], ids[b]), std::max(ids[a], ids[b])};
      if (std::binary_search(merged_.begin(), merged_.end(), pair)) limit *= options_.split_factor;
      const double apart = (p.centre - q.centre).head<2>().norm() - p.radius - q.radius;
      if (apart > limit || gap(p, q) > limit) continue;
      now_.push_back(pair);
      const uint32_t first = root(a), second = root(b);
      if (first == second) continue;
      if (is_stronger(first, second)) {
        target_[second] = first;
      } else {
        target_[first] = second;
      }
    }
  }
  std::sort(now_.begin(), now_.end());
  std::swap(merged_, now_);
  for (uint32_t& s : segments.of_point) {
    if (s != kNoSegment) s = root(s);
  }
  return !merged_.empty();
}

}  // namespace underbrush::perception
