#include "underbrush/keyframes/keyframe_cache.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/core/rng.hpp"
#include "underbrush/keyframes/scan_pattern.hpp"

namespace underbrush::keyframes {
namespace {

using elements::Keyframe;
using elements::KeyframePixel;
using elements::Keyframes;
using elements::KeyframeWeights;

/// Pixels of a patch.
constexpr uint64_t kPatchRows = 4, kPatchColumns = 8;

}  // namespace

KeyframeCache::KeyframeCache(const elements::Model& model)
    : model_(model), keyframes_(model.keyframes.get()) {
  if (!keyframes_ || keyframes_->frames.empty()) return;
  grid_.emplace(*keyframes_);
  look_up_grid_.emplace(*keyframes_);
  for (size_t k = 0; k < Keyframes::kSituations; ++k) {
    const double weight = 1 - keyframes_->weights[k].elements;
    const size_t bin = k / Keyframes::kAgreements, agreement = k % Keyframes::kAgreements;
    greatest_weight_[bin] = std::max(greatest_weight_[bin], weight);
    if (agreement < 2) continue;
    greatest_weight_of_returns_[bin] = std::max(greatest_weight_of_returns_[bin], weight);
  }
}

size_t KeyframeCache::distance_bin(const Near& near) {
  size_t bin = 0;  // A search would take more branches.
  for (const double limit_m : Keyframes::kDistances) bin += limit_m < near.distance_m;
  return bin;
}

uint64_t KeyframeCache::patch_of(const Vec3& point, const Near& near) const {
  const Keyframe& f = keyframes_->frames[near.frame[0]];
  const auto place = grid_->place(f.sensor_from_world * (point - model_.origin - f.origin));
  const auto row = uint64_t(place.row + 1) / kPatchRows;  // a row off the image is −1
  const auto column = uint64_t(place.column) / kPatchColumns;
  const uint64_t rows = keyframes_->rows() / kPatchRows + 1;
  return (near.frame[0] * rows + row) * keyframes_->columns + column;
}

bool KeyframeCache::serves(const elements::Model& model, const LogInfo& beams) {
  return model.keyframes && !model.keyframes->frames.empty() && beams.sensor == model.sensor &&
         beams.sensor_file == model.sensor_file;
}

bool KeyframeCache::serves(const elements::Model& model, BeamSource& log) {
  if (!serves(model, log.info())) return false;
  if (!model.sensor.empty() || !model.sensor_file.empty()) return true;
  const ScanPattern pattern = scan_pattern(log, model.keyframes->channel.empty());
  log.rewind();
  return is_of_sensor(model, log.info(), pattern);
}

std::vector<uint32_t> KeyframeCache::candidates(std::span<const Vec3> origins) const {
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

std::vector<uint32_t> KeyframeCache::nearest_candidates(std::span<const Vec3> origins) const {
  std::vector<uint32_t> out = candidates(origins);
  if (out.size() <= Keyframes::kFrames) return out;
  Vec3 low = origins[0], high = origins[0];
  for (const Vec3& o : origins) low = low.cwiseMin(o), high = high.cwiseMax(o);
  const Vec3 middle = 0.5 * (low + high) - model_.origin;
  const auto distance = [&](uint32_t f) { return (keyframes_->frames[f].origin - middle).norm(); };
  std::vector<double> distances;
  distances.reserve(out.size());
  for (const uint32_t f : out) distances.push_back(distance(f));
  std::nth_element(distances.begin(), distances.begin() + Keyframes::kFrames - 1, distances.end());
  // From no place in the box is one of them farther than this, or another one nearer. The last
  // centimetre is for rounding.
  const double most = distances[Keyframes::kFrames - 1] + (high - low).norm() + 0.01;
  std::erase_if(out, [&](uint32_t f) { return distance(f) > most; });
  return out;
}

KeyframeCache::Near KeyframeCache::near(const Vec3& origin, std::span<const uint32_t> among,
                                        double least_m, uint32_t except) const {
  Near out;
  const Vec3 at = origin - model_.origin;
  constexpr double kFarthestM = Keyframes::kDistances.back();
  double first = HUGE_VAL, second = HUGE_VAL;
  for (const uint32_t f : among) {
    const double d = (keyframes_->frames[f].origin - at).squaredNorm();
    if (f == except || d < least_m * least_m || d > kFarthestM * kFarthestM) continue;
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

void KeyframeCache::add_pixels(const Query& beam, uint32_t frame, size_t slot,
                               const PixelLookUp& found, size_t lane, CachedPixels& out) const {
  const Keyframes& k = *keyframes_;
  const Keyframe& f = k.frames[frame];
  const Vec3 from = beam.ray.origin - model_.origin - f.origin;
  for (size_t j = 0; j < PixelLookUp::kFound; ++j) {
    const uint32_t pixel = found.pixel[j][lane];
    if (pixel == PixelLookUp::kNone) break;
    const KeyframePixel& p = f.pixels[pixel];
    const double range = p.is_miss() ? HUGE_VAL : (k.point(p) - from).dot(beam.ray.direction);
    if (!(range >= double(PixelLookUp::kLeastRangeM))) continue;
    out.range_m[out.count] = range;
    out.intensity[out.count] = float(double(p.intensity) * k.intensity_unit);
    out.rank[out.count++] = uint8_t(slot * Keyframes::kPixelsOfFrame + j);
  }
}

void KeyframeCache::look_up_in(std::span<const Query> beams, std::span<const uint32_t> which,
                               uint32_t frame, size_t slot, std::vector<CachedPixels>& out) const {
  const Vec3 origin = model_.origin + keyframes_->frames[frame].origin;
  for (size_t begin = 0; begin < which.size(); begin += PixelLookUp::kBeams) {
    PixelLookUp found;
    // Where beams are too few, the last one fills the vectors.
    for (size_t l = 0; l < PixelLookUp::kBeams; ++l) {
      const Ray& ray = beams[which[std::min(begin + l, which.size() - 1)]].ray;
      const Vec3f from = (ray.origin - origin).cast<float>(), d = ray.direction.cast<float>();
      found.from.x[l] = from.x(), found.from.y[l] = from.y(), found.from.z[l] = from.z();
      found.direction.x[l] = d.x(), found.direction.y[l] = d.y(), found.direction.z[l] = d.z();
    }
    look_up_pixels(*look_up_grid_, look_up_grid_->frames[frame], found);
    const size_t end = std::min(begin + PixelLookUp::kBeams, which.size());
    for (size_t i = begin; i < end; ++i) {
      add_pixels(beams[which[i]], frame, slot, found, i - begin, out[which[i]]);
    }
  }
}

std::vector<KeyframeCache::Query> KeyframeCache::queries(std::span<const Ray> rays,
                                                         std::span<const uint16_t> rings) const {
  std::vector<Vec3> origins;
  origins.reserve(rays.size());
  for (const Ray& ray : rays) origins.push_back(ray.origin);
  const std::vector<uint32_t> among = nearest_candidates(origins);
  std::vector<Query> out;
  out.reserve(rays.size());
  std::vector<bool> knows(size_t(1) << 16, keyframes_->channel.empty());
  for (const uint16_t ring : keyframes_->channel) knows[ring] = true;
  Near nearest;
  for (size_t k = 0; k < rays.size(); ++k) {
    if (k == 0 || origins[k] != origins[k - 1]) nearest = near(origins[k], among);
    out.push_back({rays[k], knows[rings[k]] ? nearest : Near(), 0});
  }
  return out;
}

std::vector<CachedPixels> KeyframeCache::look_up(std::span<const Query> beams) const {
  // Copies of a value are made faster than values that the vector sets to zero first.
  std::vector<CachedPixels> out(beams.size(), CachedPixels{});
  std::vector<uint32_t> ready;
  ready.reserve(beams.size());
  for (uint32_t i = 0; i < beams.size(); ++i) {
    if (distance_bin(beams[i].near) < Keyframes::kDistances.size()) ready.push_back(i);
  }
  std::map<uint32_t, std::vector<uint32_t>> by_frame;
  for (size_t slot = 0; slot < Keyframes::kFrames; ++slot) {
    by_frame.clear();
    for (const uint32_t i : ready) {
      if (beams[i].near.frame[slot] != Near::kNone)
        by_frame[beams[i].near.frame[slot]].push_back(i);
    }
    for (const auto& [frame, which] : by_frame) look_up_in(beams, which, frame, slot, out);
    if (slot > 0) continue;
    // Four returns of one keyframe are at least half of the pixels found.
    std::erase_if(ready, [&](uint32_t i) {
      CachedPixels& r = out[i];
      const bool returned = r.count == Keyframes::kPixelsOfFrame &&
                            std::all_of(r.range_m.begin(), r.range_m.begin() + ptrdiff_t(r.count),
                                        [](double range) { return std::isfinite(range); });
      if (!returned || !(beams[i].u > 0) ||
          beams[i].u < greatest_weight_of_returns_[distance_bin(beams[i].near)])
        return false;
      r.count = 0;
      return true;
    });
  }
  for (const uint32_t i : ready) {
    if (out[i].count == 0) continue;
    out[i].situation = distance_bin(beams[i].near) * Keyframes::kAgreements +
                       elements::agreement(out[i].range_m.data(), out[i].count);
  }
  return out;
}

std::optional<CachedReturn> KeyframeCache::drawn(const CachedPixels& r, double u,
                                                 uint64_t noise) const {
  if (r.count == 0) return {};
  const KeyframeWeights& t = weights(r);
  for (size_t k = 0; k < r.count; ++k) {
    const double weight = t.pixel[r.rank[k]];
    if (u >= weight) {
      u -= weight;
      continue;
    }
    if (std::isinf(r.range_m[k])) return CachedReturn{HUGE_VAL, 0, 0};
    double part = u / weight;
    size_t s = 0;
    while (s + 1 < t.scale.size() && part >= t.scale[s]) part -= t.scale[s++];
    CachedReturn out = return_of(r, k);
    out.range_m += t.sigma_m[s] * normal(noise, 0, Purpose::kKeyframe);
    return out;
  }
  return {};
}

CachedReturn KeyframeCache::return_of(const CachedPixels& r, size_t k) {
  double sum = 0;
  size_t same = 0;
  for (size_t j = 0; j < r.count; ++j) {
    if (std::abs(r.range_m[j] - r.range_m[k]) > 0.5) continue;
    sum += double(r.intensity[j]);
    ++same;
  }
  return {r.range_m[k], r.intensity[k], float(sum / double(same))};
}

void KeyframeCache::mix(const CachedPixels& r, trace::RangeMixture& p) const {
  if (r.count == 0) return;
  const KeyframeWeights& t = weights(r);
  double cached = 0;
  for (size_t k = 0; k < r.count; ++k) cached += t.pixel[r.rank[k]];
  for (auto& c : p.components) c.weight *= 1 - cached;
  p.miss *= 1 - cached;
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

}  // namespace underbrush::keyframes
