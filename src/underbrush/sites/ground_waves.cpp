#include "underbrush/sites/ground_waves.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/test_site/terrain.hpp"

namespace underbrush::sites {
namespace {

constexpr double kLeastLagM = 1, kMostSamples = 2048;  // Along a side.
constexpr size_t kWavesOfBand = 16;
constexpr int kSteps = 2000;  // Of the fit.

/// Heights on a grid, about their mean plane; NaN where there is no ground.
struct HeightSamples {
  double step_m = 0;
  int columns = 0, rows = 0;
  std::vector<double> z;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();

  double at(int x, int y) const { return z[size_t(y) * size_t(columns) + size_t(x)]; }
};

HeightSamples sample(const primitives::GroundSurface& ground) {
  HeightSamples s;
  const Eigen::Vector2d size = ground.bounds().sizes();
  s.step_m = std::max(kLeastLagM, size.maxCoeff() / kMostSamples);
  s.columns = int(size.x() / s.step_m) + 1;
  s.rows = int(size.y() / s.step_m) + 1;
  Mat3 normal = Mat3::Identity() * 1e-9;
  Vec3 right = Vec3::Zero();
  for (int y = 0; y < s.rows; ++y) {
    for (int x = 0; x < s.columns; ++x) {
      const Eigen::Vector2d at = ground.bounds().min() + s.step_m * Eigen::Vector2d(x, y);
      s.z.push_back(ground.at(at.x(), at.y()).value_or(NAN));
      if (std::isnan(s.z.back())) continue;
      const Vec3 a(s.step_m * x, s.step_m * y, 1);
      normal += a * a.transpose();
      right += a * s.z.back();
    }
  }
  const Vec3 plane = solve(normal, right);
  s.slope = plane.head<2>();
  for (int y = 0; y < s.rows; ++y) {
    for (int x = 0; x < s.columns; ++x) {
      s.z[size_t(y) * size_t(s.columns) + size_t(x)] -=
          plane.dot(Vec3(s.step_m * x, s.step_m * y, 1));
    }
  }
  return s;
}

/// The mean square of the differences at a lag of that many samples; NaN where there is none.
double mean_square(const HeightSamples& s, int lag) {
  double sum = 0;
  size_t n = 0;
  const auto add = [&](double a, double b) {
    if (std::isnan(a) || std::isnan(b)) return;
    sum += (a - b) * (a - b);
    ++n;
  };
  for (int y = 0; y < s.rows; ++y) {
    for (int x = 0; x < s.columns; ++x) {
      if (x + lag < s.columns) add(s.at(x, y), s.at(x + lag, y));
      if (y + lag < s.rows) add(s.at(x, y), s.at(x, y + lag));
    }
  }
  return n ? sum / double(n) : NAN;
}

}  // namespace

GroundStructure structure_of(const primitives::GroundSurface& ground) {
  const HeightSamples samples = sample(ground);
  GroundStructure out;
  out.slope = samples.slope;
  for (int lag = 1; 2 * lag <= std::max(samples.columns, samples.rows); lag *= 2) {
    const double square = mean_square(samples, lag);
    if (std::isnan(square)) continue;
    out.lag_m.push_back(samples.step_m * lag);
    out.square_m2.push_back(square);
  }
  return out;
}

GroundSpectrum spectrum_of(const GroundStructure& structure) {
  GroundSpectrum out;
  out.slope = structure.slope;
  const auto n = Eigen::Index(structure.lag_m.size());
  // Row: lag, divided by its observed structure; column: power of a band.
  Eigen::MatrixXd share(n, n);
  for (Eigen::Index row = 0; row < n; ++row) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const double x = 2 * M_PI * structure.lag_m[size_t(row)] / (2 * structure.lag_m[size_t(k)]);
      share(row, k) =
          2 * (1 - std::cyl_bessel_j(0, x)) / std::max(structure.square_m2[size_t(row)], 1e-8);
    }
  }
  // Multiplicative steps keep powers positive.
  Eigen::VectorXd power = Eigen::VectorXd::Constant(n, 1e-4);
  const Eigen::VectorXd wanted = share.transpose() * Eigen::VectorXd::Ones(n);
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::VectorXd now = share.transpose() * (share * power);
    power = power.array() * wanted.array() / now.array().max(1e-300);
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    out.bands.push_back({2 * structure.lag_m[size_t(k)], std::sqrt(power[k])});
  }
  return out;
}

elements::TriangleMesh ground_with(const GroundSpectrum& spectrum, const Eigen::Vector2d& size_m,
                                   double spacing_m, uint64_t seed) {
  struct Wave {
    double kx, ky, phase, amplitude;
  };
  std::vector<Wave> waves;
  Stream random(seed);
  for (const GroundSpectrum::Band& band : spectrum.bands) {
    const double k = 2 * M_PI / band.wavelength_m;
    for (size_t n = 0; n < kWavesOfBand; ++n) {
      const double azimuth = random.uniform(0, 2 * M_PI), phase = random.uniform(0, 2 * M_PI);
      waves.push_back({k * std::cos(azimuth), k * std::sin(azimuth), phase,
                       band.sigma_m * std::sqrt(2.0 / kWavesOfBand)});
    }
  }
  return test_site::mesh_of_heights(size_m, spacing_m, [&](double x, double y) {
    double z = spectrum.slope.x() * x + spectrum.slope.y() * y;
    for (const Wave& w : waves) z += w.amplitude * std::cos(w.kx * x + w.ky * y + w.phase);
    return z;
  });
}

}  // namespace underbrush::sites
