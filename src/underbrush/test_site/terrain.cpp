#include "underbrush/test_site/terrain.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::test_site {
namespace {

constexpr double kCut = 0.08;  // m; depth of the track.

// Falls smoothly from 1 at 0 to 0 at 1 and beyond.
double fade(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return 1 - t * t * (3 - 2 * t);
}

// Draws waves with random directions, wavelengths spread evenly over octaves, and heights in
// proportion to their lengths.
template <class Waves>
void draw(Waves& waves, double shortest_m, double longest_m, double sigma_m, Stream& random) {
  double power = 0;
  for (auto& w : waves) {
    const double length_m = shortest_m * std::pow(longest_m / shortest_m, random.uniform());
    const double azimuth = random.uniform(0, 2 * M_PI);
    const double k = 2 * M_PI / length_m;
    w = {k * std::cos(azimuth), k * std::sin(azimuth), random.uniform(0, 2 * M_PI), length_m};
    power += 0.5 * w.amplitude * w.amplitude;
  }
  for (auto& w : waves) w.amplitude *= sigma_m / std::sqrt(power);
}

template <class Waves>
double sum(const Waves& waves, double x, double y) {
  double z = 0;
  for (const auto& w : waves) z += w.amplitude * std::cos(w.kx * x + w.ky * y + w.phase);
  return z;
}

/// The number of cells along x and y.
Cell2 grid_of(const Eigen::Vector2d& size_m, double spacing_m) {
  require(size_m.minCoeff() > 0 && spacing_m > 0, "terrain: sides and spacing must be positive");
  const double columns = std::ceil(size_m.x() / spacing_m);
  const double rows = std::ceil(size_m.y() / spacing_m);
  require(columns * rows < 1e9, "terrain: too many triangles");
  return {int32_t(columns), int32_t(rows)};
}

/// The mesh of the cells from `first` to before `end` of the grid `all`.
elements::TriangleMesh part_of_heights(const Eigen::Vector2d& size_m, const Cell2& all,
                                       const Cell2& first, const Cell2& end,
                                       const std::function<double(double, double)>& height) {
  require(0 <= first.x && first.x <= end.x && end.x <= all.x && 0 <= first.y && first.y <= end.y &&
              end.y <= all.y,
          "terrain: a part beyond the grid");
  const double width = size_m.x(), depth = size_m.y();
  const auto nx = size_t(end.x - first.x), ny = size_t(end.y - first.y);
  elements::TriangleMesh mesh;
  mesh.vertices.resize((nx + 1) * (ny + 1));
  mesh.triangles.resize(2 * nx * ny);
  mesh.hit.resize(2 * nx * ny);
  parallel_for(ny + 1, 8, [&](size_t begin_row, size_t end_row) {
    for (size_t j = begin_row; j < end_row; ++j) {
      const double y = depth * (double(size_t(first.y) + j) / double(all.y) - 0.5);
      for (size_t i = 0; i <= nx; ++i) {
        const double x = width * (double(size_t(first.x) + i) / double(all.x) - 0.5);
        mesh.vertices[j * (nx + 1) + i] = Vec3(x, y, height(x, y)).cast<float>();
        if (i == nx || j == ny) continue;
        const auto a = uint32_t(j * (nx + 1) + i), b = a + uint32_t(nx + 1);
        mesh.triangles[2 * (j * nx + i)] = {a, a + 1, b + 1};
        mesh.triangles[2 * (j * nx + i) + 1] = {a, b + 1, b};
      }
    }
  });
  return mesh;
}

}  // namespace

Terrain::Terrain(const TerrainParameters& parameters, uint64_t seed) : parameters_(parameters) {
  require(parameters.size_x_m > 0 && parameters.size_y_m > 0 && parameters.relief_m >= 0 &&
              parameters.roughness_m >= 0 && parameters.track_half_width_m > 0,
          "terrain: impossible size");
  Stream random(seed);
  draw(long_, 9, 45, parameters.relief_m, random);
  draw(short_, 0.8, 3, parameters.roughness_m, random);
  const double azimuth = random.uniform(0, 2 * M_PI);
  plane_ = {parameters.slope * std::cos(azimuth), parameters.slope * std::sin(azimuth)};
  for (double& phase : track_phase_) phase = random.uniform(0, 2 * M_PI);
}

double Terrain::height(double x, double y) const {
  const double beside_m = distance_to_track(x, y) - parameters_.track_half_width_m;
  const double track = fade(beside_m);
  return plane_[0] * x + plane_[1] * y + sum(long_, x, y) + (1 - 0.7 * track) * sum(short_, x, y) -
         kCut * track;
}

Vec3 Terrain::normal(double x, double y) const {
  constexpr double kStep = 1e-4;
  const double dx = (height(x + kStep, y) - height(x - kStep, y)) / (2 * kStep);
  const double dy = (height(x, y + kStep) - height(x, y - kStep)) / (2 * kStep);
  return Vec3(-dx, -dy, 1).normalized();
}

double Terrain::track_y(double x) const {
  const double a = 0.09 * parameters_.size_y_m, k = 2 * M_PI / parameters_.size_x_m;
  return a * std::sin(1.1 * k * x + track_phase_[0]) +
         0.3 * a * std::sin(2.3 * k * x + track_phase_[1]);
}

double Terrain::track_slope(double x) const {
  const double a = 0.09 * parameters_.size_y_m, k = 2 * M_PI / parameters_.size_x_m;
  return 1.1 * k * a * std::cos(1.1 * k * x + track_phase_[0]) +
         2.3 * k * 0.3 * a * std::cos(2.3 * k * x + track_phase_[1]);
}

double Terrain::distance_to_track(double x, double y) const {
  double u = x;  // Abscissa of the nearest point, by Gauss–Newton.
  for (int i = 0; i < 4; ++i) {
    const double slope = track_slope(u);
    u -= ((u - x) + (track_y(u) - y) * slope) / (1 + slope * slope);
  }
  return std::hypot(u - x, track_y(u) - y);
}

Cell2 Terrain::grid(double spacing_m, double margin_m) const {
  require(margin_m >= 0, "terrain: the margin must not be negative");
  return grid_of(size_m(margin_m), spacing_m);
}

elements::TriangleMesh Terrain::mesh(double spacing_m, double margin_m) const {
  return mesh(spacing_m, margin_m, {0, 0}, grid(spacing_m, margin_m));
}

elements::TriangleMesh Terrain::mesh(double spacing_m, double margin_m, Cell2 first,
                                     Cell2 end) const {
  return part_of_heights(size_m(margin_m), grid(spacing_m, margin_m), first, end,
                         [&](double x, double y) { return height(x, y); });
}

Eigen::Vector2d Terrain::size_m(double margin_m) const {
  return {parameters_.size_x_m + 2 * margin_m, parameters_.size_y_m + 2 * margin_m};
}

elements::TriangleMesh mesh_of_heights(const Eigen::Vector2d& size_m, double spacing_m,
                                       const std::function<double(double, double)>& height) {
  const Cell2 all = grid_of(size_m, spacing_m);
  return part_of_heights(size_m, all, {0, 0}, all, height);
}

}  // namespace underbrush::test_site
