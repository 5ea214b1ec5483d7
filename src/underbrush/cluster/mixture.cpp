#include "underbrush/cluster/mixture.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/check.hpp"
#include "underbrush/core/kd_tree.inl"

namespace underbrush::cluster {
namespace {

constexpr size_t kMostShares = 8, kMostNeighbours = 12;

/// An ellipsoid of the mixture.
struct Component {
  double points = 0;  ///< Number of points that it holds.
  Vec3 mean;          ///< Rounded to float, as models store it.
  Mat3 sigma;
};

/// The density of an ellipsoid of the mixture, in compact form.
struct Density {
  Vec3f center;                    ///< Its mean.
  std::array<float, 6> precision;  ///< Σ⁻¹: xx xy xz yy yz zz.
  float log_weight;                ///< log(points / √|Σ|).

  explicit Density(const Component& c) : center(c.mean.cast<float>()) {
    const Mat3 p = c.sigma.inverse();
    precision = {float(p(0, 0)), float(p(0, 1)), float(p(0, 2)),
                 float(p(1, 1)), float(p(1, 2)), float(p(2, 2))};
    log_weight = float(std::log(c.points) - 0.5 * std::log(c.sigma.determinant()));
  }
  /// Computes the log of the component's density at x, up to a constant.
  float log_of(const Vec3f& x) const {
    const Vec3f d = x - center;
    const auto& p = precision;
    return log_weight - 0.5f * (p[0] * d[0] * d[0] + p[3] * d[1] * d[1] + p[5] * d[2] * d[2]) -
           d[0] * (p[1] * d[1] + p[2] * d[2]) - p[4] * d[1] * d[2];
  }
};

/// The indices of the points, sorted by cluster. Cluster c has those from `start[c]` to `start[c +
/// 1]`.
struct ByCluster {
  std::vector<uint32_t> order, start;

  explicit ByCluster(const Clusters& clusters) : start(clusters.count + 1) {
    for (const uint32_t c : clusters.group) {
      if (c != Clusters::kNone) ++start[c + 1];
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    order.resize(start.back());
    std::vector<uint32_t> at(start.begin(), start.end() - 1);
    for (size_t i = 0; i < clusters.group.size(); ++i) {
      if (clusters.group[i] != Clusters::kNone) order[at[clusters.group[i]]++] = uint32_t(i);
    }
  }
};

/// Finds for each ellipsoid the `k` ellipsoids with the nearest means, itself among them.
std::vector<uint32_t> neighbours(std::span<const Vec3f> mean, size_t k) {
  const CloudTree tree(mean, 10);
  std::vector<uint32_t> out(mean.size() * k);
  std::vector<float> squares(k);
  for (size_t c = 0; c < mean.size(); ++c) {
    tree.nearest(mean[c].data(), k, &out[c * k], squares.data());
  }
  return out;
}

/// Fills `out` with the ellipsoids of `among` whose means are nearest to x.
void nearest_of(std::span<const uint32_t> among, std::span<const Vec3f> mean, const Vec3f& x,
                std::span<uint32_t> out) {
  std::array<float, kMostShares> square;
  square.fill(INFINITY);
  for (const uint32_t c : among) {
    const float d = (x - mean[c]).squaredNorm();
    size_t at = out.size();
    for (; at > 0 && d < square[at - 1]; --at) {
      if (at == out.size()) continue;
      square[at] = square[at - 1];
      out[at] = out[at - 1];
    }
    if (at == out.size()) continue;
    square[at] = d;
    out[at] = c;
  }
}

/// Computes S, the covariance of a point's displacement across its beam.
Mat3 across(const Footprint& footprint, const Vec3& to_sensor) {
  const double range = to_sensor.norm();
  const Vec3 back = to_sensor / range, level = Vec3::UnitZ().cross(back);
  const Vec3 right = level.norm() > 1e-6 ? Vec3(level.normalized()) : back.unitOrthogonal();
  const Vec3 up = back.cross(right);
  const auto [horizontal, vertical] = footprint(range);
  return horizontal * horizontal * right * right.transpose() +
         vertical * vertical * up * up.transpose();
}

/// Sums of a component's points: their number and first two moments about its mean.
class Shares {
 public:
  void add(double q, const Vec3& y) {
    sums_[0] += q;
    for (int a = 0, next = 4; a < 3; ++a) {
      sums_[1 + a] += q * y[a];
      for (int b = a; b < 3; ++b) sums_[next++] += q * (y[a] * y[b]);
    }
  }
  /// Adds a point of which only the mean y and the covariance `open` are known.
  void add(double q, const Vec3& y, const Mat3& open) {
    add(q, y);
    sums_.tail<6>() += q * Eigen::Matrix<double, 6, 1>(open(0, 0), open(0, 1), open(0, 2),
                                                       open(1, 1), open(1, 2), open(2, 2));
  }
  double n() const { return sums_[0]; }
  Vec3 mean() const { return sums_.segment<3>(1) / n(); }
  Mat3 scatter() const {
    Mat3 squares;
    squares << sums_[4], sums_[5], sums_[6], sums_[5], sums_[7], sums_[8], sums_[6], sums_[8],
        sums_[9];
    return squares - n() * mean() * mean().transpose();
  }

 private:
  using Sums = Eigen::Matrix<double, 10, 1>;
  Sums sums_ = Sums::Zero();
};

/// Turns logs of densities into shares that sum to 1.
void normalise(std::span<float> logs) {
  constexpr float kLeast = -7;  // shares below e⁻⁷ of the largest count as 0
  const float most = *std::max_element(logs.begin(), logs.end());
  float sum = 0;
  for (float& x : logs) sum += x = x - most < kLeast ? 0 : std::exp(x - most);
  for (float& x : logs) x /= sum;
}

/// Shares a point among the components that may hold it.
void share(const Vec3f& x, std::span<const uint32_t> candidates, std::span<const Density> densities,
           std::span<Shares> shares) {
  std::array<float, kMostShares> part;
  const size_t k = candidates.size();
  for (size_t j = 0; j < k; ++j) part[j] = densities[candidates[j]].log_of(x);
  normalise({part.data(), k});
  for (size_t j = 0; j < k; ++j) {
    if (part[j] == 0) continue;
    shares[candidates[j]].add(part[j], (x - densities[candidates[j]].center).cast<double>());
  }
}

/// Shares a point that was moved across its beam with covariance `s` among the components.
void share(const Vec3& x, const Mat3& s, std::span<const uint32_t> candidates,
           std::span<const Component> components, std::span<Shares> shares) {
  std::array<float, kMostShares> part;
  std::array<Mat3, kMostShares> precision;
  const size_t k = candidates.size();
  for (size_t j = 0; j < k; ++j) {
    const Component& c = components[candidates[j]];
    const Mat3 seen = c.sigma + s;
    precision[j] = seen.inverse();
    const Vec3 d = x - c.mean;
    part[j] = float(std::log(c.points) - 0.5 * std::log(seen.determinant()) -
                    0.5 * d.dot(precision[j] * d));
  }
  normalise({part.data(), k});
  for (size_t j = 0; j < k; ++j) {
    if (part[j] == 0) continue;
    const Component& c = components[candidates[j]];
    const Mat3 gain = c.sigma * precision[j];
    shares[candidates[j]].add(part[j], gain * (x - c.mean), c.sigma - gain * c.sigma);
  }
}

void maximise(std::span<const Shares> shares, const EllipsoidOptions& options,
              std::span<Component> components) {
  constexpr double kNone = 1e-6;
  TypicalVariance typical(options.floor_m);
  for (const Shares& s : shares) {
    if (s.n() > kNone) typical.add(s.n(), s.scatter());
  }
  const Mat3 prior = options.prior_points * typical.variance() * Mat3::Identity();
  for (size_t j = 0; j < components.size(); ++j) {
    Component& c = components[j];
    const Shares& s = shares[j];
    if (s.n() > kNone) {
      const Mat3 sigma = (s.scatter() + prior) / (s.n() + options.prior_points);
      c = {s.n(), (c.mean + s.mean()).cast<float>().cast<double>(),
           elements::floored_covariance(sigma, options.floor_of(s.n()))};
    } else {
      c.points = kNone;
    }
  }
}

}  // namespace

std::vector<elements::Ellipsoid> mixture(std::span<const Vec3f> points,
                                         std::span<const Vec3f> to_sensor, const Clusters& clusters,
                                         const EllipsoidOptions& ellipsoid,
                                         const MixtureOptions& options, std::vector<bool>* kept) {
  require(to_sensor.size() == points.size(), "mixture: as many directions as points are needed");
  require(options.rounds >= 0, "mixture: the number of rounds must not be negative");
  require(options.shared_by >= 1 && size_t(options.shared_by) <= kMostShares,
          "mixture: a point is shared by 1 to 8 ellipsoids");
  std::vector<elements::Ellipsoid> out = ellipsoids_of(points, clusters, ellipsoid);
  if (kept) kept->assign(out.size(), true);
  if (out.empty() || options.rounds == 0) return out;
  require(out.size() == clusters.count, "mixture: a cluster has no points");
  const auto [order, start] = ByCluster(clusters);
  std::vector<Vec3f> ordered;
  ordered.reserve(order.size());
  for (const uint32_t i : order) ordered.push_back(points[i]);
  std::vector<Component> components;
  std::vector<Vec3f> means;
  for (size_t c = 0; c < out.size(); ++c) {
    components.push_back(
        {double(start[c + 1] - start[c]), out[c].mean.cast<double>(), out[c].covariance_matrix()});
    means.push_back(out[c].mean);
  }
  const size_t k = std::min(size_t(options.shared_by), components.size());
  const size_t among = std::min(kMostNeighbours, components.size());
  const std::vector<uint32_t> around = neighbours(means, among);
  std::vector<uint32_t> candidates(order.size() * k);
  for (size_t c = 0; c < components.size(); ++c) {
    for (size_t i = start[c]; i < start[c + 1]; ++i) {
      nearest_of({&around[c * among], among}, means, ordered[i], {&candidates[i * k], k});
    }
  }
  for (int round = 0; round < options.rounds; ++round) {
    std::vector<Shares> shares(components.size());
    std::vector<Density> densities;
    if (!options.footprint) densities = {components.begin(), components.end()};
    for (size_t i = 0; i < order.size(); ++i) {
      const std::span<const uint32_t> nearest(&candidates[i * k], k);
      if (options.footprint) {
        const Mat3 s = across(options.footprint, to_sensor[order[i]].cast<double>());
        share(ordered[i].cast<double>(), s, nearest, components, shares);
      } else {
        share(ordered[i], nearest, densities, shares);
      }
    }
    maximise(shares, ellipsoid, components);
  }
  out.clear();
  for (size_t j = 0; j < components.size(); ++j) {
    const Component& c = components[j];
    if (c.points < options.least_points) {
      if (kept) (*kept)[j] = false;
      continue;
    }
    elements::Ellipsoid& e = out.emplace_back();
    e.mean = c.mean.cast<float>();
    e.set_covariance(c.sigma);
  }
  return out;
}

}  // namespace underbrush::cluster
