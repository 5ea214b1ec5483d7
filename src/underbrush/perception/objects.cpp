#include "underbrush/perception/objects.hpp"

#include <algorithm>
#include <array>

namespace underbrush::perception {
namespace {

constexpr std::array<std::string_view, kClassCount> kNames{"unknown", "car",        "van",  "truck",
                                                           "cyclist", "pedestrian", "other"};

char lower(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

}  // namespace

std::string_view name(ObjectClass label) { return kNames[size_t(label)]; }

std::optional<ObjectClass> class_of_name(std::string_view name) {
  for (size_t k = 0; k < kNames.size(); ++k) {
    if (std::equal(name.begin(), name.end(), kNames[k].begin(), kNames[k].end(),
                   [](char a, char b) { return lower(a) == b; })) {
      return ObjectClass(k);
    }
  }
  return std::nullopt;
}

Vec3 OrientedBox::to_box(const Vec3& point) const {
  const Vec3 d = point - centre_m;
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {c * d.x() + s * d.y(), c * d.y() - s * d.x(), d.z()};
}

Vec3 OrientedBox::from_box(const Vec3& p) const {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return centre_m + Vec3(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z());
}

}  // namespace underbrush::perception
