#include "underbrush/primitives/box_beams.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::primitives {
namespace {

constexpr double kCellM = 4;
// Boxes are rounded to the millimetre, as their points are not.
constexpr double kRoundingM = 2e-3;
constexpr size_t kBlock = 1024;  // beams

/// The stretch [from_m, to_m] of a beam.
struct Stretch {
  double from_m, to_m;

  /// Cuts the stretch to where a coordinate that is `at` at the beam's origin and grows by `slope`
  /// lies in [low, high].
  void cut(double at, double slope, double low, double high) {
    if (slope == 0) {
      if (at < low || at > high) to_m = -1;
      return;
    }
    const double a = (low - at) / slope, b = (high - at) / slope;
    from_m = std::max(from_m, std::min(a, b));
    to_m = std::min(to_m, std::max(a, b));
  }
  bool empty() const { return !(to_m > from_m); }
};

struct ObjectBox {
  Mat3 turn;    ///< Object from world.
  Vec3 origin;  ///< World.
  Box box;
  uint32_t instance;
};

/// A part of the sums: what one beam does in a third of a box.
struct Part {
  uint32_t object;
  uint8_t third;
  bool is_return;
  double path_m;
};

class Boxes {
 public:
  explicit Boxes(const std::vector<PlacedObject>& objects) {
    for (uint32_t k = 0; k < objects.size(); ++k) {
      const PlacedObject& o = objects[k];
      const Vec3 beside = Vec3::Constant(kRoundingM);
      const Box box{o.box.min - beside, o.box.max + beside};
      const Pose pose = o.world_from_object();
      boxes_.push_back({pose.rotation.toRotationMatrix().transpose(), o.position, box, o.instance});
      Eigen::AlignedBox3d square;
      for (int c = 0; c < 8; ++c) {
        square.extend(pose * Vec3(c & 1 ? box.min.x() : box.max.x(),
                                  c & 2 ? box.min.y() : box.max.y(),
                                  c & 4 ? box.min.z() : box.max.z()));
      }
      bounds_.extend(square);
      const Cell2 low = cell_of(square.min().x(), square.min().y(), kCellM);
      const Cell2 high = cell_of(square.max().x(), square.max().y(), kCellM);
      for (Cell2 c = low; c.y <= high.y; ++c.y) {
        for (c.x = low.x; c.x <= high.x; ++c.x) cells_[c].push_back(k);
      }
    }
  }

  /// Adds what beam i does in the boxes.
  void add(const BeamLog& log, const ExtraColumn& instance, size_t i,
           std::vector<Part>& out) const {
    const Vec3& o = log.origin[i];
    const Vec3 d = log.direction[i].cast<double>();
    const double end_m = log.is_hit(i) ? double(log.range_m[i]) : log.info.max_range_m;
    Stretch within{0, end_m};
    for (int k = 0; k < 3; ++k) within.cut(o[k], d[k], bounds_.min()[k], bounds_.max()[k]);
    if (within.empty()) return;
    const uint32_t ends_at = log.is_hit(i) ? whole_number(instance, i) : 0;
    // The cells along the beam, seen from above.
    const Vec3 start = o + within.from_m * d;
    Cell2 cell = cell_of(start.x(), start.y(), kCellM);
    for (double from_m = within.from_m; from_m < within.to_m;) {
      const auto leaves_m = [&](int axis, int32_t at) {
        if (d[axis] == 0) return within.to_m;
        return ((at + (d[axis] > 0)) * kCellM - o[axis]) / d[axis];
      };
      const double x_m = leaves_m(0, cell.x), y_m = leaves_m(1, cell.y);
      const Stretch step{from_m, std::min({x_m, y_m, within.to_m})};
      if (const auto found = cells_.find(cell); found != cells_.end() && !step.empty()) {
        for (const uint32_t k : found->second) cross(k, o, d, step, end_m, ends_at, out);
      }
      from_m = std::max(from_m, step.to_m);
      if (x_m < y_m) {
        cell.x += d.x() > 0 ? 1 : -1;
      } else {
        cell.y += d.y() > 0 ? 1 : -1;
      }
    }
  }

 private:
  void cross(uint32_t k, const Vec3& origin, const Vec3& direction, Stretch s, double end_m,
             uint32_t ends_at, std::vector<Part>& out) const {
    const ObjectBox& b = boxes_[k];
    const Vec3 p = b.turn * (origin - b.origin), d = b.turn * direction;
    for (int a = 0; a < 3; ++a) s.cut(p[a], d[a], b.box.min[a], b.box.max[a]);
    if (s.empty()) return;
    const double third_m = b.box.size().z() / 3;
    for (uint8_t t = 0; t < 3; ++t) {
      Stretch part = s;
      const double low = b.box.min.z() + t * third_m;
      part.cut(p.z(), d.z(), low, low + third_m);
      if (part.empty()) continue;
      const bool is_return = ends_at != 0 && ends_at == b.instance && part.to_m == end_m;
      out.push_back({k, t, is_return, part.to_m - part.from_m});
    }
  }

  std::vector<ObjectBox> boxes_;
  Eigen::AlignedBox3d bounds_;
  CellMap<Cell2, std::vector<uint32_t>> cells_;
};

}  // namespace

void measure_beams(BeamSource& labelled, std::vector<PlacedObject>& objects) {
  if (objects.empty() || !labelled.info().has_misses) return;
  const Boxes boxes(objects);
  labelled.rewind();
  for (BeamLog chunk; labelled.next(chunk);) {
    const ExtraColumn& instance = chunk.extra.at("instance");
    const size_t blocks = (chunk.size() + kBlock - 1) / kBlock;
    std::vector<std::vector<Part>> parts(blocks);
    const auto work = [&](size_t k) {
      const size_t end = std::min(chunk.size(), (k + 1) * kBlock);
      for (size_t i = k * kBlock; i < end; ++i) boxes.add(chunk, instance, i, parts[k]);
    };
    const auto finish = [&](size_t k) {
      for (const Part& p : parts[k]) {
        BoxBeams& b = objects[p.object].beams;
        b.path_m[p.third] += p.path_m;
        b.returns[p.third] += p.is_return;
      }
      parts[k] = std::vector<Part>();  // frees the memory
    };
    parallel_in_order(blocks, 32, work, finish);
  }
  for (PlacedObject& o : objects) {  // to the millimetre, as files keep it
    for (double& path_m : o.beams.path_m) path_m = std::round(path_m * 1000) / 1000;
  }
}

}  // namespace underbrush::primitives
