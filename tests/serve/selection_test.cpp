// Selections: the octree finds exactly the points that a test of each single point finds.
#include "underbrush/serve/selection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "io/temporary.hpp"
#include "serve/hills.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::serve {
namespace {

/// A camera's matrix, as three.js makes it.
Eigen::Matrix4d camera(const Vec3& eye, const Vec3& target, double aspect) {
  const Vec3 back = (eye - target).normalized(), right = Vec3::UnitZ().cross(back).normalized();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.block<1, 3>(0, 0) = right.transpose();
  view.block<1, 3>(1, 0) = back.cross(right).transpose();
  view.block<1, 3>(2, 0) = back.transpose();
  view.block<3, 1>(0, 3) = -view.block<3, 3>(0, 0) * eye;
  const double f = 1 / std::tan(M_PI / 6), near = 0.1, far = 1000;
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = f / aspect;
  projection(1, 1) = f;
  projection(2, 2) = (far + near) / (near - far);
  projection(2, 3) = 2 * far * near / (near - far);
  projection(3, 2) = -1;
  return projection * view;
}

class Selections : public testing::Test {
 protected:
  Selections() : log_(hills(120000, 80)) {
    MemorySource source(log_, 30000);
    build_octree(source, folder_ / "tree");
    file_ = std::make_unique<OctreeFile>(folder_ / "tree");
    cubes_ = std::make_unique<NodeCubes>(*file_);
    values_.assign(log_.size(), 0);
    Stream random(31);
    for (size_t i = 0; i < log_.size(); ++i) {
      if (log_.is_hit(i)) values_[i] = LabelValue{uint32_t(random.below(5)), 0, false}.bits();
    }
  }
  /// A place of the hills, relative to the octree's origin.
  Vec3 at(double x, double y, double z) const {
    return Vec3(1000 + x, -2000 + y, z) - cubes_->origin;
  }
  Vec3 local(size_t i) const { return log_.end_point(i) - cubes_->origin; }

  /// Compares with the slow way; points closer than `px` to where the answer changes may differ.
  size_t compare(
      const Selection& s, const std::function<bool(size_t)>& inside,
      const std::function<bool(size_t)>& doubtful = [](size_t) { return false; }) {
    const FoundRows found = find_rows(*file_, *cubes_, s, values_);
    size_t n = 0;
    for (uint32_t i = 0; i < log_.size(); ++i) {
      const bool wanted = log_.is_hit(i) && inside(i);
      n += wanted;
      if (!doubtful(i)) {
        EXPECT_EQ(found.rows.has(i), wanted) << "row " << i;
      }
    }
    return n;
  }

  io::TemporaryFolder folder_;
  BeamLog log_;
  std::unique_ptr<OctreeFile> file_;
  std::unique_ptr<NodeCubes> cubes_;
  std::vector<uint32_t> values_;
};

bool in_polygon(const std::vector<Vec2>& path, double x, double y) {
  double turns = 0;  // winding by angles, of a simple polygon
  for (size_t k = 0; k < path.size(); ++k) {
    const Vec2 a = path[k] - Vec2(x, y), b = path[(k + 1) % path.size()] - Vec2(x, y);
    turns += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return std::abs(turns) > M_PI;
}

double distance(const std::vector<Vec2>& path, bool closed, const Vec2& p) {
  double nearest = (p - path[0]).norm();
  for (size_t k = 0; k + (closed ? 0 : 1) < path.size(); ++k) {
    const Vec2& a = path[k];
    const Vec2 ab = path[(k + 1) % path.size()] - a;
    const double t = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-12), 0.0, 1.0);
    nearest = std::min(nearest, (p - a - t * ab).norm());
  }
  return nearest;
}

/// A simple polygon around the middle of the picture, or a wandering path.
std::vector<Vec2> random_path(Stream& random, bool polygon) {
  std::vector<Vec2> path;
  const double cx = random.uniform(200, 700), cy = random.uniform(100, 400);
  for (int k = 0; k < 24; ++k) {
    const double angle = 2 * M_PI * k / 24, r = random.uniform(40, 260);
    path.push_back(polygon ? Vec2(cx + r * std::cos(angle), cy + r * std::sin(angle))
                           : Vec2(cx + 9 * k, cy + random.uniform(-30, 30)));
  }
  return path;
}

TEST_F(Selections, DrawnShapesFindWhatEachPointSays) {
  Stream random(21);  // seed 21
  for (int k = 0; k < 12; ++k) {
    const bool polygon = k % 2 == 0;
    DrawnShape shape;
    const double x = random.uniform(-20, 100), y = random.uniform(-20, 100);
    const Vec3 eye = at(x, y, random.uniform(4, 60));
    shape.clip_from_point = camera(eye, at(40, 40, 0), 900.0 / 500);
    shape.width_px = 900;
    shape.height_px = 500;
    shape.path_px = random_path(random, polygon);
    shape.radius_px = polygon ? 0 : random.uniform(5, 60);
    Selection s;
    s.drawn = shape;
    const auto on_screen = [&](size_t i) -> std::optional<Vec2> {
      const Eigen::Vector4d c = shape.clip_from_point * local(i).homogeneous();
      if (c.w() <= 0) return std::nullopt;
      return Vec2((c.x() / c.w() + 1) * 450, (1 - c.y() / c.w()) * 250);
    };
    const size_t n = compare(
        s,
        [&](size_t i) {
          const auto p = on_screen(i);
          if (!p) return false;
          return polygon ? in_polygon(shape.path_px, p->x(), p->y())
                         : distance(shape.path_px, false, *p) <= shape.radius_px;
        },
        [&](size_t i) {  // the octree has places to 2e-5 m, which near the camera are some pixels
          const auto p = on_screen(i);
          if (!p) return false;
          return std::abs(distance(shape.path_px, polygon, *p) - shape.radius_px) < 0.1;
        });
    EXPECT_GT(n, 50u) << k;
  }
}

TEST_F(Selections, BoxesSlabsTimesAndScans) {
  Selection box;
  box.box = TurnedBox{at(30, 50, 2), Vec3(25, 10, 6), 0.7};
  const Eigen::Rotation2Dd turn(-0.7);
  const auto in_box = [&](size_t i) {
    const Vec3 off = local(i) - box.box->centre;
    const Vec2 flat = turn * Vec2(off.x(), off.y());
    return std::abs(flat.x()) <= 12.5 && std::abs(flat.y()) <= 5 && std::abs(off.z()) <= 3;
  };
  EXPECT_GT(compare(box, in_box), 1000u);
  Selection slab;
  const double start = at(30, 30, 0).dot(Vec3(1, 1, 0));
  slab.slab = Slab{Vec3(1, 1, 0), start, start + 15};
  EXPECT_GT(compare(slab,
                    [&](size_t i) {
                      const double d = local(i).x() + local(i).y();
                      return d >= start && d <= start + 15;
                    }),
            1000u);
  Selection times = box;
  times.times_s = std::pair(0.2, 0.7);
  times.scan = 9;
  EXPECT_GT(compare(times,
                    [&](size_t i) {
                      const double t = double(float(log_.time_s[i] - log_.time_s[0]));
                      return in_box(i) && t >= 0.2 && t <= 0.7 && log_.scan[i] == 9;
                    }),
            10u);
  EXPECT_EQ(compare({}, [](size_t) { return true; }), 108000u);
}

TEST_F(Selections, TheDepthLimitLeavesOutWhatIsHidden) {
  // From above, the ground under a pole is farther than the pole's top.
  DrawnShape shape;
  shape.clip_from_point = camera(at(40, 39.9, 60), at(40, 40, 0), 1);
  shape.width_px = shape.height_px = 400;
  shape.path_px = {{150, 150}, {250, 150}, {250, 250}, {150, 250}};
  Selection s;
  s.drawn = shape;
  const FoundRows all = find_rows(*file_, *cubes_, s, values_);
  s.depth_m = 0.5;
  const FoundRows near = find_rows(*file_, *cubes_, s, values_);
  std::map<std::pair<int, int>, double> nearest;
  std::vector<std::tuple<uint32_t, std::pair<int, int>, double>> inside;
  for (uint32_t i = 0; i < log_.size(); ++i) {
    if (!all.rows.has(i)) continue;
    const Eigen::Vector4d c = shape.clip_from_point * local(i).homogeneous();
    const double x = (c.x() / c.w() + 1) * 200, y = (1 - c.y() / c.w()) * 200;
    const auto cell = std::pair(int((x - 150) / kDepthCellPx), int((y - 150) / kDepthCellPx));
    const auto [at, is_new] = nearest.emplace(cell, c.w());
    if (!is_new) at->second = std::min(at->second, c.w());
    inside.emplace_back(i, cell, c.w());
  }
  size_t kept = 0;
  for (const auto& [row, cell, depth] : inside) {
    const double behind = depth - nearest[cell];
    kept += near.rows.has(row);
    if (std::abs(behind - 0.5) > 1e-4) {
      EXPECT_EQ(near.rows.has(row), behind <= 0.5) << row;
    }
  }
  EXPECT_GT(kept, 100u);
  EXPECT_LT(kept, inside.size());
}

// Points of a damaged octree: one is of a row that the log lacks, another one is nowhere.
TEST_F(Selections, OddPointsAreLeftOut) {
  std::string bytes = io::bytes_of(folder_ / "tree");
  const OctreeNode root = file_->nodes()[0];
  const auto put = [&](uint64_t at, auto value) { std::memcpy(&bytes[at], &value, sizeof value); };
  put(root.at + 20 * root.points, UINT32_MAX);
  put(root.at + 12 + 8, std::numeric_limits<float>::quiet_NaN());
  io::put_bytes(folder_ / "odd", bytes);
  const OctreeFile odd(folder_ / "odd");
  const FoundRows found = find_rows(odd, *cubes_, {}, values_);
  const auto j = nlohmann::json::parse(histogram_of(odd, *cubes_, found, {}, values_));
  const auto total = [&](const char* name) {
    const auto counts = j.at(name).at("counts").get<std::vector<uint64_t>>();
    return std::accumulate(counts.begin(), counts.end(), uint64_t(0));
  };
  EXPECT_EQ(total("intensity"), odd.header().points - 1);
  EXPECT_EQ(total("height_m"), odd.header().points - 2);
}

TEST_F(Selections, ActionsRespectLocksAndFilters) {
  const FoundRows all = find_rows(*file_, *cubes_, {}, values_);
  Selection s;
  s.locked[1] = s.hidden[2] = true;
  LabelAction action;
  action.label = 3;
  const LabelChange change = change_of(all, s, action, values_);
  std::vector<uint32_t> after = values_;
  const std::string bytes = change.bytes();
  StoredChange::read(bytes).apply(after, false);
  for (size_t i = 0; i < log_.size(); ++i) {
    const uint32_t before = LabelValue::of(values_[i]).label;
    const bool kept = !log_.is_hit(i) || before == 1 || before == 2;
    ASSERT_EQ(LabelValue::of(after[i]).label, kept ? before : 3u);
  }
  LabelAction only;
  only.selected = only.only = true;
  Selection three;
  three.label = 3;
  const std::string picked = change_of(all, three, only, after).bytes();
  StoredChange::read(picked).apply(after, false);
  for (const uint32_t v : after) {
    ASSERT_EQ(LabelValue::of(v).selected, LabelValue::of(v).label == 3);
  }
}

TEST_F(Selections, RefusesShapesWithoutSense) {
  const auto finds = [&](const DrawnShape& shape) {
    Selection s;
    s.drawn = shape;
    find_rows(*file_, *cubes_, s, values_);
  };
  DrawnShape good;
  good.width_px = good.height_px = 100;
  good.path_px = {{1, 1}, {50, 1}, {1, 50}};
  EXPECT_NO_THROW(finds(good));
  DrawnShape bad = good;
  bad.path_px.pop_back();
  EXPECT_THROW(finds(bad), std::invalid_argument);
  bad = good;
  bad.path_px[0].x() = NAN;
  EXPECT_THROW(finds(bad), std::invalid_argument);
  bad = good;
  bad.path_px.assign(5000, Vec2(1, 2));
  EXPECT_THROW(finds(bad), std::invalid_argument);
  bad = good;
  bad.clip_from_point(0, 0) = INFINITY;
  EXPECT_THROW(finds(bad), std::invalid_argument);
  bad = good;
  bad.width_px = 0;
  EXPECT_THROW(finds(bad), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::serve
