#include "underbrush/primitives/extract.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "io/temporary.hpp"
#include "primitives/sites.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::primitives {
namespace {

using elements::Class;

/// An oblong tree and a patch on sloping ground, with an ellipsoid for every tenth point, all
/// transformed by `move`.
struct Site {
  elements::Model model;
  BeamLog log;
};

Site site(const Pose& move, uint64_t seed = 1) {
  Stream random(seed);
  std::vector<Vec3> points;
  std::vector<uint8_t> label;
  std::vector<uint32_t> instance;
  const auto add = [&](const Vec3& p, Class c, uint32_t i) {
    points.push_back(p);
    label.push_back(uint8_t(c));
    instance.push_back(i);
  };
  for (int k = 0; k < 4000; ++k) {  // a tree 6 × 2 × 5 m
    add(Vec3(random.uniform(-3, 3), random.uniform(-1, 1), random.uniform(0.2, 5)),
        Class::kSmallTree, 5);
  }
  for (int k = 0; k < 300; ++k) {  // another beside it, whose box overlaps when rotated
    add(Vec3(random.uniform(-1, 1), random.uniform(1, 2), random.uniform(0.2, 5)),
        Class::kSmallTree, 6);
  }
  Site s;
  s.model.origin = move * Vec3(1, 2, 0);
  s.model.tau = 2.5;
  for (const double x : {-30.0, 30.0}) {
    for (const double y : {-30.0, 30.0}) {
      s.model.ground.vertices.push_back((move * Vec3(x, y, 0) - s.model.origin).cast<float>());
    }
  }
  s.model.ground.triangles = {{0, 2, 1}, {1, 2, 3}};
  s.model.ground.hit.resize(2);
  const Mat3 turn = move.rotation.toRotationMatrix();
  for (size_t i = 0; i < points.size(); ++i) {
    if (i % 10 == 0) {
      elements::Ellipsoid e;
      // keeps means off the borders of boxes
      const Vec3 middle(0, instance[i] == 6 ? 1.5 : 0, 2.6);
      const Vec3 at = middle + 0.97 * (points[i] - middle);
      e.mean = (move * at - s.model.origin).cast<float>();
      const Mat3 spread = Vec3(0.04, 0.01, 0.0025).asDiagonal();
      e.set_covariance(turn * spread * turn.transpose());
      e.hit.p = float(random.uniform(0.1, 1));
      s.model.ellipsoids.push_back(e);
    }
    points[i] = move * points[i];
  }
  s.log = test::labelled_log(points, label, instance);
  return s;
}

ExtractResult extract_from(const Site& s, const ExtractOptions& options = {}) {
  MemorySource source(s.log, 999);
  return extract(s.model, source, options);
}

Pose moved(double x, double y, double z, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vec3::UnitZ())), Vec3(x, y, z)};
}

// A primitive must not depend on where its object stood.
TEST(Extract, GivesTheSamePrimitiveWhereverTheObjectStands) {
  ExtractOptions options;
  options.membership = Membership::kBox;
  const ExtractResult here = extract_from(site({}), options);
  ASSERT_EQ(here.primitives.size(), 2u);
  for (const double yaw : {0.4, -1.1, 1.5}) {
    const ExtractResult there = extract_from(site(moved(70, -40, 12, yaw)), options);
    ASSERT_EQ(there.primitives.size(), 2u);
    for (size_t k = 0; k < 2; ++k) {
      const Primitive &a = here.primitives[k], &b = there.primitives[k];
      EXPECT_LT((a.box.size() - b.box.size()).norm(), 1e-3);
      ASSERT_EQ(a.model.ellipsoids.size(), b.model.ellipsoids.size());
      // An axis has no sign, so the primitive may be rotated by half a turn.
      const double sign = std::cos(b.source.yaw_rad - yaw - a.source.yaw_rad) > 0 ? 1 : -1;
      for (size_t i = 0; i < a.model.ellipsoids.size(); ++i) {
        const auto &e = a.model.ellipsoids[i], &f = b.model.ellipsoids[i];
        const Vec3 turned(sign * f.mean.x(), sign * f.mean.y(), f.mean.z());
        ASSERT_LT((e.mean.cast<double>() - turned).norm(), 1e-3);
        ASSERT_LT((e.covariance_matrix() - f.covariance_matrix()).diagonal().norm(), 1e-4);
        ASSERT_EQ(e.hit.p, f.hit.p);
      }
    }
  }
}

TEST(Extract, APrimitiveHasTheGrainAndTheSensorOfItsModel) {
  Site s = site({});
  s.model.grain = {0.03, 0.07, {}};
  s.model.range_noise_m = 0.011;
  s.model.sway_s = 0.25;
  s.model.sensor = "velodyne-vlp16";
  s.model.surface.roughness_m = 0.2;
  const ExtractResult out = extract_from(s);
  ASSERT_FALSE(out.primitives.empty());
  const elements::Model& m = out.primitives[0].model;
  EXPECT_EQ(m.grain.ellipsoid_m, 0.03);
  EXPECT_EQ(m.grain.mesh_m, 0.07);
  EXPECT_EQ(m.range_noise_m, 0.011);
  EXPECT_EQ(m.sway_s, 0.25);
  EXPECT_EQ(m.sensor, "velodyne-vlp16");
  EXPECT_EQ(m.surface.roughness_m, 0.2);
}

TEST(Extract, MovedBackTheElementsAreThoseOfTheModelEachOnce) {
  const Site s = site(moved(5, 6, 7, 0.8));
  const ExtractResult r = extract_from(s);
  std::vector<int> times(s.model.ellipsoids.size(), 0);
  for (const Primitive& p : r.primitives) {
    const Pose pose = p.source.world_from_object();
    for (const auto& e : p.model.ellipsoids) {
      const Vec3 world = pose * e.mean.cast<double>();
      const auto same = std::find_if(
          s.model.ellipsoids.begin(), s.model.ellipsoids.end(), [&](const elements::Ellipsoid& f) {
            return (s.model.origin + f.mean.cast<double>() - world).norm() < 1e-4;
          });
      ASSERT_NE(same, s.model.ellipsoids.end());
      EXPECT_EQ(++times[size_t(same - s.model.ellipsoids.begin())], 1);
    }
  }
  EXPECT_EQ(r.elements, times.size());
  // voxels on the border belong to one object
  EXPECT_GT(double(r.taken), 0.98 * double(r.elements));
}

TEST(Extract, LeavesOutWhatNearlyAllBeamsPassed) {
  Site s = site({});
  const auto count = [](const ExtractResult& r) {
    size_t n = 0;
    for (const Primitive& p : r.primitives) n += p.model.ellipsoids.size();
    return n;
  };
  const size_t all = count(extract_from(s));  // ellipsoids that no beam met are kept
  for (size_t k = 0; k < s.model.ellipsoids.size(); ++k) {
    elements::HitCount& h = s.model.ellipsoids[k].hit;
    h.hits = uint32_t(k % 4);
    h.misses = 10 - h.hits;  // shares of hits are 0, 0.1, 0.2 and 0.3
  }
  ExtractOptions options;
  for (const auto& [below, kept] : {std::pair{0.0, 1.0}, {0.1, 0.75}, {0.11, 0.5}, {0.25, 0.25}}) {
    options.free_space_below = below;
    const ExtractResult r = extract_from(s, options);
    EXPECT_NEAR(double(count(r)), kept * double(all), 8) << below;
    EXPECT_EQ(count(r) + r.free_space, all) << below;
    for (const Primitive& p : r.primitives) {
      for (const auto& e : p.model.ellipsoids) EXPECT_GE(e.hit.hits, 10 * below);
    }
  }
  options.free_space_below = 1.1;
  EXPECT_THROW(extract_from(s, options), std::invalid_argument);
}

TEST(Extract, LeavesOutObjectsOfFewElements) {
  const Site s = site({});
  const ExtractResult all = extract_from(s);
  ASSERT_EQ(all.few_elements, 0u);
  ASSERT_FALSE(all.primitives.empty());
  size_t least = SIZE_MAX, with_least = 0;
  for (const Primitive& p : all.primitives) least = std::min(least, p.model.size());
  for (const Primitive& p : all.primitives) with_least += p.model.size() == least;
  ExtractOptions options;
  options.min_elements = least;
  EXPECT_EQ(extract_from(s, options).primitives.size(), all.primitives.size());
  options.min_elements = least + 1;
  const ExtractResult some = extract_from(s, options);
  EXPECT_EQ(some.few_elements, with_least);
  EXPECT_EQ(some.primitives.size(), all.primitives.size() - with_least);
}

TEST(Extract, MeasuresPoseAndBox) {
  const ExtractResult r = extract_from(site(moved(0, 0, 4, 0.6)));
  const PlacedObject& tree = r.measured.objects.at(0);
  EXPECT_EQ(tree.label, Class::kSmallTree);
  EXPECT_EQ(tree.instance, 5u);
  EXPECT_EQ(tree.points, 4000u);
  EXPECT_NEAR(tree.yaw_rad, 0.6, 0.02);
  EXPECT_LT((tree.box.size() - Vec3(6, 2, 5)).norm(), 0.15);
  EXPECT_NEAR(tree.position.z(), 4, 1e-4);  // on the ground
  EXPECT_EQ(tree.box.min.z(), 0);
  ExtractOptions options;
  options.measure.quantile = 0.05;  // nine tenths of a uniform body
  const Vec3 inner = extract_from(site({}), options).measured.objects.at(0).box.size();
  EXPECT_NEAR(inner.x(), 5.4, 0.1);
  EXPECT_NEAR(inner.y(), 1.8, 0.05);
}

// Objects face the beams that measured them, so that a primitive in another's place is seen from
// the side that has data.
TEST(Extract, ObjectsFaceTheBeamsThatMeasuredThem) {
  for (const Class label : {Class::kSmallTree, Class::kSmallShrubPatch}) {
    for (int k = 0; k < 12; ++k) {
      Site s = site(moved(5, 6, 7, 0.5 * k));
      s.log.extra["class"] = std::vector<uint8_t>(s.log.size(), uint8_t(label));
      const double azimuth = 0.53 * k;
      const Vec3f direction(float(std::cos(azimuth)), float(std::sin(azimuth)), 0);
      for (size_t i = 0; i < s.log.size(); ++i) {
        s.log.origin[i] = s.log.end_point(i) - 10 * direction.cast<double>();
        s.log.direction[i] = direction;
      }
      const std::vector<PlacedObject> objects = extract_from(s).measured.objects;
      ASSERT_FALSE(objects.empty());
      for (const PlacedObject& o : objects) {
        const Vec3 along = o.world_from_object().rotation.inverse() * direction.cast<double>();
        EXPECT_GE(along.y(), -1e-6);
        if (label == Class::kSmallShrubPatch) {
          EXPECT_GE(along.y(), std::sqrt(0.5) - 1e-6);
          EXPECT_NEAR(std::remainder(o.yaw_rad, M_PI_2), 0, 1e-6);
        }
      }
    }
  }
}

TEST(Extract, MeasuresWhereThePointsLie) {
  const PlacedObject tree = extract_from(site(moved(3, 4, 5, 0.6))).measured.objects.at(0);
  for (size_t q = 0; q < tree.layers.z.size(); ++q) {  // a uniform body, 6 × 2 × 4.8 m
    const double share = PointLayers::kShares[q];
    EXPECT_NEAR(tree.layers.z[q], 0.2 + 4.8 * share, 0.1);
    for (size_t l = 0; l < tree.layers.z.size(); ++l) {
      EXPECT_NEAR(std::abs(tree.layers.x[l][q]), std::abs(6 * share - 3), 0.4);
      EXPECT_NEAR(std::abs(tree.layers.y[l][q]), std::abs(2 * share - 1), 0.15);
    }
  }
}

TEST(Extract, TheCentreRuleSharesElementsOfOverlappingBoxes) {
  const Site s = site({});
  ExtractOptions options;
  options.membership = Membership::kBox;
  const ExtractResult r = extract_from(s, options);
  for (const Primitive& p : r.primitives) {
    size_t inside = 0;
    const Pose object_from_world = p.source.world_from_object().inverse();
    for (const auto& e : s.model.ellipsoids) {
      const Vec3 at = object_from_world * (s.model.origin + e.mean.cast<double>());
      inside += (at.array() >= p.box.min.array()).all() && (at.array() <= p.box.max.array()).all();
    }
    EXPECT_EQ(p.model.ellipsoids.size(), inside);
  }
}

TEST(Extract, PatchesAreCutIntoCells) {
  Stream random(3);
  std::vector<Vec3> points;
  points.reserve(6000);
  for (int k = 0; k < 6000; ++k) {
    points.emplace_back(random.uniform(0, 6), random.uniform(0, 4), random.uniform(0.1, 1));
  }
  Site s = site({});
  s.log = test::labelled_log(points, std::vector<uint8_t>(6000, uint8_t(Class::kSmallShrubPatch)),
                             std::vector<uint32_t>(6000, 9));
  MemorySource source(s.log);
  const GroundSurface ground(s.model);
  const MeasuredObjects m = measure_objects(source, ground, {});
  ASSERT_EQ(m.objects.size(), 6u);
  size_t total = 0;
  for (const PlacedObject& o : m.objects) {
    EXPECT_EQ(o.box.size().head<2>(), Eigen::Vector2d(2, 2));
    EXPECT_EQ(o.instance, 9u);
    total += o.points;
  }
  EXPECT_EQ(total, 6000u);
}

TEST(Extract, NeedsLabels) {
  Site s = site({});
  s.log.extra.erase("instance");
  EXPECT_THROW(extract_from(s), std::invalid_argument);
  s = site({});
  s.log.info.classes = "semantickitti";
  EXPECT_THROW(extract_from(s), std::invalid_argument);
}

TEST(PrimitiveSet, ComesBackAndCanBeBrowsed) {
  const io::TemporaryFolder folder;
  const ExtractResult r = extract_from(site({}));
  write_primitives(folder / "set", r.primitives, 2, R"({"seed": 1})");
  const PrimitiveSet set = read_primitive_set(folder / "set");
  ASSERT_EQ(set.entries.size(), r.primitives.size());
  for (size_t k = 0; k < set.entries.size(); ++k) {
    const Primitive& p = r.primitives[k];
    EXPECT_EQ(set.entries[k].label, p.label);
    EXPECT_LT((set.entries[k].box.max - p.box.max).norm(), 1e-3);
    EXPECT_TRUE(p.source.layers.known());
    EXPECT_EQ(set.entries[k].layers, p.source.layers);
    const elements::Model m = read_primitive(set, k);
    ASSERT_EQ(m.ellipsoids.size(), p.model.ellipsoids.size());
    EXPECT_EQ(m.ellipsoids[3].mean, p.model.ellipsoids[3].mean);
    EXPECT_EQ(m.ellipsoids[3].covariance, p.model.ellipsoids[3].covariance);
    EXPECT_EQ(m.tau, 2.5);
    const std::string png =
        io::bytes_of(folder / ("set/" + set.entries[k].name + "/thumbnail.png"));
    EXPECT_EQ(png.substr(1, 3), "PNG");
  }
  const std::string page = io::bytes_of(folder / "set/index.html");
  for (const char* word : {"http:", "https:", "<script", "url("}) {  // the page must load nothing
    EXPECT_EQ(page.find(word), std::string::npos) << word;
  }
  EXPECT_NE(page.find("small_tree/0002"), std::string::npos);
  size_t pictures = 0;
  for (size_t at = 0; (at = page.find("<img ", at)) != std::string::npos; ++at) ++pictures;
  EXPECT_EQ(pictures, set.entries.size());
}

TEST(PrimitiveSet, ThatIsDamagedIsRefused) {
  const io::TemporaryFolder folder;
  EXPECT_THROW(read_primitive_set(folder / "none"), FormatError);
  write_primitives(folder / "set", extract_from(site({})).primitives, 2, "");
  std::filesystem::remove(folder / "set/small_tree/0001/model.json");
  EXPECT_THROW(read_primitive_set(folder / "set"), FormatError);
  io::put_bytes(folder / "set/primitives.json",
                R"({"format": "underbrush-primitives", "version": 9})");
  EXPECT_THROW(read_primitive_set(folder / "set"), FormatError);
  io::put_bytes(folder / "mine/thesis.tex", "years");
  EXPECT_THROW(write_primitives(folder / "mine", {}, 2, ""), IoError);
}

}  // namespace
}  // namespace underbrush::primitives
