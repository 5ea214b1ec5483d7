#include "studies/echo_counts.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "underbrush/trace/world.hpp"

namespace underbrush::studies {
namespace {

constexpr double kOnGround = 0.2, kAbove = 100;                // m
constexpr std::array<double, 5> kEdges{0, 2, 4, 8, INFINITY};  // m

/// Tells whether points are near a model's ground.
class Ground {
 public:
  explicit Ground(const elements::Model& model) : ground_(model.like()) {
    ground_.ground = model.ground;
    world_ = std::make_unique<trace::World>(ground_);
  }
  bool near(const Vec3& point) const {
    const Ray down{point + kAbove * Vec3::UnitZ(), -Vec3::UnitZ()};
    const trace::Intersection met = world_->nearest_surface(down, {0, 2 * kAbove});
    return !met.none() && met.t_m - kAbove < kOnGround;
  }

 private:
  elements::Model ground_;
  std::unique_ptr<trace::World> world_;
};

size_t band_of(double range_m) {
  return size_t(std::upper_bound(kEdges.begin() + 1, kEdges.end() - 1, range_m) - kEdges.begin()) -
         1;
}

}  // namespace

EchoCounts::EchoCounts(const BeamLog& log, const elements::Model& ground) {
  const Ground floor(ground);
  const std::vector<bool> first = begins_beam(log);
  for (size_t i = 0; i < log.size();) {
    size_t end = i + 1;
    while (end < log.size() && !first[end]) ++end;
    if (log.is_hit(i)) {
      const size_t number = std::min(end - i, kNumbers) - 1;
      const bool low = floor.near(log.end_point(i));
      ++counts_[index(number, band_of(double(log.range_m[i])), low)];
      ++pulses_;
      for (size_t k = i + 1; k < end; ++k) {
        gaps_.push_back(double(log.range_m[k]) - double(log.range_m[k - 1]));
      }
    }
    i = end;
  }
  std::sort(gaps_.begin(), gaps_.end());
}

double EchoCounts::share_where(const Choice& of, size_t echoes) const {
  size_t chosen = 0, all = 0;
  for (size_t number = 0; number < kNumbers; ++number) {
    for (size_t band = 0; band < kBands; ++band) {
      for (const bool ground : {false, true}) {
        if (!of(band, ground)) continue;
        const size_t n = counts_[index(number, band, ground)];
        all += n;
        if (number + 1 >= echoes) chosen += n;
      }
    }
  }
  return all == 0 ? NAN : double(chosen) / double(all);
}

double EchoCounts::share(size_t echoes) const {
  return share_where([](size_t, bool) { return true; }, echoes);
}

double EchoCounts::share_of_class(bool ground) const {
  return share_where([ground](size_t, bool low) { return low == ground; }, 2);
}

double EchoCounts::share_in_band(size_t band) const {
  return share_where([band](size_t b, bool) { return b == band; }, 2);
}

std::string EchoCounts::name_of_band(size_t band) {
  const std::string from = std::to_string(int(kEdges[band]));
  return band + 1 == kBands ? "from " + from + " m"
                            : from + " to " + std::to_string(int(kEdges[band + 1])) + " m";
}

std::array<double, 3> EchoCounts::gaps() const {
  std::array<double, 3> out{NAN, NAN, NAN};
  if (gaps_.empty()) return out;
  for (size_t k = 0; k < 3; ++k) out[k] = gaps_[(k + 1) * (gaps_.size() - 1) / 4];
  return out;
}

double EchoCounts::distance(const EchoCounts& real) const {
  double sum = 0;
  for (size_t band = 0; band < kBands; ++band) {
    for (const bool ground : {false, true}) {
      size_t n = 0, n_real = 0;
      for (size_t number = 0; number < kNumbers; ++number) {
        n += counts_[index(number, band, ground)];
        n_real += real.counts_[index(number, band, ground)];
      }
      if (n_real == 0) continue;
      for (size_t number = 0; number < kNumbers; ++number) {
        const double own = n == 0 ? 0 : double(counts_[index(number, band, ground)]) / double(n);
        sum += std::abs(own * double(n_real) - double(real.counts_[index(number, band, ground)]));
      }
    }
  }
  return sum / 2 / double(real.pulses_);
}

}  // namespace underbrush::studies
