#include "underbrush/sensor/beam.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kGoldenAngle = 2.399963229728653;
constexpr double kGaussianExtent = 2.5;  // in half-widths; holds 99.7 % of the energy of each axis
constexpr int kFine = 16;                // points across a cell at which its energy is summed

/// Computes the energy per area at (u, v), up to a factor.
double density(const BeamShape& shape, double u, double v) {
  switch (shape.profile) {
    case Profile::kUniform:
      return u * u + v * v <= 1;
    case Profile::kGaussian:
      return std::exp2(-(u * u + v * v));
    case Profile::kTable: {
      const int columns = shape.table_columns, rows = int(shape.table.size()) / columns;
      const int c = std::clamp(int((u + 1) / 2 * columns), 0, columns - 1);
      const int r = std::clamp(int((v + 1) / 2 * rows), 0, rows - 1);
      return shape.table[size_t(r) * size_t(columns) + size_t(c)];
    }
  }
  return 0;
}

/// Computes the radius within which a share `q` of a round profile's energy lies.
double radius_of_share(Profile profile, double q) {
  return profile == Profile::kGaussian ? std::sqrt(-std::log2(1 - q)) : std::sqrt(q);
}

/// Finds a place of the table from two numbers in [0, 1): `a` is the share of the energy that comes
/// before it in the order of the cells, `b` its place v within the cell.
std::array<double, 2> place_in_table(const BeamShape& shape, double a, double b) {
  const size_t columns = size_t(shape.table_columns), rows = shape.table.size() / columns;
  double left = a * std::accumulate(shape.table.begin(), shape.table.end(), 0.0);
  size_t cell = 0;
  while (cell + 1 < shape.table.size() && left >= shape.table[cell]) left -= shape.table[cell++];
  const double within = std::clamp(left / shape.table[cell], 0.0, 1.0);
  return {2 * (double(cell % columns) + within) / double(columns) - 1,
          2 * (double(cell / columns) + b) / double(rows) - 1};
}

/// Computes the standard deviation of u and of v.
std::array<double, 2> sigma_of_profile(const BeamShape& shape) {
  if (shape.profile == Profile::kUniform) return {0.5, 0.5};
  if (shape.profile == Profile::kGaussian)
    return {1 / std::sqrt(2 * M_LN2), 1 / std::sqrt(2 * M_LN2)};
  const size_t columns = size_t(shape.table_columns), rows = shape.table.size() / columns;
  const std::array<double, 2> cell{2 / double(columns), 2 / double(rows)};
  double energy = 0;
  std::array<double, 2> sum{}, squares{};
  for (size_t i = 0; i < shape.table.size(); ++i) {
    const std::array<size_t, 2> at{i % columns, i / columns};
    energy += shape.table[i];
    for (size_t k = 0; k < 2; ++k) {
      const double x = cell[k] * (double(at[k]) + 0.5) - 1;
      sum[k] += shape.table[i] * x;
      squares[k] += shape.table[i] * (x * x + cell[k] * cell[k] / 12);
    }
  }
  for (size_t k = 0; k < 2; ++k) {
    sum[k] /= energy;
    squares[k] = std::sqrt(squares[k] / energy - sum[k] * sum[k]);
  }
  return squares;
}

}  // namespace

std::array<double, 2> BeamShape::half_width_m(double range_m) const {
  std::array<double, 2> width{};
  for (size_t k = 0; k < 2; ++k) {
    const double exit = exit_diameter_m / 2, cone = range_m * std::tan(divergence_rad[k] / 2);
    width[k] = growth == Growth::kCone ? exit + cone : std::hypot(exit, cone);
  }
  return width;
}

std::array<double, 2> BeamShape::sigma_m(double range_m) const {
  std::array<double, 2> sigma = half_width_m(range_m);
  const std::array<double, 2> unit = sigma_of_profile(*this);
  for (size_t k = 0; k < 2; ++k) sigma[k] *= unit[k];
  return sigma;
}

void BeamShape::check() const {
  const auto fine = [](double v, double most) { return v >= 0 && v < most; };
  require(fine(divergence_rad[0], M_PI / 2) && fine(divergence_rad[1], M_PI / 2),
          "beam: divergence must be from 0 to below 90 degrees");
  require(fine(exit_diameter_m, 10), "beam: exit diameter must be from 0 to below 10 m");
  require(fine(encoder_step_rad, M_PI), "beam: encoder step must be from 0 to below 180 degrees");
  if (profile != Profile::kTable) return;
  require(table_columns > 0 && !table.empty() && table.size() % size_t(table_columns) == 0,
          "beam: the profile's table needs whole rows");
  double sum = 0;
  for (double v : table) {
    require(std::isfinite(v) && v >= 0, "beam: negative energy in the profile's table");
    sum += v;
  }
  require(sum > 0, "beam: no energy in the profile's table");
}

std::vector<float> exact_weights(std::span<const double> shares) {
  constexpr int64_t kUnits = 1 << 24;
  double sum = 0;
  for (double s : shares) {
    require(std::isfinite(s) && s >= 0, "weights: a share is negative or not finite");
    sum += s;
  }
  require(sum > 0 && std::isfinite(sum), "weights: nothing to share");
  std::vector<int64_t> units(shares.size());
  std::vector<std::pair<double, size_t>> rest(shares.size());
  int64_t left = kUnits;
  for (size_t k = 0; k < shares.size(); ++k) {
    const double exact = shares[k] / sum * double(kUnits);
    units[k] = int64_t(exact);
    rest[k] = {-(exact - std::floor(exact)), k};
    left -= units[k];
  }
  std::sort(rest.begin(), rest.end());
  for (size_t k = 0; left > 0; ++k, --left) ++units[rest[k % rest.size()].second];
  for (size_t k = 0; left < 0; ++k) {  // rounding can make the sum too large by a unit or two
    int64_t& u = units[rest[rest.size() - 1 - k % rest.size()].second];
    if (u > 0) --u, ++left;
  }
  std::vector<float> weights(shares.size());
  for (size_t k = 0; k < shares.size(); ++k) weights[k] = float(units[k]) / float(kUnits);
  return weights;
}

std::vector<SubRay> spread_sub_rays(const BeamShape& shape, int n) {
  require(n >= 1 && n <= 1 << 20, "beam: the number of sub-rays must be 1 to 2^20");
  require(shape.profile != Profile::kTable, "beam: a tabulated profile needs a grid of sub-rays");
  const std::vector<float> weight = exact_weights(std::vector<double>(size_t(n), 1.0));
  std::vector<SubRay> rays(size_t(n), SubRay{});
  if (n == 1) return rays;
  for (int k = 0; k < n; ++k) {
    const double radius = radius_of_share(shape.profile, (k + 0.5) / n);
    rays[size_t(k)] = {float(radius * std::cos(k * kGoldenAngle)),
                       float(radius * std::sin(k * kGoldenAngle)), weight[size_t(k)]};
  }
  return rays;
}

std::vector<SubRay> grid_sub_rays(const BeamShape& shape, int columns, int rows) {
  require(std::min(columns, rows) >= 1 && std::max(columns, rows) <= kMostSubRayLines,
          "beam: columns and rows of sub-rays must be 1 to 1024");
  const double extent = shape.profile == Profile::kGaussian ? kGaussianExtent : 1;
  std::vector<SubRay> rays;
  std::vector<double> energy;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      double sum = 0, sum_u = 0, sum_v = 0;
      for (int k = 0; k < kFine * kFine; ++k) {
        const double u = extent * (2 * (c + (k % kFine + 0.5) / kFine) / columns - 1);
        const double v = extent * (2 * (r + (k / kFine + 0.5) / kFine) / rows - 1);
        const double e = density(shape, u, v);
        sum += e;
        sum_u += e * u;
        sum_v += e * v;
      }
      if (sum == 0) continue;
      energy.push_back(sum);
      rays.push_back({float(sum_u / sum), float(sum_v / sum), 0});
    }
  }
  const std::vector<float> weight = exact_weights(energy);
  for (size_t k = 0; k < rays.size(); ++k) rays[k].weight = weight[k];
  return rays;
}

BeamAxes beam_axes(const Ray& axis, const Vec3& vertical) {
  const Vec3 across = axis.direction.cross(vertical);
  const double length = across.norm();
  const Vec3 right = length > 1e-6 ? Vec3(across / length) : Vec3(axis.direction.unitOrthogonal());
  return {axis, right, right.cross(axis.direction), vertical};
}

RayMaker::RayMaker(const BeamShape& shape)
    : exit_m_(shape.exit_diameter_m / 2),
      slope_u_(std::tan(shape.divergence_rad[0] / 2)),
      slope_v_(std::tan(shape.divergence_rad[1] / 2)),
      cone_(shape.growth == Growth::kCone) {}

Ray RayMaker::ray(const BeamAxes& beam, double u, double v) const {
  // In a waist, a line starts a quarter turn ahead of where it points, so that the squares add.
  const double x = exit_m_ * (cone_ ? u : -v), y = exit_m_ * (cone_ ? v : u);
  const double a = slope_u_ * u, b = slope_v_ * v, shrink = 1 / std::sqrt(1 + a * a + b * b);
  return {beam.axis.origin + x * beam.right + y * beam.up,
          shrink * (beam.axis.direction + a * beam.right + b * beam.up)};
}

Ray random_ray(const BeamAxes& beam, const BeamShape& shape, uint64_t key) {
  const double a = uniform_from_bits(random_bits(key, 0, Purpose::kDirection));
  const double b = uniform_from_bits(random_bits(key, 1, Purpose::kDirection));
  const double c = uniform_from_bits(random_bits(key, 2, Purpose::kDirection));
  std::array<double, 2> place{};
  if (shape.profile == Profile::kTable) {
    place = place_in_table(shape, a, b);
  } else {
    const double radius = radius_of_share(shape.profile, a);
    place = {radius * std::cos(2 * M_PI * b), radius * std::sin(2 * M_PI * b)};
  }
  Ray ray = RayMaker(shape).ray(beam, place[0], place[1]);
  const double turn = (c - 0.5) * shape.encoder_step_rad;
  ray.direction = Eigen::AngleAxisd(turn, beam.vertical) * ray.direction;
  return ray;
}

}  // namespace underbrush::sensor
