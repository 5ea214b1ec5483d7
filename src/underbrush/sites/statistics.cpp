#include "underbrush/sites/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/cells.hpp"
#include "underbrush/sites/distances.hpp"
#include "underbrush/sites/ground_waves.hpp"

namespace underbrush::sites {
namespace {

using elements::ClassKind;
using primitives::PlacedObject;

constexpr double kLagsM[] = {1, 4, 16};

/// The objects of a kind in a window.
struct OfKind {
  std::vector<Eigen::Vector2d> at;
  std::vector<double> height_m, width_m;
};

OfKind of_kind(const Window& window, std::span<const PlacedObject> objects, ClassKind kind) {
  OfKind out;
  for (const PlacedObject& o : objects) {
    const Eigen::Vector2d at = o.position.head<2>();
    if (elements::kind_of(o.label) != kind || !window.contains(at)) continue;
    out.at.push_back(at);
    out.height_m.push_back(o.box.max.z());
    out.width_m.push_back(0.5 * (o.box.size().x() + o.box.size().y()));
  }
  return out;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return NAN;
  const auto at = values.begin() + long(q * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double of_a = mean_of(a), of_b = mean_of(b);
  double sum = 0;
  for (size_t k = 0; k < a.size(); ++k) sum += (a[k] - of_a) * (b[k] - of_b);
  return a.size() < 3 ? NAN : sum / double(a.size() - 1) / deviation_of(a) / deviation_of(b);
}

std::vector<double> finite(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  return values;
}

/// Marks the cells below a box.
class Cover {
 public:
  explicit Cover(double cell_m) : cell_m_(cell_m) {}
  void add(const PlacedObject& o) {
    const Vec3 half = 0.5 * o.box.size(), middle = 0.5 * (o.box.min + o.box.max);
    const bool square = elements::kind_of(o.label) == ClassKind::kPatch;
    const Pose world_from_object = o.world_from_object(),
               object_from_world = world_from_object.inverse();
    const Vec3 center = world_from_object * middle;
    const double reach = half.head<2>().norm();
    const Cell2 low = cell_of(center.x() - reach, center.y() - reach, cell_m_);
    const Cell2 high = cell_of(center.x() + reach, center.y() + reach, cell_m_);
    for (int32_t y = low.y; y <= high.y; ++y) {
      for (int32_t x = low.x; x <= high.x; ++x) {
        const Vec3 at(cell_m_ * (x + 0.5), cell_m_ * (y + 0.5), center.z());
        const Eigen::Array2d d =
            ((object_from_world * at - middle).head<2>().array() / half.head<2>().array()).abs();
        if (square ? d.maxCoeff() <= 1 : d.matrix().norm() <= 1) covered_[{x, y}] = true;
      }
    }
  }
  /// The share of the window that is covered.
  double share(const std::vector<Eigen::Vector2d>& middles) const {
    size_t n = 0;
    for (const Eigen::Vector2d& m : middles) n += covered_.count(cell_of(m.x(), m.y(), cell_m_));
    return middles.empty() ? NAN : double(n) / double(middles.size());
  }

 private:
  double cell_m_;
  CellMap<Cell2, bool> covered_;
};

void add_kind(const Window& window, const OfKind& all, const std::string& name,
              std::vector<Statistic>& out) {
  const std::vector<double> apart = finite(nearest_distances(all.at, all.at));
  out.push_back({name + "s per hectare", "1/ha", 1e4 * double(all.at.size()) / window.area_m2()});
  out.push_back({name + " to nearest " + name + ", mean", "m", mean_of(apart)});
  out.push_back({name + " to nearest " + name + ", 10 % quantile", "m", quantile(apart, 0.1)});
  out.push_back({name + " height, mean", "m", mean_of(all.height_m)});
  out.push_back({name + " height, deviation", "m", deviation_of(all.height_m)});
  out.push_back({name + " width, mean", "m", mean_of(all.width_m)});
}

}  // namespace

std::vector<Statistic> statistics_of(const Window& window, std::span<const PlacedObject> objects) {
  std::vector<Statistic> out;
  const OfKind trees = of_kind(window, objects, ClassKind::kTree);
  const OfKind shrubs = of_kind(window, objects, ClassKind::kShrub);
  add_kind(window, trees, "tree", out);
  add_kind(window, shrubs, "shrub", out);
  out.push_back({"tree height with distance to nearest tree, correlation", "",
                 correlation(trees.height_m, nearest_distances(trees.at, trees.at))});
  out.push_back({"shrub to nearest tree, mean", "m",
                 mean_of(finite(nearest_distances(shrubs.at, trees.at)))});
  Cover of_trees(window.cell_m()), of_patches(window.cell_m()), of_all(window.cell_m());
  for (const PlacedObject& o : objects) {
    const ClassKind kind = elements::kind_of(o.label);
    if (kind == ClassKind::kTree) of_trees.add(o);
    if (kind == ClassKind::kPatch) of_patches.add(o);
    of_all.add(o);
  }
  const std::vector<Eigen::Vector2d> middles = window.middles();
  out.push_back({"cover of trees", "", of_trees.share(middles)});
  out.push_back({"cover of patches", "", of_patches.share(middles)});
  out.push_back({"cover of all", "", of_all.share(middles)});
  return out;
}

std::vector<Statistic> statistics_of(const primitives::GroundSurface& ground) {
  const GroundStructure structure = structure_of(ground);
  std::vector<Statistic> out;
  for (const double lag : kLagsM) {
    double value = NAN;
    for (size_t k = 0; k < structure.lag_m.size(); ++k) {
      if (structure.lag_m[k] == lag) value = std::sqrt(structure.square_m2[k]);
    }
    out.push_back(
        {"ground height over " + std::to_string(int(lag)) + " m, difference", "m", value});
  }
  return out;
}

}  // namespace underbrush::sites
