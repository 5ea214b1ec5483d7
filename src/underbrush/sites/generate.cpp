#include "underbrush/sites/generate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/primitives/size_rules.hpp"
#include "underbrush/test_site/terrain.hpp"

namespace underbrush::sites {
namespace {

using elements::Class;
using primitives::Box;
using primitives::GroundSurface;
using primitives::PlacedObject;
using primitives::SizeRules;

constexpr int kDrawsOfHeight = 1000;

/// Plants of one kind: density, height (median, spread of the logarithm, limits), and width.
struct Plants {
  double per_m2, median_m, spread, low_m, high_m, width_of_height;
};
struct Kind {
  const char* name;
  Plants trees, shrubs;
  double patch_share, patch_m;  // Share of the area, and usual height (m).
  bool shrubs_lead;             // Whether the option `density` is that of the shrubs.
};

constexpr Kind kKinds[] = {
    {"forest", {0.05, 10, 0.35, 3, 30, 0.35}, {0.02, 0.9, 0.5, 0.3, 2.8, 1}, 0.1, 0.6, false},
    {"savanna", {0.003, 6, 0.3, 3, 15, 0.7}, {0.015, 1, 0.5, 0.3, 2.8, 1.1}, 0.05, 0.5, false},
    {"meadow", {0.0003, 7, 0.3, 3, 15, 0.6}, {0.01, 0.6, 0.4, 0.25, 2.5, 1}, 0.5, 0.6, true},
};

constexpr double kCellOfRadius = 2.5;  // fewer look-ups, more distances

/// Finds places that keep apart from each other.
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
          const double dx = p.x() - x, dy = p.y() - y, apart = radius_m + p.z();
          if (std::max(std::abs(dx), std::abs(dy)) < apart && std::hypot(dx, dy) < apart)
            return false;
        }
      }
    }
    return true;
  }
  void add(double x, double y, double radius_m) {
    cells_[cell_of(x, y, cell_m_)].emplace_back(x, y, radius_m);
    largest_m_ = std::max(largest_m_, radius_m);
  }
  void forget_below(double y_m) {
    const int32_t least = cell_index(y_m - largest_m_, cell_m_) - 1;
    std::erase_if(cells_, [&](const auto& cell) { return cell.first.y < least; });
  }

 private:
  double cell_m_, largest_m_ = 0;
  CellMap<Cell2, std::vector<Vec3>> cells_;
};

Box box_of(double length_m, double width_m, double height_m) {
  return {Vec3(-0.5 * length_m, -0.5 * width_m, 0), Vec3(0.5 * length_m, 0.5 * width_m, height_m)};
}

double usual_radius_m(const Plants& p) { return 0.5 * p.width_of_height * p.median_m; }

Kind kind_of_options(const GenerateOptions& o) {
  require(o.density >= 0 && o.density <= 10, "generate: the density must lie in [0, 10] per m²");
  require(o.margin_m >= 0 && o.patch_cell_m > 0, "generate: lengths must be positive");
  for (Kind kind : kKinds) {
    if (o.kind != kind.name) continue;
    if (o.density > 0) (kind.shrubs_lead ? kind.shrubs : kind.trees).per_m2 = o.density;
    return kind;
  }
  throw std::invalid_argument("generate: no kind of site '" + o.kind + "'");
}

}  // namespace

struct SiteGenerator::Impl {
  Impl(const GenerateOptions& options, const Eigen::AlignedBox2d& site)
      : o(options),
        kind(kind_of_options(options)),
        inner(site),
        of_trees(std::max(2.0, kCellOfRadius * usual_radius_m(kind.trees))),
        of_shrubs(std::max(2.0, kCellOfRadius * usual_radius_m(kind.shrubs))) {
    inner.min().array() += options.margin_m;
    inner.max().array() -= options.margin_m;
  }

  void scatter(const GroundSurface& ground, const Eigen::AlignedBox2d& part, bool trees,
               uint64_t seed) {
    if (part.isEmpty()) return;
    const Plants& p = trees ? kind.trees : kind.shrubs;
    Spacing& spacing = trees ? of_trees : of_shrubs;
    Stream random(seed);
    const auto wanted = size_t(std::llround(p.per_m2 * part.volume()));
    // Where plants are denser than their crowns allow, crowns overlap.
    const double radius = usual_radius_m(p);
    const double crowding = p.per_m2 * 4 * radius * radius;
    const double keep = std::min(0.9, 0.7 / std::sqrt(std::max(crowding, 1e-9)));
    size_t standing = 0;
    for (size_t tries = 0; standing < wanted && tries < 30 * wanted; ++tries) {
      const double x = random.uniform(part.min().x(), part.max().x());
      const double y = random.uniform(part.min().y(), part.max().y());
      const Sized sized = draw_size(
          [&] {
            return std::clamp(p.median_m * std::exp(p.spread * random.normal()), p.low_m, p.high_m);
          },
          [&](double m) {
            return trees ? tree_class(SizeRules{}, m) : shrub_class(SizeRules{}, m, false);
          });
      const double height = sized.height_m;
      const double width = p.width_of_height * height * random.uniform(0.75, 1.25);
      const double slender = random.uniform(0.7, 1), yaw = random.uniform(-M_PI_2, M_PI_2);
      const double apart = 0.5 * keep * width;
      const std::optional<double> z = ground.at(x, y);
      if (!z || !spacing.free(x, y, apart)) continue;
      spacing.add(x, y, apart);
      ++standing;
      if (!count(sized)) continue;
      PlacedObject object;
      object.label = sized.label;
      object.position = Vec3(x, y, *z);
      object.yaw_rad = yaw;
      object.box = box_of(width, slender * width, height);
      drawn.objects.push_back(object);
    }
  }

  void patches(const GroundSurface& ground, const Eigen::AlignedBox2d& part, uint64_t number) {
    if (kind.patch_share <= 0 || part.isEmpty()) return;
    Stream random(mix64(o.seed + 3));
    std::array<Vec3, 8> waves;
    for (Vec3& w : waves) {
      const double azimuth = random.uniform(0, 2 * M_PI), k = 2 * M_PI / random.uniform(12, 50);
      w = Vec3(k * std::cos(azimuth), k * std::sin(azimuth), random.uniform(0, 2 * M_PI));
    }
    // The sum of many waves is normal, so the level that a given share of the area exceeds is
    // known.
    const double level = std::sqrt(0.5 * waves.size()) * normal_from_uniform(1 - kind.patch_share);
    const double side = o.patch_cell_m;
    if (number > 0) random = Stream(mix64(seed_of(number) + 3));
    // A cell is of the part in which its middle lies.
    const auto first = [&](int axis) {
      return std::max(int64_t(std::ceil(inner.min()[axis] / side)),
                      int64_t(std::ceil(part.min()[axis] / side - 0.5)));
    };
    const auto is_before_end = [&](int axis, int64_t k) {
      return double(k + 1) * side <= inner.max()[axis] &&
             (double(k) + 0.5) * side < part.max()[axis];
    };
    for (int64_t j = first(1); is_before_end(1, j); ++j) {
      for (int64_t i = first(0); is_before_end(0, i); ++i) {
        const double x = (double(i) + 0.5) * side, y = (double(j) + 0.5) * side;
        double sum = 0;
        for (const Vec3& w : waves) sum += std::cos(w.x() * x + w.y() * y + w.z());
        const auto height = [&] {
          return std::clamp(kind.patch_m * std::exp(0.3 * random.normal()), 0.2, 2.8);
        };
        if (sum < level) {
          height();  // The heights of the other cells do not depend on the share.
          continue;
        }
        const Sized sized =
            draw_size(height, [](double m) { return shrub_class(SizeRules{}, m, true); });
        const std::optional<double> z = ground.at(x, y);
        if (!z || !count(sized)) continue;
        PlacedObject cell;
        cell.label = sized.label;
        cell.position = Vec3(x, y, *z);
        cell.box = box_of(side, side, sized.height_m);
        drawn.objects.push_back(cell);
      }
    }
  }

  uint64_t seed_of(uint64_t number) const {
    return number == 0 ? o.seed : mix64(o.seed ^ mix64(number));
  }

  /// A height (m) with its class, and the class of the height that was drawn first.
  struct Sized {
    double height_m;
    Class label, first;
  };

  /// Draws heights until one has an allowed class.
  template <class Draw, class ClassOf>
  Sized draw_size(const Draw& draw, const ClassOf& class_of) const {
    Sized out{draw(), Class::kUnknown, Class::kUnknown};
    out.label = out.first = class_of(out.height_m);
    for (int k = 1; k < kDrawsOfHeight && !is_allowed(o.classes, out.label); ++k) {
      out.height_m = draw();
      out.label = class_of(out.height_m);
    }
    return out;
  }

  /// Counts an object that does not have the class that was drawn first, and returns whether it can
  /// stand.
  bool count(const Sized& sized) {
    const bool stands = is_allowed(o.classes, sized.label);
    if (!stands || sized.label != sized.first) {
      ++(stands ? drawn.replaced : drawn.left_out)[std::string(elements::name(sized.first))];
    }
    return stands;
  }

  GenerateOptions o;
  Kind kind;
  Eigen::AlignedBox2d inner;  // the site without its margin
  Spacing of_trees, of_shrubs;
  DrawnSite drawn;
};

SiteGenerator::SiteGenerator(const GenerateOptions& options, const Eigen::AlignedBox2d& site)
    : impl_(std::make_unique<Impl>(options, site)) {}
SiteGenerator::~SiteGenerator() = default;

DrawnSite SiteGenerator::objects(const GroundSurface& ground, const Eigen::AlignedBox2d& part,
                                 uint64_t number) {
  Impl& g = *impl_;
  const Eigen::AlignedBox2d inside = part.intersection(g.inner);
  const uint64_t seed = g.seed_of(number);
  g.scatter(ground, inside, true, mix64(seed + 1));
  g.scatter(ground, inside, false, mix64(seed + 2));
  g.patches(ground, inside, number);
  return std::exchange(g.drawn, {});
}

void SiteGenerator::forget_below(double y_m) {
  impl_->of_trees.forget_below(y_m);
  impl_->of_shrubs.forget_below(y_m);
}

elements::Model generated_ground(const Eigen::Vector2d& size_m, double spacing_m, uint64_t seed) {
  test_site::TerrainParameters p;
  p.size_x_m = size_m.x();
  p.size_y_m = size_m.y();
  elements::Model model;
  model.ground = test_site::Terrain(p, seed).mesh(spacing_m, 0);
  model.ground.range_sigma_m = kGroundNoiseM;
  model.fitter = "generated_ground";
  return model;
}

std::vector<std::string> site_kinds() {
  std::vector<std::string> names;
  for (const Kind& k : kKinds) names.emplace_back(k.name);
  return names;
}

DrawnSite generate_objects(const GroundSurface& ground, const GenerateOptions& o) {
  return SiteGenerator(o, ground.bounds()).objects(ground, ground.bounds(), 0);
}

}  // namespace underbrush::sites
