#include "underbrush/cluster/hierarchical.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::cluster {
namespace {

/// Number of points from which the centres of a large cluster are found, about.
constexpr size_t kSample = 512;

/// A cluster during splitting: a range of the permuted points.
struct Part {
  uint32_t begin, end;
  double squares;  // sum of squared distances from the mean
  uint32_t size() const { return end - begin; }
  // The greatest sum comes first; places break ties, so that the order is total.
  bool operator<(const Part& o) const {
    return squares != o.squares ? squares < o.squares : begin > o.begin;
  }
};

double sum_of_squares(const Vec3f* p, size_t n) {
  Vec3 mean = Vec3::Zero();
  for (size_t i = 0; i < n; ++i) mean += p[i].cast<double>();
  mean /= double(n);
  double sum = 0;
  for (size_t i = 0; i < n; ++i) sum += (p[i].cast<double>() - mean).squaredNorm();
  return sum;
}

/// Splits clusters by k-means, in place.
class Splitter {
 public:
  Splitter(std::vector<Vec3f>& points, std::vector<uint32_t>& index,
           const HierarchicalOptions& options, uint64_t seed)
      : points_(points), index_(index), options_(options), seed_(seed) {}

  /// Gives the parts that `part` is split into, or `part` alone if it cannot be split.
  std::vector<Part> split(const Part& part, int wanted) {
    const int k = std::min({options_.branching, wanted, int(part.size()) / options_.min_points});
    if (k < 2 || !(part.squares > 0)) return {part};
    const std::span<const Vec3f> points(&points_[part.begin], part.size());
    Stream random(mix64(seed_ ^ (uint64_t(part.begin) << 32 | part.end)));
    std::span<const Vec3f> sample = sample_of(points, random);
    if (!choose_centres(sample, k, random)) choose_centres(sample = points, k, random);
    assign_.assign(sample.size(), kNowhere);
    for (int iteration = 0; iteration < options_.iterations; ++iteration) {
      if (!assign(sample)) break;
      move_centres(sample);
    }
    drop_small(points);
    return arrange(part);
  }

 private:
  static constexpr uint8_t kNowhere = 255;

  // Takes every n-th point of a large cluster, so that about `kSample` remain.
  std::span<const Vec3f> sample_of(std::span<const Vec3f> points, Stream& random) {
    const size_t step = points.size() / kSample;
    if (step < 2) return points;
    sample_.clear();
    for (size_t i = 0; i + step <= points.size(); i += step) {
      sample_.push_back(points[i + random.below(step)]);
    }
    return sample_;
  }

  // Chooses centres by k-means++ (Arthur & Vassilvitskii 2007): each with a probability
  // proportional to the squared distance to the nearest centre so far. Gives false if all points
  // are the same.
  bool choose_centres(std::span<const Vec3f> points, int k, Stream& random) {
    centre_.assign(1, points[random.below(points.size())]);
    least_.assign(points.size(), INFINITY);
    while (int(centre_.size()) < k) {
      double sum = 0;
      for (size_t i = 0; i < points.size(); ++i) {
        least_[i] = std::min(least_[i], (points[i] - centre_.back()).squaredNorm());
        sum += least_[i];
      }
      if (!(sum > 0)) break;
      double at = random.uniform() * sum;
      size_t i = 0;
      while (i + 1 < points.size() && (at -= least_[i]) > 0) ++i;
      centre_.push_back(points[i]);
    }
    return centre_.size() > 1;
  }

  /// Assigns each point to its nearest centre, and gives whether one changed its centre.
  bool assign(std::span<const Vec3f> points) {
    bool changed = false;
    for (size_t i = 0; i < points.size(); ++i) {
      uint8_t best = 0;
      float least = (points[i] - centre_[0]).squaredNorm();
      for (size_t c = 1; c < centre_.size(); ++c) {
        const float d = (points[i] - centre_[c]).squaredNorm();
        if (d < least) {
          least = d;
          best = uint8_t(c);
        }
      }
      changed |= assign_[i] != best;
      assign_[i] = best;
    }
    return changed;
  }

  void move_centres(std::span<const Vec3f> points) {
    std::vector<Vec3> sum(centre_.size(), Vec3::Zero());
    std::vector<uint32_t> count(centre_.size());
    for (size_t i = 0; i < points.size(); ++i) {
      sum[assign_[i]] += points[i].cast<double>();
      ++count[assign_[i]];
    }
    for (size_t c = 0; c < centre_.size(); ++c) {
      if (count[c]) centre_[c] = (sum[c] / double(count[c])).cast<float>();
    }
  }

  // Removes centres with too few points, the smallest first. Their points join the nearest centre
  // left.
  void drop_small(std::span<const Vec3f> points) {
    assign_.resize(points.size());
    for (;;) {
      assign(points);
      std::vector<uint32_t> count(centre_.size());
      for (uint8_t c : assign_) ++count[c];
      const auto smallest = std::min_element(count.begin(), count.end());
      if (centre_.size() == 1 || *smallest >= uint32_t(options_.min_points)) return;
      centre_.erase(centre_.begin() + (smallest - count.begin()));
    }
  }

  // Makes each centre's points contiguous and keeps their order.
  std::vector<Part> arrange(const Part& part) {
    std::vector<uint32_t> start(centre_.size() + 1);
    for (uint8_t c : assign_) ++start[c + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    scratch_points_.assign(points_.begin() + part.begin, points_.begin() + part.end);
    scratch_index_.assign(index_.begin() + part.begin, index_.begin() + part.end);
    std::vector<uint32_t> at(start.begin(), start.end() - 1);
    for (uint32_t i = 0; i < part.size(); ++i) {
      const uint32_t to = part.begin + at[assign_[i]]++;
      points_[to] = scratch_points_[i];
      index_[to] = scratch_index_[i];
    }
    std::vector<Part> parts;
    for (size_t c = 0; c < centre_.size(); ++c) {
      const uint32_t begin = part.begin + start[c], end = part.begin + start[c + 1];
      if (begin == end) continue;
      parts.push_back({begin, end, sum_of_squares(&points_[begin], end - begin)});
    }
    return parts;
  }

  std::vector<Vec3f>& points_;
  std::vector<uint32_t>& index_;
  const HierarchicalOptions& options_;
  uint64_t seed_;
  std::vector<Vec3f> centre_, scratch_points_, sample_;
  std::vector<float> least_;
  std::vector<uint8_t> assign_;
  std::vector<uint32_t> scratch_index_;
};

}  // namespace

Clusters hierarchical_clusters(std::span<const Vec3f> points, const HierarchicalOptions& options,
                               uint64_t seed) {
  require(options.clusters_per_point > 0 && options.clusters_per_point <= 1,
          "clusters_per_point must lie in (0, 1]");
  require(options.min_points >= 1, "min_points must be at least 1");
  require(options.branching >= 2 && options.branching <= 255, "branching must lie in [2, 255]");
  const double least_squares = options.least_rms_m * options.least_rms_m;
  Clusters out;
  out.group.assign(points.size(), Clusters::kNone);
  if (points.size() < size_t(options.min_points)) return out;

  // relative to one of them, because floats far from the origin are coarse
  std::vector<Vec3f> ordered;
  ordered.reserve(points.size());
  for (const Vec3f& p : points) ordered.push_back(p - points[0]);
  std::vector<uint32_t> index(points.size());
  std::iota(index.begin(), index.end(), 0u);
  Splitter splitter(ordered, index, options, seed);
  // The points of clusters that may be split, and the number of clusters that they call for.
  size_t divisible = points.size();
  const auto wanted = [&] {
    return std::max<size_t>(1, size_t(options.clusters_per_point * double(divisible) + 0.5));
  };
  std::priority_queue<Part> open;
  std::vector<Part> done, small;
  const auto add = [&](const Part& part) {
    if (part.squares > least_squares * double(part.size())) return open.push(part);
    small.push_back(part);
    divisible -= part.size();
  };
  add({0, uint32_t(points.size()), sum_of_squares(ordered.data(), ordered.size())});
  while (!open.empty() && open.size() + done.size() < wanted()) {
    const Part largest = open.top();
    open.pop();
    const size_t room = wanted() - open.size() - done.size();
    const std::vector<Part> parts =
        splitter.split(largest, int(std::min<size_t>(room, size_t(options.branching))));
    if (parts.size() == 1) {
      done.push_back(largest);
    } else {
      for (const Part& p : parts) add(p);
    }
  }
  for (; !open.empty(); open.pop()) done.push_back(open.top());
  done.insert(done.end(), small.begin(), small.end());
  std::sort(done.begin(), done.end(),
            [](const Part& a, const Part& b) { return a.begin < b.begin; });
  for (const Part& part : done) {
    for (uint32_t i = part.begin; i < part.end; ++i) out.group[index[i]] = out.count;
    ++out.count;
  }
  return out;
}

}  // namespace underbrush::cluster
