#include "underbrush/sites/arrangement.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::sites {
namespace {

constexpr double kBucketM = PairSteps::kReachM / 2;
constexpr double kShortMoveM = 2;  // Standard deviation along x and y.

}  // namespace

size_t Arrangement::bucket_of(const Eigen::Vector2d& at) const {
  const Eigen::Vector2d place = (at - window_.bounds().min()) / kBucketM;
  const int x = std::clamp(int(std::floor(place.x())), 0, columns_ - 1);
  const int y = std::clamp(int(std::floor(place.y())), 0, rows_ - 1);
  return size_t(y) * size_t(columns_) + size_t(x);
}

template <class F>
void Arrangement::for_each_near(const Eigen::Vector2d& at, const F& f) const {
  const size_t bucket = bucket_of(at);
  const int x = int(bucket) % columns_, y = int(bucket) / columns_;
  for (int j = std::max(y - 2, 0); j <= std::min(y + 2, rows_ - 1); ++j) {
    for (int i = std::max(x - 2, 0); i <= std::min(x + 2, columns_ - 1); ++i) {
      for (const uint32_t k : buckets_[size_t(j) * size_t(columns_) + size_t(i)]) {
        const double square = (points_[k].at - at).squaredNorm();
        if (square < PairSteps::kReachM * PairSteps::kReachM) f(k, std::sqrt(square));
      }
    }
  }
}

Arrangement::Arrangement(const Window& window, std::span<const MarkedPoint> points)
    : window_(window), points_(points.begin(), points.end()) {
  const Eigen::Vector2d size = window.bounds().sizes() / kBucketM;
  columns_ = int(size.x()) + 1;
  rows_ = int(size.y()) + 1;
  buckets_.resize(size_t(columns_) * size_t(rows_));
  for (uint32_t k = 0; k < points_.size(); ++k) buckets_[bucket_of(points_[k].at)].push_back(k);
  for (uint32_t k = 0; k < points_.size(); ++k) {
    for_each_near(points_[k].at, [&](uint32_t other, double distance) {
      if (other > k) pairs_.count(points_[k], points_[other], distance);
    });
  }
}

void Arrangement::count_pairs(uint32_t point, const Eigen::Vector2d& at, double sign) {
  for_each_near(at, [&](uint32_t other, double distance) {
    if (other != point) change_.count(points_[point], points_[other], distance, sign);
  });
}

double Arrangement::gain_of_counts(const PointProcess& process, const PairSteps& wanted) const {
  double gain = 0;
  for (size_t k = 0; k < change_.values.size(); ++k) {
    const double d = change_.values[k];
    if (d == 0) continue;
    const double off = pairs_.values[k] - wanted.values[k];
    gain += d * (process.steps.values[k] - (off + 0.5 * d) / (wanted.values[k] + 1));
  }
  return gain;
}

void Arrangement::move(uint32_t point, const Eigen::Vector2d& to) {
  MarkedPoint& p = points_[point];
  std::erase(buckets_[bucket_of(p.at)], point);
  p.at = to;
  buckets_[bucket_of(to)].push_back(point);
  for (size_t k = 0; k < pairs_.values.size(); ++k) pairs_.values[k] += change_.values[k];
}

void Arrangement::sweep(const PointProcess& process, const PairSteps& wanted, Stream& random) {
  for (size_t k = 0; k < points_.size(); ++k) {
    const auto point = uint32_t(random.below(points_.size()));
    const MarkedPoint& p = points_[point];
    Eigen::Vector2d to;
    if (random.uniform() < 0.5) {
      to = window_.draw(random);
    } else {
      const double dx = random.normal(), dy = random.normal();
      to = p.at + kShortMoveM * Eigen::Vector2d(dx, dy);
    }
    const double draw = random.uniform();
    if (!window_.contains(to)) continue;
    change_ = {};
    count_pairs(point, to, 1);
    count_pairs(point, p.at, -1);
    double gain = gain_of_counts(process, wanted);
    if (const auto b = process.gradient.find(p.label); b != process.gradient.end()) {
      gain += b->second.dot(window_.relative(to) - window_.relative(p.at));
    }
    if (std::log(draw) < gain) move(point, to);
  }
}

}  // namespace underbrush::sites
