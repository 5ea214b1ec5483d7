#include "underbrush/serve/selection.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::serve {
namespace {

using Overlap = ScreenShape::Overlap;

/// The nearest point in each square of the picture, by the bits of its depth, which are in the
/// order of positive numbers.
class NearestDepths {
 public:
  NearestDepths(const ScreenShape& shape, double limit_m)
      : low_(shape.low_px()), limit_m_(limit_m) {
    const Vec2 size = shape.high_px() - low_;
    columns_ = size_t(size.x() / kDepthCellPx) + 1;
    nearest_.assign(columns_ * (size_t(size.y() / kDepthCellPx) + 1),
                    std::bit_cast<uint64_t>(std::numeric_limits<double>::infinity()));
  }
  void add(const ScreenPoint& p) {
    std::atomic_ref<uint64_t> cell(nearest_[index(p)]);
    const uint64_t depth = std::bit_cast<uint64_t>(p.depth_m);
    for (uint64_t old = cell.load(); depth < old && !cell.compare_exchange_weak(old, depth);) {
    }
  }
  bool holds(const ScreenPoint& p) const {
    return p.depth_m <= std::bit_cast<double>(nearest_[index(p)]) + limit_m_;
  }

 private:
  size_t index(const ScreenPoint& p) const {
    const size_t column = size_t((p.x - low_.x()) / kDepthCellPx);
    return size_t((p.y - low_.y()) / kDepthCellPx) * columns_ + column;
  }
  Vec2 low_;
  double limit_m_;
  size_t columns_ = 1;
  std::vector<uint64_t> nearest_;
};

Overlap least(Overlap a, Overlap b) { return Overlap(std::min(int(a), int(b))); }

/// The conditions of place.
class Place {
 public:
  explicit Place(const Selection& s) : box_(s.box), slab_(s.slab) {
    if (s.drawn) shape_.emplace(*s.drawn);
    if (s.drawn && s.depth_m > 0) depths_.emplace(*shape_, s.depth_m);
    if (box_) {
      require(box_->centre.allFinite() && box_->size.allFinite() && std::isfinite(box_->yaw_rad) &&
                  box_->size.minCoeff() > 0,
              "a box without size");
      turn_ = Eigen::AngleAxisd(-box_->yaw_rad, Vec3::UnitZ()).toRotationMatrix();
    }
    if (slab_)
      require(slab_->normal.allFinite() && slab_->from <= slab_->to, "a slab without width");
  }
  bool by_depth() const { return depths_.has_value(); }
  bool anywhere() const { return !shape_ && !box_ && !slab_; }

  Overlap overlap(const Vec3& low, double side) const {
    Overlap all = Overlap::kWhole;
    if (shape_) all = shape_->overlap(low, side);
    const Vec3 middle = low + Vec3::Constant(side / 2);
    const double reach = side * std::sqrt(0.75) * (1 + 1e-9);
    if (box_) {
      const Vec3 off = (turn_ * (middle - box_->centre)).cwiseAbs() - box_->size / 2;
      all = least(all, off.maxCoeff() > reach    ? Overlap::kNone
                       : off.maxCoeff() < -reach ? Overlap::kWhole
                                                 : Overlap::kSome);
    }
    if (slab_) {
      const double d = slab_->normal.dot(middle), r = reach * slab_->normal.norm();
      all = least(all, d + r < slab_->from || d - r > slab_->to   ? Overlap::kNone
                       : d - r > slab_->from && d + r < slab_->to ? Overlap::kWhole
                                                                  : Overlap::kSome);
    }
    return all;
  }
  bool in_space(const Vec3& point) const {
    if (box_) {
      const Vec3 off = (turn_ * (point - box_->centre)).cwiseAbs() - box_->size / 2;
      if (off.maxCoeff() > 0) return false;
    }
    if (!slab_) return true;
    const double d = slab_->normal.dot(point);
    return d >= slab_->from && d <= slab_->to;
  }
  /// Whether a point is meant; `add_depth` notes it instead of asking whether it is near enough.
  bool contains(const Vec3& point, bool add_depth) {
    if (!in_space(point)) return false;
    if (!shape_) return true;
    const ScreenPoint p = shape_->project(point);
    if (!shape_->contains(p)) return false;
    if (!depths_) return true;
    if (!add_depth) return depths_->holds(p);
    depths_->add(p);
    return false;
  }

 private:
  std::optional<ScreenShape> shape_;
  std::optional<TurnedBox> box_;
  std::optional<Slab> slab_;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  std::optional<NearestDepths> depths_;
};

struct Candidate {
  uint32_t node = 0;
  bool whole = false;
};

double side_of(const NodeCubes& cubes, const OctreeNode& node) {
  return std::ldexp(cubes.side_m, -int(node.level));
}

// The nodes that may hold points that are meant, and of which it is certain that all are.
std::vector<Candidate> candidates(const OctreeFile& file, const NodeCubes& cubes,
                                  const Place& place) {
  std::vector<Candidate> out;
  std::vector<Candidate> open{{0, place.anywhere()}};
  while (!open.empty()) {
    Candidate c = open.back();
    open.pop_back();
    const OctreeNode& node = file.nodes()[c.node];
    if (!c.whole) {
      const Overlap overlap = place.overlap(cubes.low[c.node], side_of(cubes, node));
      if (overlap == Overlap::kNone) continue;
      c.whole = overlap == Overlap::kWhole;
    }
    out.push_back(c);
    const int children = std::popcount(node.children);
    for (int k = 0; k < children; ++k) open.push_back({node.first_child + uint32_t(k), c.whole});
  }
  return out;
}

/// The columns of a node that a question needs.
class NodePoints {
 public:
  NodePoints(const OctreeFile& file, const OctreeNode& node, bool places, bool times) {
    row.resize(node.points);
    file.read(node.at + 20ull * node.points, row.data(), 4 * row.size());
    if (places) {
      position.resize(node.points);
      file.read(node.at, static_cast<void*>(position.data()), 12 * position.size());
    }
    if (times) {
      time_s.resize(node.points);
      file.read(node.at + 16ull * node.points, time_s.data(), 4 * time_s.size());
    }
  }
  std::vector<uint32_t> row;
  std::vector<Vec3f> position;
  std::vector<float> time_s;
};

/// The rows of a scan, as ranges in ascending order.
std::vector<std::pair<uint64_t, uint64_t>> rows_of_scan(const OctreeFile& file, uint32_t scan) {
  std::vector<std::pair<uint64_t, uint64_t>> out;
  for (const OctreeRun& run : file.runs()) {
    if (run.scan == scan) out.emplace_back(run.first_row, run.first_row + run.rows);
  }
  return out;
}

bool in_ranges(const std::vector<std::pair<uint64_t, uint64_t>>& ranges, uint64_t row) {
  const auto next = std::upper_bound(ranges.begin(), ranges.end(), std::pair(row, UINT64_MAX));
  return next != ranges.begin() && row < std::prev(next)->second;
}

}  // namespace

bool Selection::admits(LabelValue value) const {
  if (hidden[value.label] || locked[value.label]) return false;
  if (label && value.label != *label) return false;
  if (instance && value.instance != *instance) return false;
  return !selected || value.selected;
}

void RowSet::add(uint32_t row) {
  std::atomic_ref<uint64_t>(words_[row / 64])
      .fetch_or(uint64_t(1) << (row % 64), std::memory_order_relaxed);
}

NodeCubes::NodeCubes(const OctreeFile& file) : low(file.nodes().size()) {
  const auto j = nlohmann::json::parse(file.json());
  for (int c = 0; c < 3; ++c) {
    origin[c] = j.at("origin_m").at(size_t(c));
    low[0][c] = j.at("root_low_m").at(size_t(c));
  }
  rows = j.at("rows");
  side_m = j.at("root_side_m");
  for (uint32_t k = 0; k < file.nodes().size(); ++k) {
    const OctreeNode& node = file.nodes()[k];
    const double half = side_of(*this, node) / 2;
    uint32_t child = node.first_child;
    for (uint32_t c = 0; c < 8; ++c) {
      if (node.children >> c & 1) low[child++] = low[k] + half * Vec3(c & 1, c >> 1 & 1, c >> 2);
    }
  }
}

FoundRows find_rows(const OctreeFile& file, const NodeCubes& cubes, const Selection& selection,
                    const std::vector<uint32_t>& values) {
  require(values.size() == cubes.rows, "labels for another number of rows");
  Place place(selection);
  const std::vector<Candidate> nodes = candidates(file, cubes, place);
  const auto scan =
      selection.scan ? rows_of_scan(file, *selection.scan) : decltype(rows_of_scan(file, 0)){};
  const auto& times = selection.times_s;
  const bool hides =
      std::find(selection.hidden.begin(), selection.hidden.end(), true) != selection.hidden.end();
  FoundRows out{RowSet(cubes.rows), {}};
  std::vector<uint8_t> touched(nodes.size());
  const auto pass = [&](bool add_depth) {
    parallel_for(nodes.size(), 16, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const OctreeNode& node = file.nodes()[nodes[k].node];
        const bool by_place = !nodes[k].whole || place.by_depth();
        const NodePoints points(file, node, by_place, times.has_value());
        const Vec3& low = cubes.low[nodes[k].node];
        for (size_t i = 0; i < points.row.size(); ++i) {
          const uint32_t row = points.row[i];
          if (row >= cubes.rows) continue;
          if (times && !(points.time_s[i] >= times->first && points.time_s[i] <= times->second))
            continue;
          if (selection.scan && !in_ranges(scan, row)) continue;
          if (add_depth && hides && selection.hidden[LabelValue::of(values[row]).label]) continue;
          if (by_place && !place.contains(low + points.position[i].cast<double>(), add_depth))
            continue;
          out.rows.add(row);
          touched[k] = 1;
        }
      }
    });
  };
  if (place.by_depth()) pass(true);
  pass(false);
  for (size_t k = 0; k < nodes.size(); ++k) {
    if (touched[k]) out.nodes.push_back(nodes[k].node);
  }
  std::sort(out.nodes.begin(), out.nodes.end());
  return out;
}

LabelChange change_of(const FoundRows& found, const Selection& selection, const LabelAction& action,
                      const std::vector<uint32_t>& values) {
  LabelChange out;
  out.nodes = found.nodes;
  out.everywhere = action.only;
  std::pair<uint32_t, uint32_t> key{};
  RowRuns* runs = nullptr;  // those of `key`
  const auto& words = found.rows.words();
  for (size_t w = 0; w < words.size(); ++w) {
    if (words[w] == 0 && !action.only) continue;
    const uint32_t end = uint32_t(std::min<uint64_t>(64 * (w + 1), values.size()));
    for (uint32_t row = uint32_t(64 * w); row < end; ++row) {
      LabelValue value = LabelValue::of(values[row]);
      if (found.rows.has(row) && selection.admits(value)) {
        if (action.label) value.label = *action.label;
        if (action.instance) value.instance = *action.instance;
        if (action.selected) value.selected = *action.selected;
      } else if (action.only) {
        value.selected = false;
      }
      const std::pair wanted(values[row], value.bits());
      if (wanted.first == wanted.second) continue;
      if (!runs || wanted != key) runs = &out.rows[key = wanted];
      runs->add(row);
    }
  }
  return out;
}

}  // namespace underbrush::serve
