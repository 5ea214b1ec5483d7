#include "underbrush/fit/expectation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/fit/maximisation.hpp"
#include "underbrush/fit/rearrangement.hpp"
#include "underbrush/metrics/predictive.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {
namespace {

/// Elements of one kind with given ranges, σ and p, and beams that meet them: triangles whose σ is
/// the root of their tilt.
struct GivenMeetings {
  std::vector<trace::Intersection> met;
  std::vector<float> p;
  BeamBlock block;

  GivenMeetings(std::vector<trace::Intersection> list, double range_m) : met(std::move(list)) {
    for (const trace::Intersection& m : met) {
      p.push_back(float(m.p));
      block.met.push_back(m.element);
      block.on_triangle.push_back({float(m.t_m), float(m.sigma_m * m.sigma_m)});
    }
    block.beams = {{{0, 0, 0}, float(range_m), {1, 0, 0}, 1000}};
    block.first = block.first_triangle = {0, uint32_t(met.size())};
  }
  PassTotals share(const trace::OutlierShares& soft, double max_range_m, BlockShares& out) const {
    ModelForm form{};
    form.triangle_p = p.data();
    form.ground_triangles = form.triangles = uint32_t(p.size());
    form.roughness_variance[0] = 1;
    return find_shares(form, block, soft, max_range_m, out);
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
    EXPECT_NEAR(shares.loss[0], want, 1e-5);
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

/// The sums of beams that meet one ellipsoid each, with given shares.
class GivenShares {
 public:
  explicit GivenShares(const elements::Model& model)
      : model_(model), by_element_(model.ellipsoids.size()) {}
  void add(const Ray& ray, uint32_t element, double range_m, double hit, double pass, double loss) {
    const Vec3f o = ray.origin.cast<float>(), d = ray.direction.cast<float>();
    const uint32_t beam = uint32_t(block_.beams.size());
    block_.beams.push_back({{o[0], o[1], o[2]}, float(range_m), {d[0], d[1], d[2]}, 1000});
    shares_.hit.push_back(float(hit));
    shares_.pass.push_back(float(pass));
    shares_.loss.push_back(float(loss));
    by_element_[element].push_back({beam, beam});
  }
  ElementSums sums() {
    MeetingsByElement lists;
    for (uint32_t e = 0; e < by_element_.size(); ++e) {
      lists.elements.push_back({e, uint32_t(lists.met.size())});
      lists.met.insert(lists.met.end(), by_element_[e].begin(), by_element_[e].end());
    }
    lists.elements.push_back({uint32_t(by_element_.size()), uint32_t(lists.met.size())});
    ElementSums out(model_);
    out.add(ModelForms(model_, 0).view(), block_, lists, shares_);
    return out;
  }

 private:
  const elements::Model& model_;
  std::vector<std::vector<ElementMeeting>> by_element_;
  BeamBlock block_;
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
    shares.add(rays.back(), 0, ranges.back(), hit, pass, 0);
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
  const Mat3 l = Eigen::LLT<Mat3>(e.covariance_matrix()).matrixL();
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
  options.prior_points = options.opaque_hits = options.spent_points = 0;
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
      shares.add(ray, 0, met.t_m + (k % 2 ? 1 : -1) * met.sigma_m, met.p, 1 - met.p, 0);
    }
    const Mat3 after =
        maximised(start, shares.sums(), options, 1).ellipsoids[0].covariance_matrix();
    const double left = (after(i, j) - (i == j ? 0.25 : 0)) / 0.5;
    EXPECT_LT(std::abs(left), 0.015) << i << j;  // of 0.05
  }
}

TEST(Rearrangement, HalvesHaveTheMomentsOfTheWholeAndMergeToIt) {
  elements::Ellipsoid e;
  e.mean = Vec3f(1, 2, 3);
  e.set_covariance(Vec3(0.5, 0.2, 0.1).asDiagonal());
  e.density_per_m = 2;
  const auto two = halves(e);
  EXPECT_GT((two[1].mean - two[0].mean).norm(), 1);
  const elements::Ellipsoid back = merged(two[0], 7, two[1], 7);
  EXPECT_LT((back.mean - e.mean).norm(), 1e-6);
  EXPECT_LT((back.covariance_matrix() - e.covariance_matrix()).norm(), 1e-6);
  EXPECT_NEAR(back.density_per_m, e.density_per_m, 1e-5);
}

TEST(Rearrangement, RemovesTheEmptyMergesTwinsAndNeverAdds) {
  elements::Model model;
  for (int k = 0; k < 40; ++k) {
    elements::Ellipsoid e;
    // pairs of near ellipsoids, far from other pairs
    e.mean = Vec3f(float(k / 2) * 5, k % 2 ? 0.01f : 0.0f, 0);
    e.set_covariance(0.04 * Mat3::Identity());
    e.density_per_m = 1;
    model.ellipsoids.push_back(e);
  }
  GivenShares shares(model);
  for (uint32_t k = 4; k < 40; ++k) {  // no beam meets the first four
    for (int i = 0; i < 30; ++i) shares.add({Vec3(-10, 0, 0), Vec3(1, 0, 0)}, k, 10, 0.9, 0.1, k);
  }
  const ElementSums sums = shares.sums();
  RearrangementOptions options;
  options.share = 0.25;
  options.split_share = 0;
  EXPECT_EQ(rearranged(model, sums, options).ellipsoids.size(), 40u - 4 - 10);
  options.split_share = 0.5;
  options.split_hits = 1;
  const elements::Model split = rearranged(model, sums, options);
  EXPECT_EQ(split.ellipsoids.size(), 40u - 4 - 10 + 7);
}

}  // namespace
}  // namespace underbrush::fit
