#include "underbrush/likelihood/rearrangement.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/parallel.hpp"

namespace underbrush::likelihood {
namespace {

constexpr uint32_t kNobody = 0xffffffffu;

double root_of_volume(const elements::Ellipsoid& e) {
  return std::sqrt(e.covariance_matrix().determinant());
}

/// Computes the log-likelihood of an ellipsoid's own points, without the terms that a merge keeps.
double evidence(double hits, const elements::Ellipsoid& e) {
  return hits * std::log(hits / root_of_volume(e));
}

struct Merge {
  double cost;
  uint32_t a, b;
  bool operator<(const Merge& o) const { return cost != o.cost ? cost < o.cost : a < o.a; }
};

/// Finds the cheapest merge of each ellipsoid with one of its four nearest, once for each pair.
std::vector<Merge> possible_merges(const std::vector<elements::Ellipsoid>& ellipsoids,
                                   const std::vector<double>& hits,
                                   const RearrangementOptions& options) {
  const KdTree tree(
      ellipsoids.size(),
      [&](size_t i, size_t axis) { return ellipsoids[i].mean[Eigen::Index(axis)]; }, 12);
  std::vector<Merge> best(ellipsoids.size(), {options.largest_cost, kNobody, kNobody});
  parallel_for(best.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (hits[i] < options.least_hits) continue;
      uint32_t near[5];
      float squared[5];
      const size_t found = tree.nearest(ellipsoids[i].mean.data(), 5, near, squared);
      for (size_t k = 0; k < found; ++k) {
        const uint32_t j = near[k];
        if (j == i || hits[j] < options.least_hits || ellipsoids[i].label != ellipsoids[j].label) {
          continue;
        }
        const double both = hits[i] + hits[j];
        const double cost = evidence(hits[i], ellipsoids[i]) + evidence(hits[j], ellipsoids[j]) -
                            evidence(both, merged(ellipsoids[i], hits[i], ellipsoids[j], hits[j]));
        const Merge merge{cost, std::min(uint32_t(i), j), std::max(uint32_t(i), j)};
        if (merge < best[i]) best[i] = merge;
      }
    }
  });
  std::erase_if(best, [](const Merge& m) { return m.a == kNobody; });
  std::sort(best.begin(), best.end());
  return best;
}

/// Merges pairs until none is cheap or enough have been merged, and returns how many. `gone` marks
/// the ellipsoids that were merged into another one, `taken` both.
size_t merge_neighbours(const RearrangementOptions& options,
                        std::vector<elements::Ellipsoid>& ellipsoids, std::vector<double>& hits,
                        std::vector<uint8_t>& gone, std::vector<uint8_t>& taken) {
  const size_t most = size_t(options.share * double(ellipsoids.size()));
  size_t merges = 0;
  for (bool found = true; found && merges < most;) {
    found = false;
    std::vector<uint8_t> used = gone;
    for (const Merge& m : possible_merges(ellipsoids, hits, options)) {
      if (merges == most) break;
      if (used[m.a] || used[m.b]) continue;
      // A merged ellipsoid has the hits of both and may merge again.
      ellipsoids[m.a] = merged(ellipsoids[m.a], hits[m.a], ellipsoids[m.b], hits[m.b]);
      hits[m.a] += std::exchange(hits[m.b], 0);
      used[m.a] = used[m.b] = taken[m.a] = taken[m.b] = gone[m.b] = 1;
      ++merges;
      found = true;
    }
  }
  return merges;
}

}  // namespace

elements::Ellipsoid merged(const elements::Ellipsoid& a, double hits_a,
                           const elements::Ellipsoid& b, double hits_b) {
  const double share = hits_a / (hits_a + hits_b);
  const Vec3 apart = (b.mean - a.mean).cast<double>();
  elements::Ellipsoid out = hits_a < hits_b ? b : a;
  out.mean = a.mean + ((1 - share) * apart).cast<float>();
  out.set_covariance(share * a.covariance_matrix() + (1 - share) * b.covariance_matrix() +
                     share * (1 - share) * apart * apart.transpose());
  const double mass =
      double(a.density_per_m) * root_of_volume(a) + double(b.density_per_m) * root_of_volume(b);
  out.density_per_m = float(mass / root_of_volume(out));
  out.hit.hits = a.hit.hits + b.hit.hits;
  out.hit.misses = a.hit.misses + b.hit.misses;
  return out;
}

std::array<elements::Ellipsoid, 2> halves(const elements::Ellipsoid& e) {
  Eigen::SelfAdjointEigenSolver<Mat3> eigen;
  eigen.computeDirect(e.covariance_matrix());
  const double variance = eigen.eigenvalues()[2];
  const Vec3 axis = eigen.eigenvectors().col(2), apart = std::sqrt(2 / M_PI * variance) * axis;
  std::array<elements::Ellipsoid, 2> out{e, e};
  for (size_t k = 0; k < 2; ++k) {
    out[k].mean = e.mean + ((k ? 1 : -1) * apart).cast<float>();
    out[k].set_covariance(e.covariance_matrix() - 2 / M_PI * variance * axis * axis.transpose());
    out[k].density_per_m = float(0.5 * double(e.density_per_m) / std::sqrt(1 - 2 / M_PI));
    out[k].hit.hits /= 2;
    out[k].hit.misses /= 2;
  }
  return out;
}

elements::Model rearranged(const elements::Model& model, const ElementSums& sums,
                           const RearrangementOptions& options) {
  const std::vector<elements::Ellipsoid>& old = model.ellipsoids;
  std::vector<double> hits(old.size()), loss(old.size());
  double all_hits = 0, all_loss = 0;
  for (size_t i = 0; i < old.size(); ++i) {
    const EllipsoidSums s = sums.ellipsoid(i);
    all_hits += hits[i] = s.hits;
    all_loss += loss[i] = s.loss;
  }
  elements::Model out = model;
  std::vector<uint8_t> gone(old.size());
  size_t removed = 0;
  for (size_t i = 0; i < old.size(); ++i) removed += gone[i] = hits[i] < options.least_hits;
  std::vector<uint8_t> taken = gone;
  removed += merge_neighbours(options, out.ellipsoids, hits, gone, taken);
  std::vector<std::pair<double, uint32_t>> worst;
  const double mean_loss = all_hits > 0 ? all_loss / all_hits : 0;
  for (size_t i = 0; i < old.size(); ++i) {
    if (taken[i] || hits[i] < options.split_hits) continue;
    worst.emplace_back(hits[i] * mean_loss - loss[i], uint32_t(i));
  }
  std::sort(worst.begin(), worst.end());
  worst.resize(std::min(worst.size(), size_t(options.split_share * double(removed))));
  std::vector<elements::Ellipsoid> second;
  for (const auto& [excess, i] : worst) {
    const auto two = halves(old[i]);
    out.ellipsoids[i] = two[0];
    second.push_back(two[1]);
  }
  size_t kept = 0;
  for (size_t i = 0; i < old.size(); ++i) {
    if (!gone[i]) out.ellipsoids[kept++] = out.ellipsoids[i];
  }
  out.ellipsoids.resize(kept);
  out.ellipsoids.insert(out.ellipsoids.end(), second.begin(), second.end());
  return out;
}

}  // namespace underbrush::likelihood
