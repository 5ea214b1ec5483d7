#include "underbrush/likelihood/expectation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/likelihood/maximisation.hpp"
#include "underbrush/metrics/predictive.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::likelihood {
namespace {

/// Elements of one kind with given ranges, σ and p, and beams that meet them: triangles whose σ is
/// the root of their tilt.
struct GivenMeetings {
  std::vector<trace::Intersection> met;
  std::vector<float> p;
  std::vector<ListedBeam> beams;
  BeamBlock block;

  GivenMeetings(std::vector<trace::Intersection> list, double range_m) : met(std::move(list)) {
    for (const trace::Intersection& m : met) {
      p.push_back(float(m.p));
      block.met.push_back(m.element);
      block.on_triangle.push_back({float(m.t_m), float(m.sigma_m * m.sigma_m)});
    }
    beams = {{{0, 0, 0}, float(range_m), {1, 0, 0}, 1000}};
    block.beams = beams;
    block.first = block.first_triangle = {0, uint32_t(met.size())};
  }
  PassTotals share(const trace::OutlierShares& soft, double max_range_m, BlockShares& out) const {
    ModelForm form{};
    form.triangle_p = p.data();
    form.ground_triangles = form.triangles = uint32_t(p.size());
    const std::vector<float> variance(p.size(), 1.0f);
    form.roughness_variance = variance.data();
    return find_shares(form, block, soft, max_range_m, out, nullptr);
  }
};

std::vector<trace::Intersection> random_mets(Stream& random, size_t n) {
  std::vector<trace::Intersection> met;
  double t = 2;
  for (uint32_t k = 0; k < n; ++k) {
    t += random.uniform(0, 3);
    const double sigma = random.uniform(0.05, 2), p = random.uniform();
    met.push_back({t, sigma, 0, p, k});
  }
  return met;
}

TEST(Shares, SumToOneAndTheirLikelihoodIsThatOfTheScore) {
  Stream random(21);
  for (int i = 0; i < 200; ++i) {
    const std::vector<trace::Intersection> met = random_mets(random, i % 7);
    const double range = i % 3 ? random.uniform(0, 20) : double(kMiss);
    BlockShares shares;
    const PassTotals totals = GivenMeetings(met, range).share({}, 100, shares);
    double sum = totals.stray_hits.value();
    for (size_t k = 0; k < met.size(); ++k) sum += double(shares.hit[k]);
    if (range != kMiss) {
      EXPECT_NEAR(sum, 1, 1e-6);
    }
    for (size_t k = 1; k < met.size(); ++k) {
      EXPECT_NEAR(shares.pass[k - 1], shares.pass[k] + shares.hit[k], 1e-6);
    }
    trace::RangeMixture p;
    trace::mix_ranges(met, 1, 0, p);
    const double want = metrics::negative_log_likelihood(p, range, 100);
    EXPECT_NEAR(totals.loss.value(), want, 1e-5);
  }
}

TEST(Shares, OfTwoElementsByHandInAnyOrderOfTheList) {
  std::vector<trace::Intersection> met{{10, 0.1, 0, 0.5, 0}, {10.2, 0.2, 0, 0.8, 1}};
  const auto density = [](double x, double s) {
    return std::exp(-0.5 * x * x / (s * s)) / (s * std::sqrt(2 * M_PI));
  };
  const double a = 0.9 * 0.5 * density(0.1, 0.1), b = 0.9 * 0.5 * 0.8 * density(-0.1, 0.2);
  const double total = a + b + 0.06 / 50;
  for (size_t first : {0, 1}) {
    const size_t near = first, far = 1 - first;
    BlockShares shares;
    GivenMeetings(met, 10.1).share({0.06, 0.04}, 50, shares);
    EXPECT_NEAR(shares.hit[near], a / total, 1e-5);
    EXPECT_NEAR(shares.pass[near], b / total, 1e-5);
    EXPECT_NEAR(shares.pass[far], 0, 1e-6);
    GivenMeetings(met, double(kMiss)).share({0.06, 0.04}, 50, shares);
    EXPECT_NEAR(shares.pass[far], 0.9 * 0.1 / (0.9 * 0.1 + 0.04), 1e-6);
    met = {{10.2, 0.2, 0, 0.8, 0}, {10, 0.1, 0, 0.5, 1}};
  }
}

/// The slopes by range noise and roughness are compared with finite differences of the expected
/// log-likelihood, Σ r (−ln σ − x²/2) with the shares r at the place.
TEST(Shares, SlopesOfNoiseAreTheDerivativesOfTheExpectedLogLikelihood) {
  Stream random(24);
  GivenMeetings given(random_mets(random, 5), 6);
  const size_t n = given.met.size();
  const std::vector<float> rough{0.3f, 0.01f, 0.2f, 0.05f, 0.1f};
  ModelForm form{};
  form.triangle_p = given.p.data();
  form.ground_triangles = form.triangles = uint32_t(n);
  form.roughness_variance = rough.data();
  form.range_variance[0] = 0.04f;
  elements::Model model;
  model.ground.hit.resize(n);
  model.ground.triangles.resize(n);
  ElementSums sums(model);
  BlockShares shares;
  const PassTotals totals = find_shares(form, given.block, {}, 100, shares, &sums);
  const auto expected = [&](size_t k, double log_range, double log_rough) {
    const double t = double(given.block.on_triangle[k].t_m),
                 tilt = double(given.block.on_triangle[k].tilt);
    const double variance =
        0.04 * std::exp(2 * log_range) + double(rough[k]) * std::exp(2 * log_rough) * tilt;
    return double(shares.hit[k]) * -0.5 * (std::log(variance) + (6 - t) * (6 - t) / variance);
  };
  const double step = 1e-4;
  double by_range = 0, curvature = 0;
  for (size_t k = 0; k < n; ++k) {
    by_range += (expected(k, step, 0) - expected(k, -step, 0)) / (2 * step);
    const double by_rough = (expected(k, 0, step) - expected(k, 0, -step)) / (2 * step);
    const TriangleSums of = sums.triangle(k);
    EXPECT_NEAR(of.hits, shares.hit[k], 1e-6) << k;
    EXPECT_NEAR(of.roughness_slope, by_rough, 1e-4 + 1e-4 * std::abs(by_rough)) << k;
    const double own = 0.04 / (0.04 + double(rough[k] * given.block.on_triangle[k].tilt));
    EXPECT_NEAR(of.roughness_curvature, 2 * shares.hit[k] * (1 - own) * (1 - own), 1e-5) << k;
    curvature += 2 * double(shares.hit[k]) * own * own;
  }
  EXPECT_NEAR(totals.noise[0][0].value(), by_range, 1e-4 + 1e-4 * std::abs(by_range));
  EXPECT_NEAR(totals.noise[0][1].value(), curvature, 1e-5);
}

/// The sums of beams that meet one ellipsoid each, with given shares.
class GivenShares {
 public:
  explicit GivenShares(const elements::Model& model) : model_(model) {}
  void add(const Ray& ray, uint32_t element, double range_m, double hit, double pass) {
    const Vec3f o = ray.origin.cast<float>(), d = ray.direction.cast<float>();
    beams_.push_back({{o[0], o[1], o[2]}, float(range_m), {d[0], d[1], d[2]}, 1000});
    shares_.hit.push_back(float(hit));
    shares_.pass.push_back(float(pass));
    met_.push_back(element);
    first_.push_back(uint32_t(met_.size()));
  }
  ElementSums sums() {
    const ModelForms forms(model_, 0);
    RunColumns columns;
    columns.resize(met_.size());
    const size_t count =
        pass_kernels().approach(forms.view(), beams_.data(), first_.data(), 0, beams_.size(),
                                met_.data(), nullptr, columns.meetings(), columns.ellipsoids());
    ElementSums out(model_);
    out.add(columns.ellipsoids(), count, met_.data(), {shares_.hit.data(), shares_.pass.data()});
    return out;
  }

 private:
  const elements::Model& model_;
  std::vector<ListedBeam> beams_;
  std::vector<uint32_t> first_{0}, met_;
  BlockShares shares_;
};

/// Computes the expected log-likelihood of fixed shares as the one ellipsoid moves.
double expected(const elements::Model& model, const std::vector<Ray>& rays,
                const std::vector<double>& ranges,
                const std::vector<std::array<double, 2>>& shares) {
  double sum = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const trace::Intersection m =
        trace::intersect(model, 0, rays[i].origin, rays[i].direction, {-100, 100});
    if (m.none()) continue;
    const double x = (ranges[i] - m.t_m) / m.sigma_m;
    sum += shares[i][0] * (std::log(m.p) - std::log(m.sigma_m) - 0.5 * x * x) +
           shares[i][1] * std::log1p(-m.p);
  }
  return sum;
}

/// The slopes are compared with finite differences in all ten parameters.
TEST(ElementSums, SlopesAreTheDerivativesOfTheExpectedLogLikelihood) {
  Stream random(22);
  elements::Model model;
  model.tau = 50;
  elements::Ellipsoid e;
  e.mean = Vec3f(0.5f, -0.25f, 1);
  Mat3 root;
  root << 0.8, 0, 0, 0.2, 0.5, 0, -0.1, 0.3, 0.6;
  e.set_covariance(root * root.transpose());
  e.density_per_m = 1.2f;
  model.ellipsoids = {e};
  std::vector<Ray> rays;
  std::vector<double> ranges;
  std::vector<std::array<double, 2>> given;
  GivenShares shares(model);
  for (int i = 0; i < 40; ++i) {
    Vec3 from(random.normal(), random.normal(), random.normal());
    from = 6 * from.normalized();
    const Vec3 to(0.8 * random.normal(), 0.8 * random.normal(), 1 + 0.8 * random.normal());
    rays.push_back({from, (to - from).normalized()});
    trace::Intersection met =
        trace::intersect(model, 0, rays.back().origin, rays.back().direction, {-100, 100});
    ASSERT_FALSE(met.none());
    ranges.push_back(met.t_m + met.sigma_m * random.normal());
    const double hit = random.uniform(), pass = random.uniform(0, 1 - hit);
    given.push_back({hit, pass});
    shares.add(rays.back(), 0, ranges.back(), hit, pass);
  }
  const EllipsoidSums s = shares.sums().ellipsoid(0);
  const auto slope = [&](const std::function<void(elements::Ellipsoid&, double)>& move) {
    const double step = 2e-3;
    double at[2];
    for (int side = 0; side < 2; ++side) {
      elements::Model moved = model;
      move(moved.ellipsoids[0], side ? step : -step);
      at[side] = expected(moved, rays, ranges, given);
    }
    return (at[1] - at[0]) / (2 * step);
  };
  const Mat3 l = cholesky(e.covariance_matrix());
  EXPECT_NEAR(slope([](auto& x, double h) { x.density_per_m *= float(std::exp(h)); }),
              s.density_slope, 0.02);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(slope([&](auto& x, double h) { x.mean += (h * l.col(k)).template cast<float>(); }),
                s.shift_slope[k], 0.02);
    for (int j = k; j < 3; ++j) {
      Mat3 unit = Mat3::Zero();
      unit(j, k) = unit(k, j) = 1;
      const double want = s.stretch_slope(j, k) * (j == k ? 1 : 2);
      EXPECT_NEAR(slope([&](auto& x, double h) {
                    const Mat3 f = l * (Mat3::Identity() + h * unit);
                    x.set_covariance(f * f.transpose());
                  }),
                  want, 0.03);
    }
  }
}

/// A step along one entry of E is that of Newton's method: a small error in that entry is gone
/// after it. Beams come from all sides and return as the true ellipsoid says.
TEST(Maximisation, OneStepMendsASmallStretchOnAndOffTheDiagonal) {
  elements::Model truth;
  truth.tau = 50;
  elements::Ellipsoid e;
  e.set_covariance(0.25 * Mat3::Identity());
  e.density_per_m = 0.8f;
  truth.ellipsoids = {e};
  MaximisationOptions options;
  options.prior_points = options.prior_hits = options.spent_points = 0;
  for (const auto& [i, j] : {std::pair{0, 0}, std::pair{0, 1}, std::pair{1, 2}}) {
    Mat3 error = Mat3::Zero();
    error(i, j) = error(j, i) = 0.05;
    elements::Model start = truth;
    const Mat3 root = 0.5 * (Mat3::Identity() + error);
    start.ellipsoids[0].set_covariance(root * root.transpose());
    GivenShares shares(start);
    Stream random(23);
    for (int k = 0; k < 40000; ++k) {
      Vec3 from(random.normal(), random.normal(), random.normal());
      from = 6 * from.normalized();
      const Vec3 to(0.6 * random.normal(), 0.6 * random.normal(), 0.6 * random.normal());
      const Ray ray{from, (to - from).normalized()};
      const trace::Intersection met =
          trace::intersect(truth, 0, ray.origin, ray.direction, {-100, 100});
      // its mean over outcomes: a return with probability p, one σ before or behind
      shares.add(ray, 0, met.t_m + (k % 2 ? 1 : -1) * met.sigma_m, met.p, 1 - met.p);
    }
    const Neighbours neighbours(start.ellipsoids);
    const elements::Model moved = maximised(start, shares.sums(), neighbours, options, 1);
    const Mat3 after = moved.ellipsoids[0].covariance_matrix();
    const double left = (after(i, j) - (i == j ? 0.25 : 0)) / 0.5;
    EXPECT_LT(std::abs(left), 0.015) << i << j;  // of 0.05
  }
}

}  // namespace
}  // namespace underbrush::likelihood
