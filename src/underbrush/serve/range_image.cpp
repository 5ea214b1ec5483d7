#include "underbrush/serve/range_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/simulation.hpp"
#include "underbrush/serve/bytes.inl"

namespace underbrush::serve {
namespace {

constexpr uint32_t kNoBeam = std::numeric_limits<uint32_t>::max();
constexpr double kMostPixels = 4'194'304;
constexpr uint32_t kWidest = 8192;
constexpr size_t kLeastRings = 4;
constexpr double kAzimuthShare = 0.7;  // columns for each beam of a ring: few pixels stay empty
constexpr float kDirectionTolerance = 0.01F;  // rad

double azimuth(const BeamLog& log, size_t i) {
  return std::atan2(double(log.direction[i].y()), double(log.direction[i].x()));
}
double elevation(const BeamLog& log, size_t i) {
  return std::asin(std::clamp(double(log.direction[i].z()), -1.0, 1.0));
}

/// What the beams of a ring have in common.
struct Ring {
  uint32_t beams = 0, row = 0, next = 0;
  double height = 0;  ///< Sum of the beams' elevations.
  double turn = 0;    ///< Sum of the turns from beam to beam, rad.
  double last = 0;    ///< Azimuth of the beam before.
};

std::map<uint16_t, Ring> rings_of(const BeamLog& beams) {
  std::map<uint16_t, Ring> rings;
  for (size_t i = 0; i < beams.size(); ++i) {
    Ring& ring = rings[beams.ring[i]];
    const double at = azimuth(beams, i);
    if (ring.beams > 0) ring.turn += std::remainder(at - ring.last, 2 * M_PI);
    ring.last = at;
    ring.height += elevation(beams, i);
    ++ring.beams;
  }
  std::vector<Ring*> order;
  order.reserve(rings.size());
  for (auto& [number, ring] : rings) order.push_back(&ring);
  std::stable_sort(order.begin(), order.end(), [](const Ring* a, const Ring* b) {
    return a->height / a->beams > b->height / b->beams;
  });
  for (uint32_t k = 0; k < order.size(); ++k) order[k]->row = k;
  return rings;
}

uint32_t place(double share, uint32_t count) {
  return uint32_t(std::clamp(share * count, 0.0, double(count - 1)));
}

// The limits of an angle over all beams.
template <class F>
std::pair<double, double> limits(size_t n, const F& angle) {
  std::pair out(angle(0), angle(0));
  for (size_t i = 1; i < n; ++i) {
    out.first = std::min(out.first, angle(i));
    out.second = std::max(out.second, angle(i));
  }
  out.second = std::max(out.second, out.first + 1e-6);
  return out;
}

ImageLayout layout_by_angles(const BeamLog& beams) {
  const auto [left, right] = limits(beams.size(), [&](size_t i) { return azimuth(beams, i); });
  const auto [low, high] = limits(beams.size(), [&](size_t i) { return elevation(beams, i); });
  const double pixels = std::min(kAzimuthShare * double(beams.size()), kMostPixels);
  const double width = std::sqrt(pixels * (right - left) / (high - low));
  ImageLayout out;
  out.width = uint32_t(std::clamp(width, 1.0, double(kWidest)));
  out.height = uint32_t(std::clamp(pixels / out.width, 1.0, double(kWidest)));
  for (size_t i = 0; i < beams.size(); ++i) {
    const uint32_t x = place((right - azimuth(beams, i)) / (right - left), out.width);
    const uint32_t y = place((high - elevation(beams, i)) / (high - low), out.height);
    out.pixel.push_back(y * out.width + x);
  }
  return out;
}

ImageLayout layout_by_rings(const BeamLog& beams, std::map<uint16_t, Ring>& rings) {
  uint32_t most = 0, least = kNoBeam;
  double turn = 0;
  for (const auto& [number, ring] : rings) {
    most = std::max(most, ring.beams);
    least = std::min(least, ring.beams);
    turn += ring.turn;
  }
  const bool by_time = most <= least + least / 50;
  const double widest = std::min(double(kWidest), kMostPixels / double(rings.size()));
  ImageLayout out;
  out.height = uint32_t(rings.size());
  out.width = uint32_t(std::clamp(by_time ? double(most) : kAzimuthShare * most, 1.0, widest));
  for (size_t i = 0; i < beams.size(); ++i) {
    Ring& ring = rings[beams.ring[i]];
    double share = 0.5 - azimuth(beams, i) / (2 * M_PI);
    if (by_time) {
      share = (ring.next++ + 0.5) / most;
      if (turn > 0) share = 1 - share;  // the sensor turns to the left
    }
    out.pixel.push_back(ring.row * out.width + place(share, out.width));
  }
  return out;
}

}  // namespace

ImageLayout image_layout(const BeamLog& beams) {
  require(!beams.empty(), "a scan without beams");
  auto rings = rings_of(beams);
  return rings.size() < kLeastRings ? layout_by_angles(beams) : layout_by_rings(beams, rings);
}

std::vector<float> simulated_ranges(const LoggedBeams& beams, const WorldData& world, uint64_t seed,
                                    bool keyframes) {
  BeamLog answered = beams.beams;
  answered.extra.clear();
  pipeline::SimulateOptions options;
  options.seed = seed;
  options.keyframes = keyframes;
  pipeline::Simulation(world.traced(), options).answer(beams.number, answered);
  return answered.range_m;
}

std::vector<float> other_ranges(const LoggedBeams& beams, LogData& other) {
  constexpr const char* kOthers = "the logs do not have the same beams";
  const LoggedBeams found = other.beams_from(beams.number, beams.row.size());
  require_data(found.row.size() == beams.row.size(), kOthers);
  for (size_t i = 0; i < beams.row.size(); ++i) {
    const Vec3f off = found.beams.direction[i] - beams.beams.direction[i];
    require_data(off.norm() < kDirectionTolerance, kOthers);
  }
  return found.beams.range_m;
}

std::string range_image(const LoggedBeams& beams, const std::vector<float>& other) {
  const ImageLayout layout = image_layout(beams.beams);
  std::vector<uint32_t> beam(size_t(layout.width) * layout.height, kNoBeam);
  for (uint32_t i = 0; i < layout.pixel.size(); ++i) {
    uint32_t& first = beam[layout.pixel[i]];
    first = std::min(first, i);
  }
  std::string bytes;
  bytes.reserve(12 + 12 * beam.size());
  for (const uint32_t value : {layout.width, layout.height, other.empty() ? 0u : 1u}) {
    append(bytes, value);
  }
  const auto shown = [](float range) { return range == kMiss ? 0.0F : range; };
  for (const uint32_t i : beam) {
    const bool some = i != kNoBeam;
    append(bytes, some ? beams.row[i] : kNoBeam);
    append(bytes, some ? shown(beams.beams.range_m[i]) : 0.0F);
    append(bytes, some && !other.empty() ? shown(other[i]) : 0.0F);
  }
  return bytes;
}

}  // namespace underbrush::serve
