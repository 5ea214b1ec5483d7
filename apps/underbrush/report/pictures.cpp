#include "report/pictures.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::app {
namespace {

constexpr int kRowPixels = 3;

uint8_t mixed(double a, double b, double s) { return uint8_t(std::lround(a + s * (b - a))); }

void paint(io::Image& image, int x, int y, Colour c) {
  std::copy(c.begin(), c.end(), image.rgb.begin() + 3 * (std::ptrdiff_t(y) * image.width + x));
}

}  // namespace

Colour colour_of_error(double error_m) {
  const double s = std::clamp(error_m / kErrorSpan, -1.0, 1.0);
  const double end[3] = {s < 0 ? 20.0 : 200.0, s < 0 ? 80.0 : 20.0, s < 0 ? 220.0 : 20.0};
  const double a = std::sqrt(std::abs(s));
  return {mixed(205, end[0], a), mixed(205, end[1], a), mixed(205, end[2], a)};
}

Colour colour_of_level(double level) {
  // Five stops of a perceptually even ramp, dark violet to yellow.
  static constexpr double kStops[5][3] = {
      {68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
  const double x = std::clamp(level, 0.0, 1.0) * 3.999;
  const int k = int(x);
  Colour c;
  for (size_t d = 0; d < 3; ++d) c[d] = mixed(kStops[k][d], kStops[k + 1][d], x - k);
  return c;
}

BirdsEye::BirdsEye(const Eigen::Vector2d& lo, const Eigen::Vector2d& hi, int pixels) : lo_(lo) {
  const Eigen::Vector2d size = (hi - lo).cwiseMax(1.0);
  metres_per_pixel_ = size.maxCoeff() / pixels;
  image_ = io::Image(std::max(1, int(size.x() / metres_per_pixel_)),
                     std::max(1, int(size.y() / metres_per_pixel_)), 250);
  height_.assign(size_t(image_.width) * size_t(image_.height), -INFINITY);
}

void BirdsEye::draw(const Vec3& point, Colour colour) {
  const int x = int(std::floor((point.x() - lo_.x()) / metres_per_pixel_));
  const int y = image_.height - 1 - int(std::floor((point.y() - lo_.y()) / metres_per_pixel_));
  if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
  float& height = height_[size_t(y) * size_t(image_.width) + size_t(x)];
  if (point.z() < height) return;
  height = float(point.z());
  paint(image_, x, y, colour);
}

void BirdsEye::draw_height(const Vec3& point, double low, double high) {
  draw(point, colour_of_level((point.z() - low) / std::max(1e-6, high - low)));
}

RangeImage::RangeImage(const Pose& world_from_sensor, int columns, int rings, bool top_ring_is_zero)
    : sensor_from_world_(world_from_sensor.inverse()),
      rings_(rings),
      top_ring_is_zero_(top_ring_is_zero),
      image_(columns, rings * kRowPixels, 250) {}

void RangeImage::draw(const BeamLog& log, size_t beam, Colour colour) {
  const Vec3 d = sensor_from_world_.rotation * log.direction[beam].cast<double>();
  const double turn = 0.5 - std::atan2(d.y(), d.x()) / (2 * M_PI);
  const int x = std::clamp(int(turn * image_.width), 0, image_.width - 1);
  const int ring = log.ring[beam];
  if (ring >= rings_) return;
  const int row = top_ring_is_zero_ ? ring : rings_ - 1 - ring;
  for (int k = 0; k < kRowPixels; ++k) paint(image_, x, row * kRowPixels + k, colour);
}

}  // namespace underbrush::app
