#include "underbrush/sites/like_site.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/sites/distances.hpp"

namespace underbrush::sites {
namespace {

using elements::Class;
using primitives::PlacedObject;

constexpr double kComparedSpacingM = 1;
constexpr size_t kLeastPieces = 10;

std::vector<Statistic> all_statistics(const Window& window, std::span<const PlacedObject> objects,
                                      const primitives::GroundSurface& ground) {
  std::vector<Statistic> out = statistics_of(window, objects);
  for (Statistic& s : statistics_of(ground)) out.push_back(std::move(s));
  return out;
}

std::vector<MarkedPoint> points_of(std::span<const Piece> pieces) {
  std::vector<MarkedPoint> out;
  out.reserve(pieces.size());
  for (const Piece& p : pieces) out.push_back({p.at, p.label, p.radius_m});
  return out;
}

/// Draws a site.
class Drawing {
 public:
  Drawing(const SiteModel& model, const primitives::GroundSurface& ground, Window window,
          const DrawOptions& options)
      : model_(model),
        ground_(ground),
        window_(std::move(window)),
        options_(options),
        random_(mix64(options.seed + 1)) {
    for (uint32_t k = 0; k < model.pieces.size(); ++k) {
      by_class_[model.pieces[k].label].push_back(k);
    }
  }

  DrawnSite draw() && {
    std::vector<uint32_t> chosen;
    for (const auto& [label, pieces] : by_class_) choose(label, pieces, chosen);
    for (const uint32_t k : chosen) {
      if (model_.pieces[k].is_cells) wanted_cells_ += model_.pieces[k].parts.size();
    }
    place(chosen);
    fill();
    out_.missing_cells = wanted_cells_ - cells_.size();
    return std::move(out_);
  }

 private:
  bool is_allowed(Class label) const { return sites::is_allowed(options_.classes, label); }

  /// Chooses the pieces of a class.
  void choose(Class label, const std::vector<uint32_t>& own, std::vector<uint32_t>& chosen) {
    const double expected = double(own.size()) * window_.area_m2() / model_.window.area_m2();
    const auto wanted = size_t(expected + random_.uniform());
    const std::vector<uint32_t> from = is_allowed(label) ? own : others_of_kind(label);
    if (!is_allowed(label) && wanted > 0) {
      (from.empty() ? out_.left_out : out_.replaced)[std::string(elements::name(label))] += wanted;
    }
    if (from.empty()) return;
    for (size_t k = 0; k < wanted; ++k) chosen.push_back(from[random_.below(from.size())]);
  }

  std::vector<uint32_t> others_of_kind(Class label) const {
    std::vector<uint32_t> out;
    for (const auto& [other, pieces] : by_class_) {
      if (elements::kind_of(other) != elements::kind_of(label) || !is_allowed(other)) continue;
      out.insert(out.end(), pieces.begin(), pieces.end());
    }
    return out;
  }

  void place(const std::vector<uint32_t>& chosen) {
    std::vector<MarkedPoint> points;
    points.reserve(chosen.size());
    for (const uint32_t k : chosen) {
      points.push_back({{}, model_.pieces[k].label, model_.pieces[k].radius_m});
    }
    draw_places(model_.process, window_, points, mix64(options_.seed + 2));
    for (size_t k = 0; k < chosen.size(); ++k) add(model_.pieces[chosen[k]], points[k].at);
  }

  /// Adds pieces of patches anywhere, until as many cells stand as are wanted.
  void fill() {
    std::vector<uint32_t> patches;
    for (uint32_t k = 0; k < model_.pieces.size(); ++k) {
      if (model_.pieces[k].is_cells && is_allowed(model_.pieces[k].label)) patches.push_back(k);
    }
    if (patches.empty()) return;
    for (size_t k = 0; k < wanted_cells_ && cells_.size() < wanted_cells_; ++k) {
      add(model_.pieces[patches[random_.below(patches.size())]], window_.draw(random_));
    }
  }

  void add(const Piece& piece, const Eigen::Vector2d& at) {
    const double turn = random_.uniform(-M_PI, M_PI);
    for (PlacedObject& o : objects_of(piece, at, turn, model_.cell_m)) {
      const std::optional<double> z = ground_.at(o.position.x(), o.position.y());
      if (piece.is_cells && !take_cell(o, z.has_value())) continue;
      if (!z) {
        ++out_.off_ground;
        continue;
      }
      o.position.z() = *z;
      if (!is_allowed(o.label)) o.label = piece.label;
      out_.objects.push_back(std::move(o));
    }
  }

  /// Takes the place of a cell of a patch, and returns whether there was room for it.
  bool take_cell(const PlacedObject& o, bool on_ground) {
    if (!on_ground || cells_.size() >= wanted_cells_) return false;
    return cells_.emplace(cell_of(o.position.x(), o.position.y(), model_.cell_m), true).second;
  }

  const SiteModel& model_;
  const primitives::GroundSurface& ground_;
  Window window_;
  DrawOptions options_;
  Stream random_;
  std::map<Class, std::vector<uint32_t>> by_class_;
  CellMap<Cell2, bool> cells_;
  size_t wanted_cells_ = 0;
  DrawnSite out_;
};

}  // namespace

SiteModel fit_site(const primitives::GroundSurface& ground, std::span<const PlacedObject> objects,
                   double cell_m, uint64_t seed) {
  SiteModel out{Window(ground), pieces_of(objects, cell_m), {}, cell_m};
  const auto leave_out = [&] {
    std::erase_if(out.pieces, [&](const Piece& p) { return !out.window.contains(p.at); });
    require_data(out.pieces.size() >= kLeastPieces, "fewer than 10 objects stand on the ground");
  };
  leave_out();
  std::vector<Eigen::Vector2d> at;
  for (const Piece& p : out.pieces) at.push_back(p.at);
  out.window.keep_around(at);
  leave_out();
  out.process = fit_process(out.window, points_of(out.pieces), seed);
  return out;
}

DrawnSite draw_site(const SiteModel& model, const primitives::GroundSurface& ground,
                    const DrawOptions& options) {
  Window window(ground, options.margin_m);
  if (window.is_empty()) return {};
  return Drawing(model, ground, std::move(window), options).draw();
}

elements::Model ground_like(const elements::Model& site, const Eigen::Vector2d& size_m,
                            double spacing_m, uint64_t seed) {
  elements::Model out = site.like();
  out.origin = Vec3::Zero();
  out.observed = nullptr;  // Space that was observed elsewhere.
  const GroundSpectrum spectrum = spectrum_of(structure_of(primitives::GroundSurface(site)));
  const double sigma_m = out.ground.range_sigma_m;
  out.ground = ground_with(spectrum, size_m, spacing_m, seed);
  out.ground.range_sigma_m = sigma_m;
  double p = 0, roughness_m = 0;
  for (size_t k = 0; k < site.ground.size(); ++k) {
    p += double(site.ground.hit[k].p);
    roughness_m += site.ground.roughness_at(k);
  }
  for (elements::HitCount& hit : out.ground.hit) hit.p = float(p / double(site.ground.size()));
  out.ground.roughness_m = roughness_m / double(site.ground.size());
  out.fitter = "ground_like";
  return out;
}

std::vector<ComparedStatistic> compare_with_draws(const SiteModel& model,
                                                  const elements::Model& ground,
                                                  std::span<const PlacedObject> objects,
                                                  size_t draws, uint64_t seed) {
  const primitives::GroundSurface surface(ground);
  std::vector<std::vector<Statistic>> drawn(draws);
  parallel_for(draws, 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      DrawOptions options;
      options.seed = mix64(seed + k);
      const DrawnSite site = Drawing(model, surface, model.window, options).draw();
      const elements::Model like =
          ground_like(ground, surface.bounds().sizes(), kComparedSpacingM, options.seed);
      drawn[k] = all_statistics(model.window, site.objects, primitives::GroundSurface(like));
    }
  });
  std::vector<ComparedStatistic> out;
  for (const Statistic& s : all_statistics(model.window, objects, surface)) {
    std::vector<double> values;
    for (const auto& one : drawn) {
      if (std::isfinite(one[out.size()].value)) values.push_back(one[out.size()].value);
    }
    const double reach = 1.96 * deviation_of(values), mean = mean_of(values);
    out.push_back({s, mean, mean - reach, mean + reach});
  }
  return out;
}

}  // namespace underbrush::sites
