#include "report/report.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "report/pictures.hpp"
#include "report_page.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

constexpr size_t kPointsOfView = 40000;  // a cloud, in the interactive view
constexpr double kViewM = 40;            // half side of the box that it shows
constexpr int kPixels = 900;

std::string base64(const uint8_t* data, size_t n) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((n + 2) / 3 * 4);
  for (size_t i = 0; i < n; i += 3) {
    const uint32_t a = data[i], b = i + 1 < n ? data[i + 1] : 0, c = i + 2 < n ? data[i + 2] : 0;
    const uint32_t word = a << 16 | b << 8 | c;
    out += kDigits[word >> 18];
    out += kDigits[word >> 12 & 63];
    out += i + 1 < n ? kDigits[word >> 6 & 63] : '=';
    out += i + 2 < n ? kDigits[word & 63] : '=';
  }
  return out;
}

std::string data_uri(const io::Image& image) {
  const std::vector<uint8_t> png = io::png_from_image(image);
  return "data:image/png;base64," + base64(png.data(), png.size());
}

/// What the pictures show of the log: where, how high, and which scan in particular.
struct Frame {
  Eigen::Vector2d lo, hi;    // the drive with a margin
  double low = 0, high = 1;  // heights that most points have
  uint32_t scan = 0;         // in the middle of the log
  Pose world_from_sensor;
  int columns = 360, rings = 1;
  bool top_ring_is_zero = false;
  size_t hits_in_view = 0;  // points in the interactive view's box
};

Frame frame_of(const fs::path& real) {
  io::LogReader log(real);
  Frame f;
  Eigen::AlignedBox2d track;
  std::vector<float> heights;
  struct Scan {
    uint32_t number;
    Vec3 origin;  // of its first beam
    size_t beams;
  };
  std::vector<Scan> scans;
  std::vector<double> slope_sum(1 << 16);
  size_t seen = 0;
  BeamLog chunk;
  while (log.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i, ++seen) {
      track.extend(chunk.origin[i].head<2>());
      f.rings = std::max(f.rings, chunk.ring[i] + 1);
      slope_sum[chunk.ring[i]] += chunk.direction[i].z();
      if (scans.empty() || scans.back().number != chunk.scan[i]) {
        scans.push_back({chunk.scan[i], chunk.origin[i], 0});
      }
      ++scans.back().beams;
      if (seen % 97 == 0 && chunk.is_hit(i)) heights.push_back(float(chunk.end_point(i).z()));
    }
  }
  if (scans.empty()) return f;
  f.lo = track.min().array() - 35;
  f.hi = track.max().array() + 35;
  if (!heights.empty()) {
    std::sort(heights.begin(), heights.end());
    f.low = heights[heights.size() / 100];
    f.high = heights[heights.size() * 98 / 100];
  }
  const Scan& middle = scans[scans.size() / 2];
  f.scan = middle.number;
  f.world_from_sensor.translation = middle.origin;
  // As many columns as firings, so that no cell stays empty for want of beams.
  f.columns = std::clamp(int(middle.beams) / f.rings, 180, 1440);
  for (const ScanInfo& s : log.info().scans) {
    if (s.scan == f.scan) f.world_from_sensor = s.world_from_sensor;
  }
  f.top_ring_is_zero = slope_sum[0] > slope_sum[size_t(f.rings) - 1];
  return f;
}

bool in_view(const Frame& f, const Vec3& p) {
  return (p - f.world_from_sensor.translation).cwiseAbs().maxCoeff() < kViewM;
}

/// Points for the interactive view: 16-bit coordinates in the box, and the error's colour.
class ViewPoints {
 public:
  explicit ViewPoints(const Frame& frame) : frame_(frame) {}
  void add(size_t beam, const Vec3& p, Colour colour) {
    if (!in_view(frame_, p)) return;
    // The hash picks the same beams of all logs, evenly.
    if (size_t(mix64(beam) % 1000000) * frame_.hits_in_view > kPointsOfView * size_t(1000000))
      return;
    const Vec3 at = p - frame_.world_from_sensor.translation;
    for (int d = 0; d < 3; ++d) {
      const auto v = uint16_t((at[d] + kViewM) / (2 * kViewM) * 65535);
      bytes_.push_back(uint8_t(v & 255));
      bytes_.push_back(uint8_t(v >> 8));
    }
    bytes_.insert(bytes_.end(), colour.begin(), colour.end());
    bytes_.push_back(0);
  }
  std::string text() const { return base64(bytes_.data(), bytes_.size()); }

 private:
  const Frame& frame_;
  std::vector<uint8_t> bytes_;
};

Json pictures_of_real(const fs::path& real, Frame& f) {
  io::LogReader log(real);
  BirdsEye above(f.lo, f.hi, kPixels);
  RangeImage ranges(f.world_from_sensor, f.columns, f.rings, f.top_ring_is_zero);
  BeamLog chunk;
  while (log.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i)) continue;
      const Vec3 p = chunk.end_point(i);
      above.draw_height(p, f.low, f.high);
      f.hits_in_view += in_view(f, p);
      if (chunk.scan[i] == f.scan)
        ranges.draw(chunk, i, colour_of_level(std::log2(1 + chunk.range_m[i]) / 6.5));
    }
  }
  ViewPoints view(f);
  size_t beam = 0;
  log.rewind();
  while (log.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i, ++beam) {
      if (chunk.is_hit(i)) {
        const Vec3 p = chunk.end_point(i);
        view.add(beam, p, colour_of_level((p.z() - f.low) / std::max(1e-6, f.high - f.low)));
      }
    }
  }
  return {{"name", "real"},
          {"above", data_uri(above.image())},
          {"range", data_uri(ranges.image())},
          {"points", view.text()},
          {"metres_per_pixel", above.metres_per_pixel()}};
}

Json pictures_of_simulated(const fs::path& real, const ReportInput::Simulated& simulated,
                           const Frame& f) {
  io::LogReader real_log(real), sim_log(simulated.log);
  BirdsEye above(f.lo, f.hi, kPixels), errors(f.lo, f.hi, kPixels);
  RangeImage ranges(f.world_from_sensor, f.columns, f.rings, f.top_ring_is_zero),
      range_errors = ranges;
  ViewPoints view(f), error_view(f);
  BeamLog a, b;
  size_t beam = 0;
  while (real_log.next(a) && sim_log.next(b)) {
    require(a.size() == b.size(), "report: the logs differ in length");
    for (size_t i = 0; i < a.size(); ++i, ++beam) {
      const bool hit = a.is_hit(i), sim_hit = b.is_hit(i);
      if (!hit && !sim_hit) continue;
      const Vec3 p = sim_hit ? b.end_point(i) : a.end_point(i);
      const Colour error = !hit       ? kFalseHit
                           : !sim_hit ? kFalseMiss
                                      : colour_of_error(double(b.range_m[i]) - a.range_m[i]);
      errors.draw(p, error);
      error_view.add(beam, p, error);
      const bool shown = a.scan[i] == f.scan;
      if (shown) range_errors.draw(a, i, error);
      if (!sim_hit) continue;
      above.draw_height(p, f.low, f.high);
      view.add(beam, p, colour_of_level((p.z() - f.low) / std::max(1e-6, f.high - f.low)));
      if (shown) ranges.draw(b, i, colour_of_level(std::log2(1 + b.range_m[i]) / 6.5));
    }
  }
  return {{"name", simulated.name},
          {"above", data_uri(above.image())},
          {"error", data_uri(errors.image())},
          {"range", data_uri(ranges.image())},
          {"range_error", data_uri(range_errors.image())},
          {"points", view.text()},
          {"error_points", error_view.text()}};
}

void replace(std::string& text, const std::string& mark, const std::string& with) {
  const size_t at = text.find(mark);
  require(at != std::string::npos, "report: the page lacks a mark");
  text.replace(at, mark.size(), with);
}

}  // namespace

fs::path write_report(const fs::path& folder, const ReportInput& input) {
  Frame frame = frame_of(input.real);
  Json data;
  data["title"] = input.title;
  data["note"] = input.note;
  data["scores"] = input.scores;
  data["scan"] = frame.scan;
  data["view_m"] = kViewM;
  data["error_span_m"] = kErrorSpan;
  data["pictures"] = Json::array({pictures_of_real(input.real, frame)});
  for (const auto& s : input.simulated) {
    data["pictures"].push_back(pictures_of_simulated(input.real, s, frame));
  }
  std::string json = data.dump();
  for (size_t at = 0; (at = json.find("</", at)) != std::string::npos;) json.replace(at, 2, "<\\/");
  std::string page(kReportPage);
  replace(page, "@STYLE@", kReportStyle);
  replace(page, "@SCRIPT@", kReportScript);
  replace(page, "@DATA@", json);

  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw IoError(folder.string() + ": cannot create: " + error.message());
  fs::path file = folder / "index.html";
  io::write_atomically(file, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << page;
    if (!out.flush()) throw IoError(file.string() + ": cannot write");
  });
  return file;
}

}  // namespace underbrush::app
