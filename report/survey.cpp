#include "report/survey.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::report {
namespace {

constexpr size_t kChunk = 1 << 17, kSampled = 200000;
// Points of one cloud, and of all clouds.
constexpr size_t kViewPoints = 50000, kAllViewPoints = 200000;
constexpr size_t kMostScanBeams = 1 << 20;
constexpr double kLargestBox = 60;  // m

// Selects the same beams in every log, by a hash of their number.
bool chosen(size_t beam, double rate) {
  return uniform_from_bits(mix64(beam + 0x9e3779b97f4a7c15ull)) < rate;
}

double quantile(std::vector<double> v, double q) {
  if (v.empty()) return 0;
  const auto at = v.begin() + std::ptrdiff_t(q * double(v.size() - 1));
  std::nth_element(v.begin(), at, v.end());
  return *at;
}

// Reads a log beam by beam; its chunks need not begin where another log's do.
class Cursor {
 public:
  explicit Cursor(const std::filesystem::path& path) : reader_(path, kChunk) {}
  bool step() {
    if (++at_ < chunk_.size()) return true;
    at_ = 0;
    return reader_.next(chunk_);
  }
  const io::BeamReader& reader() const { return reader_; }
  const BeamLog& log() const { return chunk_; }
  size_t index() const { return at_; }
  bool is_hit() const { return chunk_.is_hit(at_); }
  float range_m() const { return chunk_.range_m[at_]; }
  Vec3 point() const { return chunk_.end_point(at_); }

 private:
  io::BeamReader reader_;
  BeamLog chunk_;
  size_t at_ = 0;
};

// Thins the dense points near the sensor, so that a sample covers the ground evenly up to a third
// of the box. A miss keeps its full weight.
double weight(float range_m, double box_m) {
  const double full_m = box_m / 3;
  return std::clamp(range_m * range_m / (full_m * full_m), 0.05, 1.0);
}

// The extent of the scene, from a sample of the real log's hits.
struct Extent {
  std::vector<double> axis[3], range;
  Vec3 focus = Vec3::Zero();  // the sensor in the middle of the log
  Pose sensor_from_world;     // there
  double rate = 1;            // of the sample

  double quantile_of(int k, double q) const {
    return axis[k].empty() ? focus[k] : quantile(axis[k], q);
  }
};

Extent extent_of(const std::filesystem::path& path, Survey& s) {
  Extent e;
  Cursor real(path);
  const size_t expected = real.reader().size(), middle = expected / 2;
  e.rate = std::min(1.0, double(kSampled) / double(std::max<size_t>(expected, 1)));
  for (; real.step(); ++s.beams) {
    if (s.beams <= middle) {
      e.focus = real.log().origin[real.index()];
      s.scan = real.log().scan[real.index()];
    }
    if (!real.is_hit()) continue;
    ++s.hits;
    if (!chosen(s.beams, e.rate)) continue;
    const Vec3 p = real.point();
    for (int k = 0; k < 3; ++k) e.axis[k].push_back(p[k]);
    e.range.push_back(real.range_m());
  }
  e.sensor_from_world.translation = -e.focus;
  for (const ScanInfo& scan : real.reader().info().scans) {
    if (scan.scan != s.scan) continue;
    e.sensor_from_world = scan.world_from_sensor.inverse();
    s.scan_in_sensor_frame = true;
  }
  return e;
}

// Chooses the view, which holds all but the outermost hits. Its size keeps a page with many
// pictures small.
void choose_view(const Extent& e, size_t pictures, Survey& s) {
  double low[2], high[2];
  for (int k = 0; k < 2; ++k) {
    low[k] = e.quantile_of(k, 0.01);
    high[k] = e.quantile_of(k, 0.99);
  }
  const double wide = std::max({high[0] - low[0], high[1] - low[1], 1.0});
  double size[2];
  for (int k = 0; k < 2; ++k) size[k] = std::max(1.04 * (high[k] - low[k]), 0.5 * wide);
  const double pixels = std::min(720.0, std::sqrt(3.4e6 / double(pictures)));
  s.view.metres_per_pixel = std::max(size[0], size[1]) / pixels;
  s.view.width = std::max(1, int(size[0] / s.view.metres_per_pixel));
  s.view.height = std::max(1, int(size[1] / s.view.metres_per_pixel));
  s.view.corner = {(low[0] + high[0] - size[0]) / 2, (low[1] + high[1] + size[1]) / 2, e.focus.z()};
  s.low_m = e.axis[2].empty() ? e.focus.z() : quantile(e.axis[2], 0.02);
  s.high_m = std::max(s.low_m + 0.5, e.axis[2].empty() ? 0 : quantile(e.axis[2], 0.98));
  s.far_m = std::max(1.0, quantile(e.range, 0.98));
}

// The box that the 3-D view shows.
struct Box {
  Vec3 low = Vec3::Zero();
  double side = kLargestBox, rate = 1;
  size_t most = kViewPoints;

  void add(const Vec3& point, uint8_t error, ViewPoints& out) const {
    if (out.error.size() >= most) return;
    const Vec3 f = (point - low) / side;
    if (!((f.array() >= 0).all() && (f.array() <= 1).all())) return;
    for (int k = 0; k < 3; ++k) out.xyz.push_back(uint16_t(f[k] * 65535 + 0.5));
    out.error.push_back(error);
  }
};

// A cube as large as a log of one place needs; of a larger log what is near the sensor in its
// middle.
Box choose_box(const Extent& e, size_t clouds, Survey& s) {
  Box box;
  Vec3 middle = e.focus, centre = e.focus;
  double side = 1.1 * (s.high_m - s.low_m);  // the floor takes 1/20 of it
  for (int k = 0; k < 2; ++k) {
    const double low = e.quantile_of(k, 0.01), high = e.quantile_of(k, 0.99);
    centre[k] = (low + high) / 2;
    side = std::max(side, 1.04 * (high - low));
  }
  s.box_holds_all = side < kLargestBox;
  if (s.box_holds_all) {
    middle = centre;
    box.side = std::max(side, 1.0);
  }
  s.box_m = box.side;
  const double half = box.side / 2;
  double inside = 0;
  for (size_t i = 0; i < e.range.size(); ++i) {
    const bool in =
        std::abs(e.axis[0][i] - middle.x()) < half && std::abs(e.axis[1][i] - middle.y()) < half;
    if (in) inside += weight(float(e.range[i]), box.side);
  }
  box.most = std::min(kViewPoints, kAllViewPoints / clouds);
  box.low = {middle.x() - half, middle.y() - half, s.low_m - s.floor_m()};
  box.rate = 0.97 * double(box.most) * e.rate / std::max(inside, 1.0);
  return box;
}

uint8_t error_code(double error_m) {
  return uint8_t(std::lround(100 + 100 * std::clamp(error_m / kErrorScale, -1.0, 1.0)));
}

}  // namespace

Survey survey(const Comparison& input) {
  Survey s;
  const Extent extent = extent_of(input.real, s);
  const size_t n = input.simulated.size();
  choose_view(extent, 2 * n + 1, s);
  const Box box = choose_box(extent, n + 1, s);
  const auto height_colour = [&](const Vec3& p) {
    return scale_colour(std::sqrt(std::max(0.0, (p.z() - s.low_m) / (s.high_m - s.low_m))));
  };
  std::vector<TopPicture> by_height(n + 1, TopPicture(s.view)), by_error(n, TopPicture(s.view));
  s.points.resize(n + 1);
  Cursor real(input.real);
  std::deque<Cursor> simulated;  // Cursors cannot be moved.
  for (const auto& m : input.simulated) simulated.emplace_back(m.log);

  for (size_t beam = 0; real.step(); ++beam) {
    const bool in_view = chosen(beam, box.rate * weight(real.range_m(), box.side));
    const bool in_scan =
        real.log().scan[real.index()] == s.scan && s.scan_beams.size() < kMostScanBeams;
    const Vec3 point = real.point();
    if (real.is_hit()) {
      by_height[0].add(point, height_colour(point));
      if (in_view) box.add(point, 100, s.points[0]);
    }
    if (in_scan) {
      const Vec3f direction =
          extent.sensor_from_world.rotation.cast<float>() * real.log().direction[real.index()];
      s.scan_beams.push_back({direction, real.log().ring[real.index()], real.range_m(), {}});
    }
    for (size_t k = 0; k < n; ++k) {
      Cursor& sim = simulated[k];
      require(sim.step(), "report: a simulated log ends early");
      if (in_scan) s.scan_beams.back().ranges_m.push_back(sim.range_m());
      if (!sim.is_hit()) {
        if (!real.is_hit()) continue;
        by_error[k].add(point, kFalseMiss);
        if (in_view) box.add(point, kFalseMissCode, s.points[k + 1]);
        continue;
      }
      const Vec3 p = sim.point();
      const double error_m = double(sim.range_m()) - double(real.range_m());
      by_height[k + 1].add(p, height_colour(p));
      by_error[k].add(p, real.is_hit() ? error_colour(error_m) : kFalseHit);
      if (in_view) {
        box.add(p, real.is_hit() ? error_code(error_m) : kFalseHitCode, s.points[k + 1]);
      }
    }
  }
  for (const TopPicture& p : by_height) s.by_height.push_back(p.closed().image());
  for (const TopPicture& p : by_error) s.by_error.push_back(p.closed().image());
  return s;
}

}  // namespace underbrush::report
