#include "underbrush/perception/object_columns.hpp"

namespace underbrush::perception {
namespace {

using O = TrackedObject;

constexpr std::array kColumns{
    ObjectColumn{"existence", [](O& o) -> double& { return o.existence; }},
    ObjectColumn{"age", [](O& o) -> double& { return o.age_s; }},
    ObjectColumn{"x", [](O& o) -> double& { return o.box.centre_m.x(); }},
    ObjectColumn{"y", [](O& o) -> double& { return o.box.centre_m.y(); }},
    ObjectColumn{"z", [](O& o) -> double& { return o.box.centre_m.z(); }},
    ObjectColumn{"yaw", [](O& o) -> double& { return o.box.yaw_rad; }},
    ObjectColumn{"length", [](O& o) -> double& { return o.box.size_m.x(); }},
    ObjectColumn{"width", [](O& o) -> double& { return o.box.size_m.y(); }},
    ObjectColumn{"height", [](O& o) -> double& { return o.box.size_m.z(); }},
    ObjectColumn{"measured_length", [](O& o) -> double& { return o.measured_size_m.x(); }},
    ObjectColumn{"measured_width", [](O& o) -> double& { return o.measured_size_m.y(); }},
    ObjectColumn{"measured_height", [](O& o) -> double& { return o.measured_size_m.z(); }},
    ObjectColumn{"reference_x", [](O& o) -> double& { return o.reference_m.x(); }},
    ObjectColumn{"reference_y", [](O& o) -> double& { return o.reference_m.y(); }},
    ObjectColumn{"reference_z", [](O& o) -> double& { return o.reference_m.z(); }},
    ObjectColumn{"vx", [](O& o) -> double& { return o.velocity_m_s.x(); }},
    ObjectColumn{"vy", [](O& o) -> double& { return o.velocity_m_s.y(); }},
    ObjectColumn{"ax", [](O& o) -> double& { return o.acceleration_m_s2.x(); }},
    ObjectColumn{"ay", [](O& o) -> double& { return o.acceleration_m_s2.y(); }},
    ObjectColumn{"yaw_rate", [](O& o) -> double& { return o.yaw_rate_rad_s; }},
    ObjectColumn{"sigma_x", [](O& o) -> double& { return o.position_sigma_m.x(); }},
    ObjectColumn{"sigma_y", [](O& o) -> double& { return o.position_sigma_m.y(); }},
    ObjectColumn{"sigma_z", [](O& o) -> double& { return o.position_sigma_m.z(); }},
    ObjectColumn{"sigma_yaw", [](O& o) -> double& { return o.yaw_sigma_rad; }},
    ObjectColumn{"sigma_length", [](O& o) -> double& { return o.size_sigma_m.x(); }},
    ObjectColumn{"sigma_width", [](O& o) -> double& { return o.size_sigma_m.y(); }},
    ObjectColumn{"sigma_height", [](O& o) -> double& { return o.size_sigma_m.z(); }},
    ObjectColumn{"sigma_speed", [](O& o) -> double& { return o.speed_sigma_m_s; }},
};

}  // namespace

std::span<const ObjectColumn> object_columns() { return kColumns; }

}  // namespace underbrush::perception
