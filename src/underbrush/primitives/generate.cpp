#include "underbrush/primitives/generate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/primitives/size_rules.hpp"

namespace underbrush::primitives {
namespace {

/// Plants of one kind: how many, how high (median, spread of the logarithm, limits), how wide.
struct Plants {
  double per_m2, median_m, spread, low_m, high_m, width_of_height;
};
struct Kind {
  const char* name;
  Plants trees, shrubs;
  double patch_share, patch_m;  // of the area; usual height
  bool shrubs_lead;             // the density given is that of the shrubs
};

constexpr Kind kKinds[] = {
    {"forest", {0.05, 10, 0.35, 3, 30, 0.35}, {0.02, 0.9, 0.5, 0.3, 2.8, 1}, 0.1, 0.6, false},
    {"savanna", {0.003, 6, 0.3, 3, 15, 0.7}, {0.015, 1, 0.5, 0.3, 2.8, 1.1}, 0.05, 0.5, false},
    {"meadow", {0.0003, 7, 0.3, 3, 15, 0.6}, {0.01, 0.6, 0.4, 0.25, 2.5, 1}, 0.5, 0.6, true},
};

/// Places that keep apart.
class Spacing {
 public:
  explicit Spacing(double cell_m) : cell_m_(cell_m) {}
  bool free(double x, double y, double radius_m) const {
    const auto [i, j] = cell_of(x, y, cell_m_);
    const auto reach = int32_t(std::ceil((radius_m + largest_m_) / cell_m_));
    for (int32_t a = i - reach; a <= i + reach; ++a) {
      for (int32_t b = j - reach; b <= j + reach; ++b) {
        const auto found = cells_.find(Cell2{a, b});
        if (found == cells_.end()) continue;
        for (const Vec3& p : found->second) {
          if (std::hypot(p.x() - x, p.y() - y) < radius_m + p.z()) return false;
        }
      }
    }
    return true;
  }
  void add(double x, double y, double radius_m) {
    cells_[cell_of(x, y, cell_m_)].emplace_back(x, y, radius_m);
    largest_m_ = std::max(largest_m_, radius_m);
  }

 private:
  double cell_m_, largest_m_ = 0;
  CellMap<Cell2, std::vector<Vec3>> cells_;
};

Box box_of(double length_m, double width_m, double height_m) {
  return {Vec3(-0.5 * length_m, -0.5 * width_m, 0), Vec3(0.5 * length_m, 0.5 * width_m, height_m)};
}

class Generator {
 public:
  Generator(const GroundSurface& ground, const GenerateOptions& o) : ground_(ground), o_(o) {
    inner_ = ground.bounds();
    inner_.min().array() += o.margin_m;
    inner_.max().array() -= o.margin_m;
  }

  void scatter(const Plants& p, bool trees, uint64_t seed) {
    if (inner_.isEmpty()) return;
    Stream random(seed);
    const auto wanted = size_t(std::llround(p.per_m2 * inner_.volume()));
    // Where plants are asked for more densely than their crowns allow, crowns overlap.
    const double radius = 0.5 * p.width_of_height * p.median_m;
    const double crowding = p.per_m2 * 4 * radius * radius;
    const double keep = std::min(0.9, 0.7 / std::sqrt(std::max(crowding, 1e-9)));
    Spacing spacing(std::max(1.0, radius));
    size_t standing = 0;
    for (size_t tries = 0; standing < wanted && tries < 30 * wanted; ++tries) {
      const double x = random.uniform(inner_.min().x(), inner_.max().x());
      const double y = random.uniform(inner_.min().y(), inner_.max().y());
      const double height =
          std::clamp(p.median_m * std::exp(p.spread * random.normal()), p.low_m, p.high_m);
      const double width = p.width_of_height * height * random.uniform(0.75, 1.25);
      const double slender = random.uniform(0.7, 1), yaw = random.uniform(-M_PI_2, M_PI_2);
      const double apart = 0.5 * keep * width;
      const std::optional<double> z = ground_.at(x, y);
      if (!z || !spacing.free(x, y, apart)) continue;
      spacing.add(x, y, apart);
      PlacedObject object;
      object.label =
          trees ? tree_class(SizeRules{}, height) : shrub_class(SizeRules{}, height, false);
      object.position = Vec3(x, y, *z);
      object.yaw_rad = yaw;
      object.box = box_of(width, slender * width, height);
      objects.push_back(object);
      ++standing;
    }
  }

  void patches(double share, double height_m, uint64_t seed) {
    if (share <= 0 || inner_.isEmpty()) return;
    Stream random(seed);
    std::array<Vec3, 8> waves;
    for (Vec3& w : waves) {
      const double azimuth = random.uniform(0, 2 * M_PI), k = 2 * M_PI / random.uniform(12, 50);
      w = Vec3(k * std::cos(azimuth), k * std::sin(azimuth), random.uniform(0, 2 * M_PI));
    }
    // A sum of many waves is normal: the share of the area above a level is known.
    const double level = std::sqrt(0.5 * waves.size()) * normal_from_uniform(1 - share);
    const double side = o_.patch_cell_m;
    const auto first = [&](double v) { return int64_t(std::ceil(v / side)); };
    for (int64_t j = first(inner_.min().y()); (j + 1) * side <= inner_.max().y(); ++j) {
      for (int64_t i = first(inner_.min().x()); (i + 1) * side <= inner_.max().x(); ++i) {
        const double x = (double(i) + 0.5) * side, y = (double(j) + 0.5) * side;
        double sum = 0;
        for (const Vec3& w : waves) sum += std::cos(w.x() * x + w.y() * y + w.z());
        const double height = std::clamp(height_m * std::exp(0.3 * random.normal()), 0.2, 2.8);
        if (sum < level) continue;
        const std::optional<double> z = ground_.at(x, y);
        if (!z) continue;
        PlacedObject cell;
        cell.label = shrub_class(SizeRules{}, height, true);
        cell.position = Vec3(x, y, *z);
        cell.box = box_of(side, side, height);
        objects.push_back(cell);
      }
    }
  }

  std::vector<PlacedObject> objects;

 private:
  const GroundSurface& ground_;
  const GenerateOptions& o_;
  Eigen::AlignedBox2d inner_;
};

}  // namespace

std::vector<std::string> site_kinds() {
  std::vector<std::string> names;
  for (const Kind& k : kKinds) names.emplace_back(k.name);
  return names;
}

std::vector<PlacedObject> generate_objects(const GroundSurface& ground, const GenerateOptions& o) {
  require(o.density >= 0 && o.density <= 10, "generate: the density must lie in [0, 10] per m²");
  require(o.margin_m >= 0 && o.patch_cell_m > 0, "generate: lengths must be positive");
  for (Kind kind : kKinds) {
    if (o.kind != kind.name) continue;
    if (o.density > 0) (kind.shrubs_lead ? kind.shrubs : kind.trees).per_m2 = o.density;
    Generator generator(ground, o);
    generator.scatter(kind.trees, true, mix64(o.seed + 1));
    generator.scatter(kind.shrubs, false, mix64(o.seed + 2));
    generator.patches(kind.patch_share, kind.patch_m, mix64(o.seed + 3));
    return std::move(generator.objects);
  }
  throw std::invalid_argument("generate: no kind of site '" + o.kind + "'");
}

}  // namespace underbrush::primitives
