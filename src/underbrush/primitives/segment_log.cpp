#include "underbrush/primitives/segment_log.hpp"

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::primitives {
namespace {

/// Calls `f(k, point, range)` for hit k (m, world), chunk by chunk; `g(k)` after each chunk.
template <class F, class G>
void for_each_hit(BeamSource& source, const F& f, const G& g) {
  source.rewind();
  size_t k = 0;
  for (BeamLog chunk; source.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (chunk.is_hit(i)) f(k++, chunk.end_point(i), chunk.range_m[i]);
    }
    g(k);
  }
}

/// Ground heights where the smooth surface does not reach: means of squares, the nearest counting.
class CoarseGround {
 public:
  void add(const Vec3& p) {
    auto& [sum, n] = squares_[cell_of(p.x(), p.y(), kSideM)];
    sum += p.z(), ++n;
  }
  std::optional<double> at(double x, double y) const {
    const auto [i, j] = cell_of(x, y, kSideM);
    for (int ring = 0; ring <= kRings; ++ring) {
      double sum = 0;
      int n = 0;
      for (int b = -ring; b <= ring; ++b) {
        for (int a = -ring; a <= ring; ++a) {
          if (std::max(std::abs(a), std::abs(b)) != ring) continue;
          const auto found = squares_.find(Cell2{i + a, j + b});
          if (found == squares_.end()) continue;
          sum += found->second.first / double(found->second.second);
          ++n;
        }
      }
      if (n) return sum / n;
    }
    return std::nullopt;
  }

 private:
  static constexpr double kSideM = 5;
  static constexpr int kRings = 6;
  CellMap<Cell2, std::pair<double, size_t>> squares_;
};

using Tell = std::function<void(std::string_view stage, size_t done, size_t total)>;

/// Which hits are ground: as `prior` says, or as found.
std::vector<uint8_t> ground_of(BeamSource& source, const SegmentLogOptions& o,
                               const std::vector<Prior>& prior, const Tell& tell) {
  if (prior.empty()) {
    return ground::ground_flags(source, o.ground, o.tile_m,
                                [&](size_t done, size_t total) { tell("ground", done, total); });
  }
  std::vector<uint8_t> ground(prior.size());
  for (size_t k = 0; k < prior.size(); ++k) ground[k] = prior[k] == Prior::kGround;
  return ground;
}

/// Fits the heights to the ground's points; takes hits that are too near off the ground.
CoarseGround fit_heights(BeamSource& source, const SegmentLogOptions& o, const Vec3& origin,
                         const Tell& tell, LogLabels& out) {
  const size_t hits = out.ground.size();
  ground::HeightGrid grid(origin, o.height);
  CoarseGround coarse;
  std::vector<Vec3> points;
  size_t seen = 0;
  for_each_hit(
      source,
      [&](size_t k, const Vec3& p, float range_m) {
        seen = k + 1;
        if (k < hits && double(range_m) < o.min_range_m) {
          out.near += 1;
          out.ground[k] = 0;
        }
        if (k >= hits || !out.ground[k]) return;
        points.push_back(p);
        coarse.add(p);
      },
      [&](size_t k) {
        grid.add(points);
        points.clear();
        tell("height", k, hits);
      });
  require(seen == hits, "segment: as many labels as hits are needed");
  out.height = grid.solve();
  return coarse;
}

}  // namespace

LogLabels segment_log(BeamSource& source, const SegmentLogOptions& o,
                      const std::vector<Prior>& prior, const SegmentProgress& progress) {
  const auto tell = [&](std::string_view stage, size_t done, size_t total) {
    if (progress) progress(stage, done, total);
  };
  LogLabels out;
  ObjectFinder finder(o.objects);
  out.ground = ground_of(source, o, prior, tell);
  const size_t hits = out.ground.size();
  const Vec3 origin = log_origin(source).value_or(Vec3::Zero());
  const CoarseGround coarse = fit_heights(source, o, origin, tell, out);

  // x and y from the origin, z above the ground; nothing where no ground is within 30 m.
  const auto place = [&](const Vec3& p) {
    std::optional<double> z = out.height.at(p.x(), p.y());
    if (!z) z = coarse.at(p.x(), p.y());
    const Vec3 from = p - origin;
    return Vec3f(float(from.x()), float(from.y()), z ? float(p.z() - *z) : NAN);
  };
  const auto may_be_object = [&](size_t k, float range_m) {
    if (double(range_m) < o.min_range_m) return false;
    return prior.empty() ? !out.ground[k] : prior[k] == Prior::kObject;
  };
  std::vector<Vec3f> above;
  for_each_hit(
      source,
      [&](size_t k, const Vec3& p, float range_m) {
        if (may_be_object(k, range_m)) above.push_back(place(p));
      },
      [&](size_t k) {
        finder.add(above);
        above.clear();
        tell("objects", k, 2 * hits);
      });
  finder.find();
  out.objects = finder.objects();
  out.cell_m = finder.cell_m();
  out.object.assign(hits, 0);
  for_each_hit(
      source,
      [&](size_t k, const Vec3& p, float range_m) {
        if (!may_be_object(k, range_m)) return;
        const Vec3f at = place(p);
        out.off_ground += !at.allFinite();
        out.object[k] = finder.object_of(at);
      },
      [&](size_t k) { tell("objects", hits + k, 2 * hits); });
  return out;
}

}  // namespace underbrush::primitives
