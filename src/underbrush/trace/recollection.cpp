#include "underbrush/trace/recollection.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::trace {
namespace {

using elements::Keyframe;
using elements::KeyframePixel;
using elements::Keyframes;
using elements::KeyframeTrust;

constexpr double kFar = 100;         // m; where a pixel without a return is looked for
constexpr double kLeastRange = 0.1;  // m; nothing nearer is recalled
constexpr int kSteps = 6;

}  // namespace

/// The four pixels that are seen nearest to a direction, the nearest first.
class Recollection::Nearest {
 public:
  void offer(float angle2, uint32_t pixel) {
    if (count_ == kMost && !(angle2 < seen_[kMost - 1].angle2)) return;
    size_t at = count_ < kMost ? count_++ : kMost - 1;
    for (; at > 0 && angle2 < seen_[at - 1].angle2; --at) seen_[at] = seen_[at - 1];
    seen_[at] = {angle2, pixel};
  }
  size_t size() const { return count_; }
  uint32_t operator[](size_t k) const { return seen_[k].pixel; }

 private:
  static constexpr size_t kMost = Keyframes::kPixelsOfFrame;
  struct Seen {
    float angle2;
    uint32_t pixel;
  };
  Seen seen_[kMost];
  size_t count_ = 0;
};

namespace {

bool is_own(const Keyframes& k, const KeyframePixel& p, const Vec3& own) {
  return p.is_hit() && (k.point(p) - own).squaredNorm() < 4 * k.unit_m * k.unit_m;
}

}  // namespace

Recollection::Recollection(const elements::Model& model)
    : model_(model), keyframes_(model.keyframes.get()) {
  if (keyframes_) grid_.emplace(*keyframes_);
}

bool Recollection::serves(const LogInfo& beams) const {
  return keyframes_ && !keyframes_->frames.empty() && beams.sensor == model_.sensor &&
         beams.sensor_file == model_.sensor_file;
}

std::vector<uint32_t> Recollection::candidates(std::span<const Vec3> origins) const {
  std::vector<uint32_t> out;
  if (origins.empty()) return out;
  Vec3 low = origins[0], high = origins[0];
  for (const Vec3& o : origins) low = low.cwiseMin(o), high = high.cwiseMax(o);
  const Vec3 middle = 0.5 * (low + high) - model_.origin;
  // A keyframe farther from the box than the last distance is of no use to any place in it.
  const double most = Keyframes::kDistances.back() + 0.5 * (high - low).norm();
  for (uint32_t f = 0; f < keyframes_->frames.size(); ++f) {
    if ((keyframes_->frames[f].origin - middle).norm() <= most) out.push_back(f);
  }
  return out;
}

Recollection::Near Recollection::near(const Vec3& origin, std::span<const uint32_t> among,
                                      double least_m, uint32_t except) const {
  Near out;
  const Vec3 at = origin - model_.origin;
  double first = HUGE_VAL, second = HUGE_VAL;
  for (const uint32_t f : among) {
    const double d = (keyframes_->frames[f].origin - at).squaredNorm();
    if (f == except || d < least_m * least_m) continue;
    if (d < first) {
      out.frame = {f, out.frame[0]};
      second = first;
      first = d;
    } else if (d < second) {
      out.frame[1] = f;
      second = d;
    }
  }
  out.distance_m = std::sqrt(first);
  return out;
}

// A return is seen where its end point is, a miss in the middle of its pixel.
void Recollection::find(const Keyframe& f, const Vec3& at, Nearest& out) const {
  const Keyframes& k = *keyframes_;
  auto place = grid_->place(f.sensor_from_world * at);
  Vec3f from = f.column_origin[size_t(place.column)];
  if (from.squaredNorm() > 1e-6f) {
    place = grid_->place(f.sensor_from_world * (at - from.cast<double>()));
    from = f.column_origin[size_t(place.column)];
  }
  if (place.row < 0) return;
  const Vec3f towards = (at.cast<float>() - from).normalized();
  const auto unit = float(k.unit_m), turn = float(2 * M_PI / double(k.columns));
  const auto elevation = float(grid_->elevation(place.row)), column = float(place.column - 0.5);
  const int columns = int(k.columns), rows = int(k.rows());
  const int middle = int(place.row), first = int(place.column) - 1;
  for (int row = std::max(0, middle - 1); row <= std::min(rows - 1, middle + 1); ++row) {
    for (int c = first; c <= first + 2; ++c) {
      const int inside = c < 0 ? c + columns : c >= columns ? c - columns : c;
      const auto number = uint32_t(row * columns + inside);
      const KeyframePixel& p = f.pixels[number];
      if (p.is_hit()) {
        const Vec3f to = unit * Vec3f(float(p.x), float(p.y), float(p.z)) - from;
        out.offer(to.cross(towards).squaredNorm() / to.squaredNorm(), number);
      } else if (p.is_miss()) {
        const float up = elevation - float(k.elevation[size_t(row)]);
        const float aside = (column - float(c)) * turn;
        out.offer(up * up + aside * aside, number);
      }
    }
  }
}

void Recollection::look(const Vec3& from, const Vec3& direction, uint32_t number, size_t slot,
                        const Vec3* own, Recalled& out) const {
  const Keyframes& k = *keyframes_;
  const Keyframe& f = k.frames[number];
  const auto along = [&](const KeyframePixel& p) { return (k.point(p) - from).dot(direction); };
  double t = kFar;
  uint32_t last = Near::kNone;
  Nearest seen;
  for (int step = 0; step < kSteps; ++step) {
    Nearest next;
    find(f, from + t * direction, next);
    if (next.size() == 0 || next[0] == last) break;
    last = next[0];
    const KeyframePixel& p = f.pixels[last];
    t = p.is_hit() ? std::max(along(p), kLeastRange) : kFar;
  }
  find(f, from + t * direction, seen);
  const bool nearest_is_own = own && !own->allFinite();
  for (size_t j = nearest_is_own ? 1 : 0; j < seen.size(); ++j) {
    const KeyframePixel& p = f.pixels[seen[j]];
    if (own && !nearest_is_own && is_own(k, p, *own - model_.origin - f.origin)) continue;
    const double range = p.is_miss() ? HUGE_VAL : along(p);
    if (!(range >= kLeastRange)) continue;
    if (out.count == 0) out.nearest = uint64_t(number) * k.pixels() + seen[j];
    out.range_m[out.count] = range;
    out.intensity[out.count] = float(double(p.intensity) * k.intensity_unit);
    out.rank[out.count++] = uint8_t(slot * Keyframes::kPixelsOfFrame + j);
  }
}

Recalled Recollection::recall(const Ray& ray, const Near& near, const Vec3* own) const {
  Recalled out;
  const auto& limits = Keyframes::kDistances;
  const size_t bin =
      size_t(std::lower_bound(limits.begin(), limits.end(), near.distance_m) - limits.begin());
  if (bin == limits.size()) return out;
  for (size_t slot = 0; slot < near.frame.size(); ++slot) {
    const uint32_t f = near.frame[slot];
    if (f == Near::kNone) break;
    look(ray.origin - model_.origin - keyframes_->frames[f].origin, ray.direction, f, slot, own,
         out);
  }
  if (out.count == 0) return out;
  out.situation = bin * Keyframes::kAgreements + elements::agreement(out.range_m.data(), out.count);
  return out;
}

std::optional<RecalledReturn> Recollection::drawn(const Recalled& r, uint64_t choice,
                                                  uint64_t noise) const {
  if (r.count == 0) return {};
  const KeyframeTrust& t = trust(r);
  double u = uniform_from_bits(random_bits(choice, 0, Purpose::kRecall));
  for (size_t k = 0; k < r.count; ++k) {
    const double weight = t.pixel[r.rank[k]];
    if (u >= weight) {
      u -= weight;
      continue;
    }
    if (std::isinf(r.range_m[k])) return RecalledReturn{HUGE_VAL, 0, 0};
    double part = u / weight;
    size_t s = 0;
    while (s + 1 < t.scale.size() && part >= t.scale[s]) part -= t.scale[s++];
    double sum = 0;
    size_t same = 0;
    for (size_t j = 0; j < r.count; ++j) {
      if (std::abs(r.range_m[j] - r.range_m[k]) > 0.5) continue;
      sum += double(r.intensity[j]);
      ++same;
    }
    return RecalledReturn{r.range_m[k] + t.sigma_m[s] * normal(noise, 0, Purpose::kRecall),
                          r.intensity[k], float(sum / double(same))};
  }
  return {};
}

void Recollection::mix(const Recalled& r, RangeMixture& p) const {
  if (r.count == 0) return;
  const KeyframeTrust& t = trust(r);
  double recalled = 0;
  for (size_t k = 0; k < r.count; ++k) recalled += t.pixel[r.rank[k]];
  for (auto& c : p.components) c.weight *= 1 - recalled;
  p.miss *= 1 - recalled;
  for (size_t k = 0; k < r.count; ++k) {
    const double weight = t.pixel[r.rank[k]];
    if (std::isinf(r.range_m[k])) {
      p.miss += weight;
      continue;
    }
    for (size_t s = 0; s < t.scale.size(); ++s) {
      if (weight * t.scale[s] > 1e-4) {
        p.components.push_back({weight * t.scale[s], r.range_m[k], t.sigma_m[s]});
      }
    }
  }
}

}  // namespace underbrush::trace
