#include "underbrush/keyframes/scan_pattern.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/median.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::keyframes {
namespace {

using elements::Keyframes;

constexpr size_t kPatternBeams = 500'000;

double elevation_of(const Vec3& d) { return std::asin(std::clamp(d.z(), -1.0, 1.0)); }

/// Beams of the usual scan.
double beams_of_scan(const ScanPattern& p) {
  std::vector<size_t> counts;
  for (const auto& [number, scan] : p.scans) counts.push_back(scan.beams);
  std::nth_element(counts.begin(), counts.begin() + ptrdiff_t(counts.size() / 2), counts.end());
  return double(counts[counts.size() / 2]);
}

/// A row for each channel.
void set_channels(const ScanPattern& p, Keyframes& image) {
  std::vector<std::pair<double, uint16_t>> order;
  for (const auto& [ring, c] : p.channels) order.emplace_back(c.quantile(0.5), ring);
  std::sort(order.begin(), order.end());
  for (const auto& [elevation, ring] : order) {
    image.elevation.push_back(elevation);
    image.channel.push_back(ring);
  }
}

/// Rows and columns as wide as the spacing of the beams.
void set_even_image(const ScanPattern& p, double turn_share, Keyframes& k) {
  double low = M_PI / 2, high = -M_PI / 2;
  for (const auto& [ring, c] : p.channels) {
    low = std::min(low, c.quantile(0.01));
    high = std::max(high, c.quantile(0.99));
  }
  low = std::max(low, -M_PI / 2);
  high = std::min(high, M_PI / 2);
  const double area = std::max(high - low, 1e-3) * 2 * M_PI * turn_share;
  const double step = std::max(std::sqrt(area / beams_of_scan(p)), 1e-3);
  const auto rows = size_t(std::max(2.0, std::ceil((high - low) / step)));
  for (size_t r = 0; r < rows; ++r) {
    k.elevation.push_back(low + (high - low) * (double(r) + 0.5) / double(rows));
  }
  k.columns = size_t(std::max(1.0, std::round(2 * M_PI / step)));
}

/// The median distance of an image's rows from the next, rad.
double row_height(const std::vector<double>& elevation) {
  constexpr double kLeast = 0.1 * M_PI / 180;
  std::vector<double> steps;
  for (size_t r = 1; r < elevation.size(); ++r) steps.push_back(elevation[r] - elevation[r - 1]);
  return std::max(median(std::move(steps)), kLeast);
}

bool has_channels_of(const Keyframes& image, const Keyframes& other) {
  std::map<uint16_t, double> elevation;
  for (size_t r = 0; r < other.rows(); ++r) elevation[other.channel[r]] = other.elevation[r];
  std::vector<double> off;
  for (size_t r = 0; r < image.rows(); ++r) {
    const auto same = elevation.find(image.channel[r]);
    if (same != elevation.end()) off.push_back(std::abs(same->second - image.elevation[r]));
  }
  return !off.empty() && median(std::move(off)) <= row_height(image.elevation) / 2;
}

/// Whether the field of view of `image` holds that of `other`. A part of a log has a smaller one.
bool has_field_of(const Keyframes& image, const Keyframes& other) {
  const double most = (image.elevation.back() - image.elevation.front()) / 4;
  return other.elevation.front() >= image.elevation.front() - most &&
         other.elevation.back() <= image.elevation.back() + most;
}

}  // namespace

void ChannelElevations::add(double elevation_rad) {
  const double at = (elevation_rad / M_PI + 0.5) * kSteps;
  ++count_[size_t(std::clamp(at, 0.0, kSteps - 1.0))];
  ++beams_;
}

double ChannelElevations::quantile(double share) const {
  double below = share * double(beams_);
  for (size_t k = 0; k < count_.size(); ++k) {
    if (below <= double(count_[k])) {
      const double part = count_[k] > 0 ? below / double(count_[k]) : 0;
      return ((double(k) + part) / kSteps - 0.5) * M_PI;
    }
    below -= double(count_[k]);
  }
  return M_PI / 2;
}

ScanPattern scan_pattern(BeamSource& log, bool with_azimuths) {
  ScanPattern p;
  std::vector<ChannelElevations*> channels;  // by ring
  for (const ScanInfo& info : log.info().scans) {
    p.scans[info.scan].sensor_from_world = info.world_from_sensor.rotation.conjugate();
  }
  log.rewind();
  const uint64_t one_in = 1 + log.size() / kPatternBeams;
  uint64_t row = 0;
  Scan* of_scan = nullptr;
  uint32_t scan_number = 0;
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!of_scan || chunk.scan[i] != scan_number) {
        scan_number = chunk.scan[i];
        of_scan = &p.scans[scan_number];
      }
      Scan& scan = *of_scan;
      ++scan.beams;
      scan.origin += chunk.origin[i];
      if (chunk.is_hit(i)) {
        p.largest_range_m = std::max(p.largest_range_m, double(chunk.range_m[i]));
        if (std::isfinite(chunk.intensity[i])) {
          p.largest_intensity = std::max(p.largest_intensity, double(chunk.intensity[i]));
        }
      }
      if (mix64(++row) % one_in != 0) continue;
      const Vec3 d = scan.sensor_from_world * chunk.direction[i].cast<double>();
      const uint16_t ring = chunk.ring[i];
      if (ring >= channels.size()) channels.resize(ring + size_t(1));
      if (!channels[ring]) channels[ring] = &p.channels[ring];
      channels[ring]->add(elevation_of(d));
      if (!with_azimuths) continue;
      const double turn = std::atan2(d.y(), d.x()) / (2 * M_PI);
      p.degrees.set(size_t((turn < 0 ? turn + 1 : turn) * 360) % 360);
    }
  }
  std::erase_if(p.scans, [](const auto& s) { return s.second.beams == 0; });
  for (auto& [number, scan] : p.scans) scan.origin /= double(scan.beams);
  return p;
}

void set_grid(const ScanPattern& pattern, Keyframes& image) {
  const double turn_share = std::max(1.0, double(pattern.degrees.count())) / 360;
  if (pattern.channels.size() < 2) {
    set_even_image(pattern, turn_share, image);
  } else {
    set_channels(pattern, image);
    const double of_channel = beams_of_scan(pattern) / double(image.rows());
    image.columns = size_t(std::max(1.0, std::round(of_channel / turn_share)));
  }
}

bool is_of_sensor(const elements::Model& model, const LogInfo& log, const ScanPattern& pattern) {
  if (pattern.scans.empty()) return true;
  const double reach_m = std::max(log.max_range_m, pattern.largest_range_m);
  if (std::isfinite(model.max_range_m) && reach_m < model.max_range_m) return false;
  Keyframes other;
  set_grid(pattern, other);
  const Keyframes& image = *model.keyframes;
  if (image.channel.empty() != other.channel.empty()) return false;
  return image.channel.empty() ? has_field_of(image, other) : has_channels_of(image, other);
}

}  // namespace underbrush::keyframes
