#include "underbrush/keyframes/keyframe_images.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/parallel.hpp"
#include "underbrush/keyframes/keyframe_choice.hpp"
#include "underbrush/keyframes/scan_pattern.hpp"

namespace underbrush::keyframes {
namespace {

using elements::Keyframe;
using elements::KeyframePixel;
using elements::Keyframes;

/// Drops the keyframes of scans that have no beam within the image.
void drop_empty(KeyframeImages& images) {
  std::vector<Keyframe>& frames = images.keyframes.frames;
  const auto is_empty = [](const Keyframe& f) { return f.pixels.empty(); };
  std::erase_if(images.frame_of_scan, [&](const auto& s) { return is_empty(frames[s.second]); });
  std::vector<uint32_t> number;
  uint32_t left = 0;
  for (const Keyframe& f : frames) number.push_back(is_empty(f) ? left : left++);
  for (auto& [scan, frame] : images.frame_of_scan) frame = number[frame];
  std::erase_if(frames, is_empty);
}

/// Makes the images of some scans.
class Painter {
 public:
  Painter(const ScanPattern& pattern, const KeyframeOptions& options, KeyframeImages& images)
      : pattern_(pattern), options_(options), images_(images), grid_(images.keyframes) {
    const std::vector<uint16_t>& channel = images.keyframes.channel;
    for (size_t row = 0; row < channel.size(); ++row) rows_[channel[row]] = row;
  }

  void paint(const BeamLog& chunk) {
    const Keyframes& k = images_.keyframes;
    std::vector<elements::KeyframeGrid::Place> places(chunk.size());
    parallel_for(chunk.size(), 4096, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) places[i] = place_of(chunk, i);
    });
    for (size_t i = 0; i < chunk.size(); ++i) {
      const elements::KeyframeGrid::Place& place = places[i];
      if (!(place.row >= 0)) continue;
      const auto at = images_.frame_of_scan.find(chunk.scan[i]);
      const Scan& scan = pattern_.scans.at(chunk.scan[i]);
      const size_t r = std::min(size_t(place.row), k.rows() - 1);
      const size_t c = std::min(size_t(place.column), k.columns - 1);
      const double off =
          std::abs(place.column - double(c) - 0.5) + std::abs(place.row - double(r) - 0.5);
      set(at->second, r, c, off, chunk, i, scan);
    }
  }

  /// Gives pixels and columns that no beam of the log reached what their neighbours have.
  void close_gaps() {
    for (const auto& [scan, number] : images_.frame_of_scan) {
      Keyframe& frame = images_.keyframes.frames[number];
      spread_origins(frame);
      const std::vector<KeyframePixel> found = frame.pixels;
      const size_t n = images_.keyframes.columns;
      for (size_t p = 0; p < found.size(); ++p) {
        if (!found[p].is_unknown()) continue;
        const size_t row = p / n * n, column = p % n;
        const KeyframePixel& left = found[row + (column + n - 1) % n];
        frame.pixels[p] = left.is_unknown() ? found[row + (column + 1) % n] : left;
      }
    }
  }

 private:
  /// The place of a beam in the image of its scan; its row is −1 if it is in none.
  elements::KeyframeGrid::Place place_of(const BeamLog& chunk, size_t i) const {
    if (!images_.frame_of_scan.contains(chunk.scan[i])) return {-1, 0};
    const Scan& scan = pattern_.scans.at(chunk.scan[i]);
    auto place = grid_.place(scan.sensor_from_world * chunk.direction[i].cast<double>());
    const auto row = rows_.find(chunk.ring[i]);
    // Lasers that are apart see near things from beside the sensor's middle, rows off their own.
    if (row != rows_.end() && std::abs(place.row - double(row->second) - 0.5) < 0.75) {
      place.row = double(row->second) + 0.5;
    }
    return place;
  }

  void set(uint32_t number, size_t row, size_t column, double off, const BeamLog& chunk, size_t i,
           const Scan& scan) {
    Keyframes& k = images_.keyframes;
    Keyframe& f = k.frames[number];
    if (f.pixels.empty()) {
      f.pixels.resize(k.pixels());
      f.column_origin.assign(k.columns, Vec3f::Constant(NAN));
    }
    f.column_origin[column] = (chunk.origin[i] - scan.origin).cast<float>();
    if (off_.size() <= number) off_.resize(number + 1);
    if (off_[number].empty()) off_[number].assign(k.pixels(), 1.0f);
    const size_t p = row * k.columns + column;
    if (double(off_[number][p]) <= off) return;
    KeyframePixel pixel;
    if (!chunk.is_hit(i)) {
      pixel.x = KeyframePixel::kNoReturn;
    } else if (double(chunk.range_m[i]) >= options_.min_range_m) {
      const Vec3 steps = (chunk.end_point(i) - scan.origin) / k.unit_m;
      if (steps.cwiseAbs().maxCoeff() > KeyframePixel::kMost) return;
      pixel.x = int16_t(std::lround(steps.x()));
      pixel.y = int16_t(std::lround(steps.y()));
      pixel.z = int16_t(std::lround(steps.z()));
      if (k.intensity_unit > 0 && std::isfinite(chunk.intensity[i])) {
        const double steps_of_light = double(chunk.intensity[i]) / k.intensity_unit;
        pixel.intensity = uint16_t(std::lround(std::clamp(steps_of_light, 0.0, 65535.0)));
      }
    }
    off_[number][p] = float(off);
    f.pixels[p] = pixel;
  }

  static void spread_origins(Keyframe& f) {
    const size_t n = f.column_origin.size();
    const auto is_set = [&](size_t c) { return f.column_origin[c % n].allFinite(); };
    const std::vector<Vec3f> found = f.column_origin;
    for (size_t c = 0; c < n; ++c) {
      if (found[c].allFinite()) continue;
      for (size_t d = 1; d < n; ++d) {
        if (!found[(c + d) % n].allFinite() && !found[(c + n - d) % n].allFinite()) continue;
        const size_t from = found[(c + d) % n].allFinite() ? c + d : c + n - d;
        f.column_origin[c] = found[from % n];
        break;
      }
      if (!is_set(c)) f.column_origin[c] = Vec3f::Zero();
    }
  }

  const ScanPattern& pattern_;
  std::map<uint16_t, size_t> rows_;
  const KeyframeOptions& options_;
  KeyframeImages& images_;
  elements::KeyframeGrid grid_;
  std::vector<std::vector<float>> off_;  // distance of each pixel's beam from its middle, columns
};

/// Chooses keyframes among the scans of a log and those that there are already, and makes the
/// images of the scans. The grid is known.
void paint(BeamSource& log, const ScanPattern& pattern, const Vec3& origin,
           const KeyframeOptions& options, KeyframeImages& out) {
  Keyframes& k = out.keyframes;
  std::vector<Vec3> places;
  std::vector<uint32_t> scans;
  for (const Keyframe& f : k.frames) places.push_back(f.origin);
  for (const auto& [number, scan] : pattern.scans) {
    places.push_back(scan.origin - origin);
    scans.push_back(number);
  }
  const size_t bytes = k.pixels() * sizeof(KeyframePixel) + k.columns * sizeof(Vec3f);
  const size_t earlier = k.frames.size();
  std::vector<Keyframe> frames;
  for (const size_t place : chosen_keyframes(places, options, bytes)) {
    if (place < earlier) {
      frames.push_back(std::move(k.frames[place]));
      continue;
    }
    const uint32_t scan = scans[place - earlier];
    out.frame_of_scan[scan] = uint32_t(frames.size());
    Keyframe& f = frames.emplace_back();
    f.origin = places[place];
    f.sensor_from_world = pattern.scans.at(scan).sensor_from_world;
  }
  k.frames = std::move(frames);
  Painter painter(pattern, options, out);
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) painter.paint(chunk);
  drop_empty(out);
  painter.close_gaps();
}

double unit_of(const ScanPattern& p) {
  return std::max(p.largest_range_m, 1.0) * 1.05 / KeyframePixel::kMost;
}

double intensity_unit_of(const ScanPattern& p) { return p.largest_intensity / 65535; }

/// Makes units coarser where keyframes are to hold farther and brighter returns.
void widen(Keyframes& k, double unit_m, double intensity_unit) {
  const double length = std::min(k.unit_m / unit_m, 1.0);
  const double light = intensity_unit > k.intensity_unit ? k.intensity_unit / intensity_unit : 1;
  if (length == 1 && light == 1) return;
  for (Keyframe& f : k.frames) {
    for (KeyframePixel& p : f.pixels) {
      if (!p.is_hit()) continue;
      p.x = int16_t(std::lround(length * p.x));
      p.y = int16_t(std::lround(length * p.y));
      p.z = int16_t(std::lround(length * p.z));
      p.intensity = uint16_t(std::lround(light * p.intensity));
    }
  }
  k.unit_m /= length;
  k.intensity_unit /= light;
}

}  // namespace

KeyframeImages make_keyframe_images(BeamSource& log, const Vec3& origin,
                                    const KeyframeOptions& options) {
  const ScanPattern pattern = scan_pattern(log);
  KeyframeImages out;
  if (pattern.scans.empty()) return out;
  Keyframes& k = out.keyframes;
  set_grid(pattern, k);
  k.unit_m = unit_of(pattern);
  k.intensity_unit = intensity_unit_of(pattern);
  paint(log, pattern, origin, options, out);
  return out;
}

KeyframeImages add_keyframe_images(BeamSource& log, Keyframes earlier, const Vec3& origin,
                                   const KeyframeOptions& options) {
  KeyframeImages out{std::move(earlier), {}};
  const ScanPattern pattern = scan_pattern(log);
  // Where the earlier logs have no intensities, the pixels of none are to have any.
  const bool has_light = out.keyframes.intensity_unit > 0;
  widen(out.keyframes, unit_of(pattern), has_light ? intensity_unit_of(pattern) : 0);
  paint(log, pattern, origin, options, out);
  return out;
}

KeyframeImages make_half_images(BeamSource& log, const Keyframes& keyframes, const Vec3& origin,
                                const KeyframeOptions& options) {
  KeyframeImages out;
  Keyframes& k = out.keyframes;
  k.elevation = keyframes.elevation;
  k.channel = keyframes.channel;
  k.columns = std::max<size_t>(1, keyframes.columns / 2);
  k.unit_m = keyframes.unit_m;
  k.intensity_unit = keyframes.intensity_unit;
  const ScanPattern pattern = scan_pattern(log);
  if (!pattern.scans.empty()) paint(log, pattern, origin, options, out);
  return out;
}

}  // namespace underbrush::keyframes
