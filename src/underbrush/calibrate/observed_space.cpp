#include "underbrush/calibrate/observed_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "underbrush/calibrate/observed_map.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/trace/unknown_space.hpp"

namespace underbrush::calibrate {
namespace {

using elements::ObservedSpace;

constexpr double kStandsM = 3;        // the origins of a standing sensor lie within this
constexpr size_t kSamples = 1 << 18;  // beams that are followed through unknown space, about

/// The division of a log into two parts.
struct Parts {
  bool stands = true;
  uint32_t first_scan = 0, last_scan = 0;
  size_t beams = 0;

  size_t of(const BeamLog& log, size_t i) const {
    if (!stands) return log.scan[i] - first_scan > (last_scan - first_scan) / 2;
    const Vec3f& d = log.direction[i];
    return (d.x() > 0) == (d.y() > 0);
  }
};

template <class F>
void for_each_chunk(BeamSource& log, F use) {
  BeamLog chunk;
  log.rewind();
  while (log.next(chunk)) use(chunk);
}

/// Adds the beams of a log to pieces that begin as `fresh()`, on all threads, by `add(chunk, i,
/// row, piece)` for beam i of a chunk, which is row `row` of the log. `take` gets the pieces in
/// order.
template <class Fresh, class Add, class Take>
void for_each_piece(BeamSource& log, const Fresh& fresh, const Add& add, const Take& take) {
  constexpr size_t kBeamsOfPiece = 1 << 15;
  size_t first = 0;
  for_each_chunk(log, [&](const BeamLog& chunk) {
    const size_t pieces = (chunk.size() + kBeamsOfPiece - 1) / kBeamsOfPiece;
    std::vector<decltype(fresh())> made(pieces);
    parallel_in_order(
        pieces, 2 * size_t(threads()),
        [&](size_t k) {
          auto piece = fresh();
          const size_t end = std::min((k + 1) * kBeamsOfPiece, chunk.size());
          for (size_t i = k * kBeamsOfPiece; i < end; ++i) add(chunk, i, first + i, piece);
          made[k] = std::move(piece);
        },
        [&](size_t k) {
          take(made[k]);
          made[k] = {};
        });
    first += chunk.size();
  });
}

/// The vertices of the ground that lie in crossed cells of a map, or just below them.
std::vector<bool> known_ground(const ObservedSpace& space, const elements::Model& model) {
  std::vector<bool> keep(model.ground.vertices.size());
  const trace::CrossedCells crossed(space);
  for (size_t i = 0; i < keep.size(); ++i) {
    Cell3 cell = cell_of(Vec3(model.ground.vertices[i].cast<double>()), space.cell_m);
    keep[i] = crossed.holds(cell);
    ++cell.z;
    keep[i] = keep[i] || crossed.holds(cell);
  }
  return keep;
}

/// Whether a beam counts: returns of the vehicle do not.
bool counts(const BeamLog& log, size_t i, const ObservedSpaceOptions& options) {
  return !log.is_hit(i) || double(log.range_m[i]) >= options.min_range_m;
}

/// What the first pass over a log finds: its parts, and the heights (m) between which it has
/// returns. Nothing is known above and below them.
struct Extent {
  Parts parts;
  double bottom_m = HUGE_VAL, top_m = -HUGE_VAL;
};

Extent extent_of(BeamSource& log, const ObservedSpaceOptions& options) {
  Extent out;
  Parts& parts = out.parts;
  bool is_first = true;
  Vec3 low, high;
  for_each_chunk(log, [&](const BeamLog& chunk) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (is_first) {
        low = high = chunk.origin[i];
        parts.first_scan = parts.last_scan = chunk.scan[i];
        is_first = false;
      }
      low = low.cwiseMin(chunk.origin[i]);
      high = high.cwiseMax(chunk.origin[i]);
      parts.first_scan = std::min(parts.first_scan, chunk.scan[i]);
      parts.last_scan = std::max(parts.last_scan, chunk.scan[i]);
      if (!chunk.is_hit(i) || !counts(chunk, i, options)) continue;
      const double z = chunk.end_point(i).z();
      out.top_m = std::max(out.top_m, z);
      out.bottom_m = std::min(out.bottom_m, z);
    }
    parts.beams += chunk.size();
  });
  parts.stands = is_first || (high - low).norm() < kStandsM || parts.first_scan == parts.last_scan;
  return out;
}

/// How far beams without a return are followed.
double reach_of(const elements::Model& model, const LogInfo& log) {
  constexpr double kMost = 4000;  // m; a log whose range is without bounds has a bounded map
  return std::min({log.max_range_m, model.max_range_m, kMost});
}

/// The maps of the two parts of a log.
std::array<ObservedSpace, 2> maps_of(const elements::Model& model, BeamSource& log,
                                     const Extent& extent, const ObservedSpaceOptions& options) {
  using Maps = std::array<ObservedMap, 2>;
  const double reach = reach_of(model, log.info());
  const auto new_maps = [&] {
    return Maps{ObservedMap(options.cell_m), ObservedMap(options.cell_m)};
  };
  const auto add = [&](const BeamLog& chunk, size_t i, size_t, Maps& to) {
    if (!counts(chunk, i, options)) return;
    const Ray ray = chunk.ray(i);
    double end = chunk.is_hit(i) ? double(chunk.range_m[i]) : reach;
    const double rise = ray.direction.z();
    const double last = rise > 0 ? extent.top_m : extent.bottom_m;
    if (rise != 0) end = std::min(end, std::max(0.0, (last - ray.origin.z()) / rise));
    to[extent.parts.of(chunk, i)].add(ray.origin - model.origin, ray.direction, options.min_range_m,
                                      end);
  };
  Maps maps = new_maps();
  for_each_piece(log, new_maps, add, [&](const Maps& piece) {
    for (size_t part = 0; part < 2; ++part) maps[part].add(piece[part]);
  });
  return {maps[0].space(), maps[1].space()};
}

using Ranges = std::array<double, ObservedSpace::kRanges>;

/// The greatest heights above the ground of some returns, m, in descending order. The last one of
/// `kMost` is taken for the height of the highest matter, so that a few stray returns do not count.
struct GreatestHeights {
  static constexpr size_t kMost = 8;
  std::vector<double> height_m;

  void add(double height) {
    if (height_m.size() == kMost && !(height > height_m.back())) return;
    height_m.insert(std::upper_bound(height_m.begin(), height_m.end(), height, std::greater<>()),
                    height);
    if (height_m.size() > kMost) height_m.pop_back();
  }
};

/// What the ground returned of the beams of a log that came to it.
struct GroundReturns {
  std::array<std::vector<elements::LostBeams>, 2>
      lost;  ///< The lost beams of each part of the log.
  std::array<float, ObservedSpace::kRanges> share{};
  GreatestHeights greatest;

  /// The height of the highest matter; 0 without returns.
  double top_m() const { return greatest.height_m.empty() ? 0 : greatest.height_m.back(); }
};

/// Beams that end near the ground returned from it, and beams without a return that went below it
/// were lost there. Of n beams that were lost in one square only n/(1 + n) count, because a place
/// that returns nothing says little about other places.
GroundReturns ground_returns(const elements::Model& model, BeamSource& log, const Parts& parts,
                             const ObservedSpaceOptions& options) {
  constexpr double kPrior = 5;  // beams
  struct Lost {
    Cell2 at;
    size_t part, range;
  };
  struct Piece {
    std::vector<Lost> lost;
    Ranges returned{};  // whole numbers
    GreatestHeights greatest;
  };
  const trace::GroundHeights ground(model.ground, {});
  const trace::RangeLimits reach{options.min_range_m, reach_of(model, log.info())};
  const auto add = [&](const BeamLog& chunk, size_t i, size_t, Piece& to) {
    if (!counts(chunk, i, options)) return;
    Ray ray = chunk.ray(i);
    ray.origin -= model.origin;
    if (chunk.is_hit(i)) {
      const double range = chunk.range_m[i];
      const Vec3 end = ray.origin + range * ray.direction;
      const double height = end.z() - ground.at(end.x(), end.y());
      to.returned[ObservedSpace::range_interval(range)] += height < ObservedSpace::kGroundM;
      to.greatest.add(height);
    } else if (const auto at = ground.entry(ray, reach, options.cell_m)) {
      const Vec3 p = ray.origin + *at * ray.direction;
      to.lost.push_back({cell_of(p.x(), p.y(), ObservedSpace::kSquareM), parts.of(chunk, i),
                         ObservedSpace::range_interval(*at)});
    }
  };
  std::array<std::map<Cell2, uint32_t>, 2> beams;
  std::vector<Lost> lost;
  Ranges returned{}, gone{};
  GroundReturns out;
  for_each_piece(
      log, [] { return Piece(); }, add,
      [&](const Piece& piece) {
        for (const Lost& l : piece.lost) ++beams[l.part][l.at];
        lost.insert(lost.end(), piece.lost.begin(), piece.lost.end());
        for (size_t r = 0; r < returned.size(); ++r) returned[r] += piece.returned[r];
        for (const double height : piece.greatest.height_m) out.greatest.add(height);
      });
  for (const Lost& l : lost) {
    double n = 0;
    for (const auto& part : beams) n += part.contains(l.at) ? part.at(l.at) : 0;
    gone[l.range] += 1 / (1 + n);
  }
  for (size_t r = 0; r < ObservedSpace::kRanges; ++r) {
    out.share[r] = float((returned[r] + kPrior) / (returned[r] + gone[r] + kPrior));
  }
  for (size_t k = 0; k < 2; ++k) {
    for (const auto& [at, n] : beams[k]) out.lost[k].push_back({at, n});
  }
  return out;
}

/// Ends of beams in space that no beam crossed, and their path there, by height and range.
struct Counts {
  using Table = std::array<Ranges, ObservedSpace::kHeights>;
  Table ends{}, path_m{};
};

/// Follows the beams of each part of a log through what is unknown to the other one. A beam that
/// went below the ground without a return was lost, and its way near the ground is not counted.
Counts counts_of(const elements::Model& model, BeamSource& log, const Parts& parts,
                 const std::array<ObservedSpace, 2>& spaces, const ObservedSpaceOptions& options) {
  const std::vector<bool> keep[2]{known_ground(spaces[0], model), known_ground(spaces[1], model)};
  const trace::UnknownSpace unknown[2]{{spaces[0], model.ground, model.origin, keep[0]},
                                       {spaces[1], model.ground, model.origin, keep[1]}};
  const size_t every = std::max<size_t>(1, parts.beams / kSamples);
  const double reach = reach_of(model, log.info()), top_m = spaces[0].top_m;
  /// A step of a beam through unknown space.
  struct Step {
    size_t height, range;
    double way_m;
    bool is_end;
  };
  using Piece = std::vector<Step>;
  const auto add = [&](const BeamLog& chunk, size_t i, size_t row, Piece& to) {
    if (mix64(row) % every != 0 || !counts(chunk, i, options)) return;
    const bool is_hit = chunk.is_hit(i);
    const double end = is_hit ? double(chunk.range_m[i]) : reach;
    const trace::RangeLimits way{options.min_range_m, end + options.cell_m};
    const trace::UnknownSpace& other = unknown[1 - parts.of(chunk, i)];
    Ray in_model = chunk.ray(i);
    in_model.origin -= model.origin;
    const bool is_lost = !is_hit && other.ground().entry(in_model, way, options.cell_m).has_value();
    other.follow(chunk.ray(i), way, [&](const trace::UnknownSpace::Step& s) {
      if (s.from_m >= end) return false;
      if ((s.is_low() && is_lost) || s.height_m > top_m) return true;
      to.push_back({ObservedSpace::height_interval(s.height_m),
                    ObservedSpace::range_interval(0.5 * (s.from_m + s.to_m)),
                    s.way_m(std::min(s.to_m, end)), is_hit && end < s.to_m});
      return true;
    });
  };
  Counts out;
  for_each_piece(
      log, [] { return Piece(); }, add,
      [&](const Piece& piece) {
        for (const Step& s : piece) {
          out.path_m[s.height][s.range] += s.way_m;
          out.ends[s.height][s.range] += s.is_end;
        }
      });
  return out;
}

/// Estimates κ from counts.
void estimate_densities(const Counts& counts, ObservedSpace& space) {
  constexpr double kPrior = 5;  // beams
  for (size_t h = 0; h < ObservedSpace::kHeights; ++h) {
    double ends = 0, path = 0;
    for (size_t r = 0; r < ObservedSpace::kRanges; ++r) {
      ends += counts.ends[h][r];
      path += counts.path_m[h][r];
    }
    space.density_per_m[h].fill(0);
    if (!(ends > 0)) continue;
    const double of_height = ends / path;
    for (size_t r = 0; r < ObservedSpace::kRanges; ++r) {
      const double all_m = counts.path_m[h][r] + kPrior / of_height;
      space.density_per_m[h][r] = float((counts.ends[h][r] + kPrior) / all_m);
    }
  }
}

/// Lets unknown space end where the sensor of the log no longer reaches, because the log has no
/// returns from beyond.
void end_at_reach(double reach_m, ObservedSpace& space) {
  for (size_t r = 1; r < ObservedSpace::kRanges; ++r) {
    if (ObservedSpace::kRangesM[r - 1] < 0.98 * reach_m) continue;
    for (auto& row : space.density_per_m) row[r] = 0;
    space.ground_returns[r] = 0;
  }
}

}  // namespace

void learn_observed_space(elements::Model& model, BeamSource& log,
                          const ObservedSpaceOptions& options) {
  model.observed = nullptr;
  if (options.cell_m <= 0 || model.ground.vertices.empty()) return;
  const Extent extent = extent_of(log, options);
  const Parts& parts = extent.parts;
  std::array<ObservedSpace, 2> spaces = maps_of(model, log, extent, options);
  GroundReturns ground = ground_returns(model, log, parts, options);
  for (size_t k = 0; k < 2; ++k) {
    spaces[k].lost = std::move(ground.lost[k]);
    spaces[k].ground_returns = ground.share;
    spaces[k].top_m = ground.top_m();
  }
  // With any density in the highest interval, all heights are followed.
  for (ObservedSpace& s : spaces) s.density_per_m.back().fill(1);
  const Counts counts = counts_of(model, log, parts, spaces, options);
  auto space = std::make_shared<ObservedSpace>(std::move(spaces[0]));
  space->add(spaces[1]);
  estimate_densities(counts, *space);
  end_at_reach(model.max_range_m, *space);
  model.observed = std::move(space);
}

void update_observed_space(elements::Model& model, BeamSource& log, double min_range_m) {
  if (!model.observed) return;
  auto space = std::make_shared<ObservedSpace>(*model.observed);
  const ObservedSpaceOptions options{space->cell_m, min_range_m};
  Extent extent = extent_of(log, options);
  extent.parts = {};
  std::array<ObservedSpace, 2> maps = maps_of(model, log, extent, options);
  GroundReturns ground = ground_returns(model, log, extent.parts, options);
  for (size_t k = 0; k < 2; ++k) {
    maps[k].lost = std::move(ground.lost[k]);
    maps[k].top_m = ground.top_m();
    space->add(maps[k]);
  }
  model.observed = std::move(space);
}

}  // namespace underbrush::calibrate
