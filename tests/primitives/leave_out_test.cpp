#include "underbrush/primitives/leave_out.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::primitives {
namespace {

PlacedObject random_object(Stream& random) {
  PlacedObject o;
  o.label = elements::Class::kSmallTree;
  o.position = Vec3(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-9, 9));
  o.yaw_rad = random.uniform(-3, 3);
  o.box.min = Vec3(-random.uniform(0.2, 2), -random.uniform(0.2, 2), 0);
  o.box.max = Vec3(random.uniform(0.2, 2), random.uniform(0.2, 2), random.uniform(0.5, 9));
  return o;
}

/// Whether a point of a fine grid in the box of `a`, grown by `margin` (m), lies in that of `b`,
/// grown likewise.
bool share_a_point(const PlacedObject& a, const PlacedObject& b, double margin) {
  constexpr int kSteps = 80;
  const Pose b_from_a = b.world_from_object().inverse() * a.world_from_object();
  const Vec3 m(margin, margin, 0), low = a.box.min - m, size = a.box.size() + 2 * m;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const Vec3 p = b_from_a * Vec3(low + Vec3(size.x() * i / kSteps, size.y() * k / kSteps, 0));
      const Vec3 under = p - (b.box.min - m), over = (b.box.max + m) - p;
      if (std::min({under.x(), under.y(), over.x(), over.y()}) >= 0) return true;
    }
  }
  return false;
}

TEST(LeaveOut, BoxesShareGroundWhereTheyHaveAPointInCommon) {
  Stream random(7);
  int shared = 0, apart = 0;
  for (int k = 0; k < 500; ++k) {
    const PlacedObject a = random_object(random), b = random_object(random);
    const bool found = share_ground(a, b);
    EXPECT_EQ(found, share_ground(b, a));
    PlacedObject moved[2] = {a, b};  // as both objects move together
    const Pose motion{Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Vec3::UnitZ())), {3e3, -7e3, 20}};
    for (PlacedObject& o : moved) o.position = motion * o.position, o.yaw_rad += 0.8;
    EXPECT_EQ(found, share_ground(moved[0], moved[1]));
    if (share_a_point(a, b, -0.1)) {
      ++shared;
      EXPECT_TRUE(found);
    } else if (!share_a_point(a, b, 0.1)) {
      ++apart;
      EXPECT_FALSE(found);
    }
  }
  EXPECT_GT(shared, 50);
  EXPECT_GT(apart, 50);
}

TEST(LeaveOut, PrimitivesOfTheObjectsGoAndThoseOfMeshesStay) {
  Stream random(3);
  std::vector<Primitive> primitives(12);
  for (size_t k = 0; k < primitives.size(); ++k) {
    Primitive& p = primitives[k];
    p.source = random_object(random);
    p.source.position += Vec3(100.0 * double(k % 6), 0, 0);  // each place has two
    p.source.box = {Vec3(-9, -9, 0), Vec3(9, 9, 1)};
    p.label = p.source.label;
    p.box = p.source.box;
    p.model.ellipsoids.emplace_back();
    p.model.ellipsoids[0].label = uint32_t(k);
    if (k >= 6) p.plants.push_back({"plant"});
  }
  const io::TemporaryFolder folder;
  write_primitives(folder / "set", primitives, 2, "");
  PrimitiveSet set = read_primitive_set(folder / "set");
  const PlacedObject objects[] = {primitives[1].source, primitives[4].source,
                                  random_object(random)};
  PlacedObject far = primitives[3].source;
  far.position.y() += 40;
  EXPECT_EQ(leave_out(set, {&far, 1}), 0u);
  EXPECT_EQ(leave_out(set, objects), 3u);  // the last one stands at the first place
  std::vector<uint32_t> left;
  for (size_t k = 0; k < set.entries.size(); ++k) {
    left.push_back(read_primitive(set, k).ellipsoids.at(0).label);
  }
  EXPECT_EQ(left, (std::vector<uint32_t>{2, 3, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(leave_out(set, objects), 0u);

  std::ofstream(folder / "set" / set.entries[0].name / "primitive.json") << "{}";
  EXPECT_THROW(leave_out(set, objects), FormatError);
}

}  // namespace
}  // namespace underbrush::primitives
