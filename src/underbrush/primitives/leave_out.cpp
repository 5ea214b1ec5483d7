#include "underbrush/primitives/leave_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "underbrush/primitives/object_json.inl"

namespace underbrush::primitives {
namespace {

using Corners = std::array<Eigen::Vector2d, 4>;

/// Returns the corners of an object's box as seen from above, in order around it.
Corners corners_of(const PlacedObject& o) {
  const Pose pose = o.world_from_object();
  const auto corner = [&](double x, double y) {
    return Eigen::Vector2d((pose * Vec3(x, y, 0)).head<2>());
  };
  const Vec3 &a = o.box.min, &b = o.box.max;
  return {corner(a.x(), a.y()), corner(b.x(), a.y()), corner(b.x(), b.y()), corner(a.x(), b.y())};
}

/// Whether the normal of a side of `a` has the two rectangles on either side of a line.
bool has_line_between(const Corners& a, const Corners& b) {
  for (size_t k = 0; k < 2; ++k) {
    const Eigen::Vector2d axis = a[k + 1] - a[k];
    const auto reach = [&](const Corners& c) {
      std::array<double, 4> along{};
      std::transform(c.begin(), c.end(), along.begin(),
                     [&](const Eigen::Vector2d& p) { return axis.dot(p); });
      return std::minmax({along[0], along[1], along[2], along[3]});
    };
    const auto [a_low, a_high] = reach(a);
    const auto [b_low, b_high] = reach(b);
    if (a_high < b_low || b_high < a_low) return true;
  }
  return false;
}

/// Reads the object from which a primitive was cut; none for one that is made of meshes.
std::optional<PlacedObject> source_of(const std::filesystem::path& primitive) {
  const io::JsonFile json(primitive / "primitive.json");
  const io::JsonValue j = json.root();
  if (j.find("plants")) return std::nullopt;
  return object_of_json(j.at("source"));
}

}  // namespace

bool share_ground(const PlacedObject& a, const PlacedObject& b) {
  const Corners first = corners_of(a), second = corners_of(b);
  return !has_line_between(first, second) && !has_line_between(second, first);
}

size_t leave_out(PrimitiveSet& set, std::span<const PlacedObject> objects) {
  if (!set.models.empty()) return 0;  // Sets in memory are made of meshes.
  return std::erase_if(set.entries, [&](const PrimitiveEntry& e) {
    const std::optional<PlacedObject> source = source_of(set.folder / e.name);
    return source && std::any_of(objects.begin(), objects.end(),
                                 [&](const PlacedObject& o) { return share_ground(*source, o); });
  });
}

}  // namespace underbrush::primitives
