#include "report/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::report {
namespace {

// Anchors of viridis, which keeps its order for colour-blind readers and in grey. Its dark end is
// lighter here, to stand out from the background.
constexpr Rgb kScale[] = {{74, 60, 150},  {62, 89, 160},  {49, 117, 160}, {38, 144, 155},
                          {36, 170, 140}, {83, 194, 107}, {158, 213, 62}, {253, 231, 37}};
constexpr Rgb kErrors[] = {
    {37, 99, 255}, {92, 152, 246}, {128, 134, 144}, {244, 130, 112}, {239, 44, 44}};

template <size_t N>
Rgb between(const Rgb (&anchors)[N], double fraction) {
  const double at = std::clamp(fraction, 0.0, 1.0) * double(N - 1);
  const size_t k = std::min(size_t(at), N - 2);
  Rgb out;
  for (int c = 0; c < 3; ++c) {
    out[c] = uint8_t(
        std::lround(anchors[k][c] + (at - double(k)) * (anchors[k + 1][c] - anchors[k][c])));
  }
  return out;
}

void put(io::Image& image, int x, int y, const Rgb& colour) {
  std::copy(colour.begin(), colour.end(),
            image.rgb.begin() + std::ptrdiff_t(3) * (std::ptrdiff_t(y) * image.width + x));
}

// Rows are several pixels high, so that a picture of few rings is not a thin line.
int row_height(const ScanLayout& layout) { return std::clamp(160 / layout.rows, 2, 8); }

template <class Colour>
io::Image picture_of(const ScanLayout& layout, const Colour& colour) {
  const int tall = row_height(layout);
  io::Image image(layout.columns, layout.rows * tall);
  for (int row = 0; row < layout.rows; ++row) {
    for (int column = 0; column < layout.columns; ++column) {
      const int beam = layout.beam[size_t(row) * layout.columns + column];
      const Rgb c = beam < 0 ? kBackground : colour(beam);
      for (int t = 0; t < tall; ++t) put(image, column, row * tall + t, c);
    }
  }
  return image;
}

double elevation_of(const ScanBeam& b) {
  return std::atan2(b.direction.z(), std::hypot(b.direction.x(), b.direction.y()));
}

}  // namespace

Rgb scale_colour(double fraction) {
  constexpr double kSteps = 47;
  return between(kScale, std::floor(std::clamp(fraction, 0.0, 1.0) * kSteps + 0.5) / kSteps);
}

Rgb error_colour(double error_m) {
  constexpr double kSteps = 16;  // Steps on each side.
  return between(kErrors, 0.5 + 0.5 * std::round(error_m / kErrorScale * kSteps) / kSteps);
}

TopPicture::TopPicture(const TopView& view)
    : view_(view),
      height_m_(size_t(view.width) * view.height, -INFINITY),
      colour_(height_m_.size(), kBackground) {}

void TopPicture::add(const Vec3& point, Rgb colour) {
  const double x = (point.x() - view_.corner.x()) / view_.metres_per_pixel;
  const double y = (view_.corner.y() - point.y()) / view_.metres_per_pixel;
  if (!(x >= 0 && x < view_.width && y >= 0 && y < view_.height)) return;
  const size_t at = size_t(y) * size_t(view_.width) + size_t(x);
  const float height = float(point.z() - view_.corner.z());
  if (height <= height_m_[at]) return;
  height_m_[at] = height;
  colour_[at] = colour;
}

TopPicture TopPicture::closed() const {
  TopPicture out = *this;
  for (int y = 1; y + 1 < view_.height; ++y) {
    for (int x = 1; x + 1 < view_.width; ++x) {
      const size_t at = size_t(y) * size_t(view_.width) + size_t(x);
      if (height_m_[at] > -INFINITY) continue;
      size_t highest = at;
      int seen = 0;
      for (int k = 0; k < 9; ++k) {
        const size_t n = at + size_t(std::ptrdiff_t(k / 3 - 1) * view_.width + k % 3 - 1);
        if (height_m_[n] == -INFINITY) continue;
        ++seen;
        if (height_m_[n] > height_m_[highest]) highest = n;
      }
      if (seen < 2) continue;
      out.height_m_[at] = height_m_[highest];
      out.colour_[at] = colour_[highest];
    }
  }
  return out;
}

io::Image TopPicture::image() const {
  io::Image image(view_.width, view_.height);
  for (int y = 0; y < view_.height; ++y) {
    for (int x = 0; x < view_.width; ++x) {
      const size_t at = size_t(y) * size_t(view_.width) + size_t(x);
      float above = 0;  // Sum of the neighbours' heights above this pixel, each up to 1 m.
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (x + dx < 0 || x + dx >= view_.width || y + dy < 0 || y + dy >= view_.height) continue;
        const size_t n = at + size_t(std::ptrdiff_t(dy) * view_.width + dx);
        above += std::clamp(height_m_[n] - height_m_[at], 0.f, 1.f);
      }
      Rgb c = colour_[at];
      if (height_m_[at] > -INFINITY) {
        const int shade = std::min(3, int(above * 1.5f));  // Few steps keep the file small.
        for (uint8_t& channel : c) channel = uint8_t(channel * (8 - shade) / 8);
      }
      put(image, x, y, c);
    }
  }
  return image;
}

ScanLayout layout_of(const std::vector<ScanBeam>& scan) {
  constexpr int kColumns = 1024, kElevationRows = 64;
  ScanLayout layout;
  std::map<uint16_t, std::pair<double, size_t>> rings;  // Sum of elevations, and number of beams.
  double left = -M_PI, right = M_PI, low = M_PI, high = -M_PI;
  for (const ScanBeam& b : scan) {
    auto& [sum, n] = rings[b.ring];
    sum += elevation_of(b), ++n;
    const double azimuth = std::atan2(b.direction.y(), b.direction.x());
    left = std::max(left, azimuth), right = std::min(right, azimuth);
    low = std::min(low, elevation_of(b)), high = std::max(high, elevation_of(b));
  }
  if (scan.empty()) return layout;
  layout.by_ring = rings.size() >= 4 && rings.size() <= 512;
  std::vector<std::pair<double, uint16_t>> order;
  order.reserve(rings.size());
  for (const auto& [ring, r] : rings) order.emplace_back(-r.first / double(r.second), ring);
  std::sort(order.begin(), order.end());
  std::map<uint16_t, int> row_of;
  for (const auto& [elevation, ring] : order) row_of.emplace(ring, int(row_of.size()));
  layout.columns = int(std::clamp(scan.size() / (layout.by_ring ? rings.size() : kElevationRows),
                                  size_t(64), size_t(kColumns)));
  layout.rows = layout.by_ring ? int(rings.size()) : kElevationRows;
  layout.beam.assign(size_t(layout.columns) * layout.rows, -1);
  const auto cell = [](double f, int n) { return std::clamp(int(f * n), 0, n - 1); };
  for (size_t i = 0; i < scan.size(); ++i) {
    const double azimuth = std::atan2(scan[i].direction.y(), scan[i].direction.x());
    const int column = cell((left - azimuth) / std::max(left - right, 1e-9), layout.columns);
    const int row =
        layout.by_ring
            ? row_of[scan[i].ring]
            : cell((high - elevation_of(scan[i])) / std::max(high - low, 1e-9), layout.rows);
    int& shown = layout.beam[size_t(row) * layout.columns + column];
    if (shown < 0) shown = int(i);
  }
  return layout;
}

io::Image range_image(const std::vector<ScanBeam>& scan, const ScanLayout& layout, int k,
                      double far_m) {
  return picture_of(layout, [&](int i) {
    const float range = k < 0 ? scan[i].real_m : scan[i].ranges_m[k];
    return range == kMiss ? kMissColour : scale_colour(std::sqrt(double(range) / far_m));
  });
}

io::Image error_image(const std::vector<ScanBeam>& scan, const ScanLayout& layout, int k) {
  return picture_of(layout, [&](int i) {
    const float real = scan[i].real_m, simulated = scan[i].ranges_m[k];
    if (real == kMiss) return simulated == kMiss ? kMissColour : kFalseHit;
    return simulated == kMiss ? kFalseMiss : error_colour(double(simulated) - double(real));
  });
}

std::string data_url(const io::Image& image) {
  const std::vector<uint8_t> png = io::png_from_image(image);
  return "data:image/png;base64," + base64(png.data(), png.size());
}

std::string base64(const void* bytes, size_t n) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* p = static_cast<const uint8_t*>(bytes);
  std::string out;
  out.reserve((n + 2) / 3 * 4);
  for (size_t i = 0; i < n; i += 3) {
    const uint32_t word = uint32_t(p[i]) << 16 | (i + 1 < n ? uint32_t(p[i + 1]) << 8 : 0) |
                          (i + 2 < n ? uint32_t(p[i + 2]) : 0);
    for (size_t k = 0; k < 4; ++k) {
      out += i + k <= n ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
  }
  return out;
}

}  // namespace underbrush::report
