#include "underbrush/primitives/thumbnail.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace underbrush::primitives {
namespace {

/// A picture whose coordinates count from the lower middle, x right and z up (m). It is painted
/// from far to near.
class Canvas {
 public:
  Canvas(int pixels, double metres)
      : image_(pixels, pixels, 250), scale_(0.92 * pixels / metres), foot_(0.96 * pixels) {
    for (int x = 0; x < pixels; ++x) paint(x, int(foot_), {120, 100, 80}, 1);
  }
  double scale() const { return scale_; }
  double column(double x) const { return 0.5 * image_.width + scale_ * x; }
  double row(double z) const { return foot_ - scale_ * z; }

  void paint(int x, int y, const std::array<double, 3>& colour, double opacity) {
    if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
    uint8_t* to = &image_.rgb[3 * (size_t(y) * size_t(image_.width) + size_t(x))];
    for (size_t c = 0; c < 3; ++c) {
      to[c] = uint8_t(std::lround(to[c] + opacity * (colour[c] - to[c])));
    }
  }
  /// Calls f(x, y, offset from the middle in m) for the pixels within the reach.
  template <class F>
  void around(double x, double z, double reach_x, double reach_z, const F& f) {
    const int x0 = std::max(0, int(column(x - reach_x))), y0 = std::max(0, int(row(z + reach_z)));
    const int x1 = std::min(image_.width - 1, int(column(x + reach_x)) + 1);
    const int y1 = std::min(image_.height - 1, int(row(z - reach_z)) + 1);
    for (int y = y0; y <= y1; ++y) {
      for (int px = x0; px <= x1; ++px) {
        f(px, y, Eigen::Vector2d((px + 0.5 - column(x)) / scale_, (row(z) - y - 0.5) / scale_));
      }
    }
  }
  io::Image image() && { return std::move(image_); }

 private:
  io::Image image_;
  double scale_, foot_;
};

// Returns brown at the foot, green in the middle and pale green at the top; farther points are
// darker.
std::array<double, 3> colour_of(double height_m, double top_m, double depth) {
  const double f = std::clamp(height_m / std::max(top_m, 0.1), 0.0, 1.0);
  const std::array<double, 3> low{96, 72, 48}, middle{52, 120, 60}, high{168, 205, 96};
  std::array<double, 3> out{};
  for (size_t c = 0; c < 3; ++c) {
    const double value = f < 0.5 ? low[c] + 2 * f * (middle[c] - low[c])
                                 : middle[c] + (2 * f - 1) * (high[c] - middle[c]);
    out[c] = value * (0.65 + 0.35 * depth);
  }
  return out;
}

void draw(Canvas& canvas, const elements::Ellipsoid& e, const std::array<double, 3>& colour) {
  constexpr double kReach = 1.5;
  const Mat3 s = e.covariance_matrix();
  Eigen::Matrix2d flat;
  flat << s(0, 0), s(0, 2), s(2, 0), s(2, 2);
  const double pixel2 = 0.1 / (canvas.scale() * canvas.scale());
  flat(0, 0) += pixel2, flat(1, 1) += pixel2;
  const Eigen::Matrix2d inverse = flat.inverse();
  const double p = e.density_per_m > 0 ? 0.8 : std::clamp(double(e.hit.p), 0.1, 1.0);
  canvas.around(e.mean.x(), e.mean.z(), kReach * std::sqrt(flat(0, 0)),
                kReach * std::sqrt(flat(1, 1)), [&](int x, int y, const Eigen::Vector2d& d) {
                  if (d.dot(inverse * d) <= kReach * kReach) canvas.paint(x, y, colour, 0.8 * p);
                });
}

void draw(Canvas& canvas, const std::array<Vec3f, 3>& t, const std::array<double, 3>& colour) {
  const Vec3f middle = (t[0] + t[1] + t[2]) / 3;
  Vec3f reach = Vec3f::Zero();
  for (const Vec3f& v : t) reach = reach.cwiseMax((v - middle).cwiseAbs());
  const auto side = [&](const Eigen::Vector2d& p, size_t k) {
    const Vec3f a = t[k] - middle, b = t[(k + 1) % 3] - middle;
    return (b.x() - a.x()) * (p.y() - a.z()) - (b.z() - a.z()) * (p.x() - a.x());
  };
  canvas.around(middle.x(), middle.z(), reach.x(), reach.z(),
                [&](int x, int y, const Eigen::Vector2d& d) {
                  const double u = side(d, 0), v = side(d, 1), w = side(d, 2);
                  if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) {
                    canvas.paint(x, y, colour, 0.9);
                  }
                });
}

}  // namespace

io::Image thumbnail(const Primitive& primitive, int pixels, double metres) {
  Canvas canvas(pixels, metres);
  const elements::Model& m = primitive.model;
  struct Item {
    float y;
    size_t k;
  };
  std::vector<Item> items;
  for (size_t k = 0; k < m.surface.size(); ++k) {
    items.push_back({m.surface.vertices[m.surface.triangles[k][0]].y(), k});
  }
  for (size_t k = 0; k < m.ellipsoids.size(); ++k) {
    items.push_back({m.ellipsoids[k].mean.y(), m.surface.size() + k});
  }
  std::stable_sort(items.begin(), items.end(),
                   [](const Item& a, const Item& b) { return a.y > b.y; });
  const double top = primitive.box.max.z();
  const double near = primitive.box.min.y(), far = std::max(primitive.box.max.y(), near + 0.1);
  for (const auto& [y, k] : items) {
    const double depth = std::clamp((far - double(y)) / (far - near), 0.0, 1.0);
    if (k < m.surface.size()) {
      std::array<Vec3f, 3> t;
      for (size_t c = 0; c < 3; ++c) t[c] = m.surface.vertices[m.surface.triangles[k][c]];
      draw(canvas, t, colour_of(double(t[0].z()), top, depth));
    } else {
      const elements::Ellipsoid& e = m.ellipsoids[k - m.surface.size()];
      draw(canvas, e, colour_of(double(e.mean.z()), top, depth));
    }
  }
  return std::move(canvas).image();
}

}  // namespace underbrush::primitives
