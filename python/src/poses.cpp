/// \file
/// Poses and trajectories.
#include "poses.hpp"

#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>

#include <cstring>

#include "bind.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/poses.hpp"

namespace underbrush::python {
namespace nb = nanobind;
using namespace nb::literals;
namespace {

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Times = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Places = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Turns = nb::ndarray<const double, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>;

/// Returns an array, or whatever NumPy makes one of, as a vector; `otherwise` for None.
template <int N>
Eigen::Matrix<double, N, 1> numbers(const nb::object& given,
                                    const Eigen::Matrix<double, N, 1>& otherwise) {
  if (given.is_none()) return otherwise;
  const nb::object array =
      nb::module_::import_("numpy").attr("asarray")(given, "dtype"_a = "float64");
  Eigen::Matrix<double, N, 1> out;
  if (!nb::try_cast(array, out)) {
    throw std::invalid_argument("pose: the position has 3 numbers, the rotation 4");
  }
  return out;
}

Pose pose_of(const Vec3& position, const Eigen::Vector4d& rotation) {
  Pose p;
  p.translation = position;
  p.rotation.coeffs() = rotation;  // x y z w
  require(position.allFinite() && std::abs(rotation.norm() - 1) < 0.005,
          "pose: needs a finite position and a quaternion x y z w of length 1");
  p.rotation.normalize();
  return p;
}

Matrix4 matrix_of(const Pose& p) {
  Matrix4 m = Matrix4::Identity();
  m.topLeftCorner<3, 3>() = p.rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = p.translation;
  return m;
}

Trajectory trajectory_of(const Times& time_s, const Places& position, const Turns& rotation) {
  const size_t n = time_s.shape(0);
  require(position.shape(0) == n && rotation.shape(0) == n,
          "trajectory: times, positions and rotations differ in number");
  std::vector<StampedPose> poses(n);
  for (size_t i = 0; i < n; ++i) {
    poses[i] = {time_s.data()[i],
                pose_of(Eigen::Map<const Vec3>(position.data() + 3 * i),
                        Eigen::Map<const Eigen::Vector4d>(rotation.data() + 4 * i))};
  }
  return Trajectory(std::move(poses));
}

}  // namespace

Pose pose_from_matrix(const Eigen::Matrix4d& m) {
  std::array<double, 12> rows{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) rows[4 * size_t(r) + size_t(c)] = m(r, c);
  }
  const std::optional<Pose> pose = io::pose_from_rows(rows);
  require(pose && m.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1)),
          "pose: the 4 x 4 matrix is no rigid transform");
  return *pose;
}

void bind_poses(nb::module_& m) {
  nb::class_<Pose>(m, "Pose",
                   "A rigid transform x -> R x + t, right-handed, z up, m.\n\n"
                   "`position` is t (3, m); `rotation` is a unit quaternion x y z w (4). Raises\n"
                   "`ValueError` for values that are not finite or a quaternion of another length.")
      .def(
          "__init__",
          [](Pose* p, const nb::object& position, const nb::object& rotation) {
            new (p) Pose(pose_of(numbers<3>(position, Vec3::Zero()),
                                 numbers<4>(rotation, Eigen::Vector4d::UnitW())));
          },
          "position"_a = nb::none(), "rotation"_a = nb::none(),
          nb::sig("def __init__(self, position: numpy.typing.ArrayLike | None = None, "
                  "rotation: numpy.typing.ArrayLike | None = None) -> None"))
      .def_static("from_matrix", &pose_from_matrix, "matrix"_a,
                  "Makes a pose from a 4 x 4 matrix. Raises `ValueError` unless it is a rigid\n"
                  "transform within 0.005.")
      .def_prop_ro(
          "position", [](const Pose& p) { return p.translation; },
          "The translation t (3,), m; a copy.")
      .def_prop_ro(
          "rotation", [](const Pose& p) { return Eigen::Vector4d(p.rotation.coeffs()); },
          "Unit quaternion x y z w (4,); a copy.")
      .def("matrix", &matrix_of, "Returns the transform as a 4 x 4 matrix.")
      .def("inverse", &Pose::inverse, "Returns the inverse transform.")
      .def(
          "__mul__", [](const Pose& a, const Pose& b) { return a * b; }, "other"_a,
          "Returns the transform that applies `other` first.")
      .def("__repr__", [](const Pose& p) {
        const Vec3& t = p.translation;
        const auto& q = p.rotation;
        const nb::str form(
            "Pose(position=[{:.3f}, {:.3f}, {:.3f}], rotation=[{:.4f}, {:.4f}, {:.4f}, {:.4f}])");
        return nb::str(form.attr("format")(t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()));
      });
  nb::class_<Trajectory>(
      m, "Trajectory",
      "Poses over time, world from sensor (or object), in ascending order of time.\n\n"
      "`time_s` (m,) s, `position` (m, 3) m, `rotation` (m, 4) unit quaternions x y z w; they are\n"
      "copied. Raises `ValueError` where two poses share a time or a value is not finite.")
      .def(
          "__init__",
          [](Trajectory* t, const Times& time_s, const Places& position, const Turns& rotation) {
            new (t) Trajectory(trajectory_of(time_s, position, rotation));
          },
          "time_s"_a, "position"_a, "rotation"_a)
      .def("__len__", [](const Trajectory& t) { return t.poses().size(); })
      .def("at", &Trajectory::at, "time_s"_a,
           "Returns the interpolated pose at a time (s), or None far outside the recorded span.")
      .def_prop_ro(
          "start_s", [](const Trajectory& t) { return t.empty() ? 0 : t.poses().front().time_s; },
          "Time of the first pose, s.")
      .def_prop_ro(
          "end_s", [](const Trajectory& t) { return t.empty() ? 0 : t.poses().back().time_s; },
          "Time of the last pose, s.");
  m.def("read_trajectory", &io::read_trajectory, "path"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Reads poses with times (TUM, or a time before KITTI's matrix). Raises `FormatError`.");
}

}  // namespace underbrush::python
