#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "underbrush/serve/selection.hpp"

namespace underbrush::serve {
namespace {

constexpr size_t kSteps = 40;

/// Values of one quantity; finite ones are counted.
class Histogram {
 public:
  void see(double value) {
    if (!std::isfinite(value)) return;
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  void add(double value) {
    if (!std::isfinite(value)) return;
    const double share = high_ > low_ ? (value - low_) / (high_ - low_) : 0;
    ++counts_[std::min(size_t(share * kSteps), kSteps - 1)];
  }
  nlohmann::json json() const {
    return {{"low", low_ + 0.0}, {"high", high_ + 0.0}, {"counts", counts_}};
  }

 private:
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
  std::array<uint64_t, kSteps> counts_{};
};

}  // namespace

std::string histogram_of(const OctreeFile& file, const NodeCubes& cubes, const FoundRows& found,
                         const Selection& selection, const std::vector<uint32_t>& values) {
  Histogram height, intensity;
  bool any = false;
  for (const bool second : {false, true}) {
    for (const uint32_t k : found.nodes) {
      const OctreePoints points = read_points(file, file.nodes()[k]);
      for (size_t i = 0; i < points.row.size(); ++i) {
        const uint32_t row = points.row[i];
        if (row >= cubes.rows || !found.rows.has(row) ||
            !selection.admits(LabelValue::of(values[row])))
          continue;
        any = true;
        const double z = cubes.origin.z() + cubes.low[k].z() + double(points.position[i].z());
        const double shine = std::isfinite(points.intensity[i]) ? double(points.intensity[i]) : 0;
        second ? height.add(z) : height.see(z);
        second ? intensity.add(shine) : intensity.see(shine);
      }
    }
  }
  if (!any) return "{}";
  return nlohmann::json{{"height_m", height.json()}, {"intensity", intensity.json()}}.dump();
}

}  // namespace underbrush::serve
