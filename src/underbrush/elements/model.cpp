#include "underbrush/elements/model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/elements/classes.hpp"

namespace underbrush::elements {
namespace {

void check_hit(const HitCount& hit) {
  require(hit.p >= 0 && hit.p <= 1, "model: a hit probability outside [0, 1]");
}

void check_light(const Reflectance& r) {
  require(std::isfinite(r.mean) && r.mean >= 0 && std::isfinite(r.spread) && r.spread >= 0,
          "model: a reflectance is negative or not finite");
}

void check_mesh(const TriangleMesh& mesh) {
  require(mesh.hit.size() == mesh.size(),
          "model: triangles and hit probabilities differ in number");
  require(std::isfinite(mesh.range_sigma_m) && mesh.range_sigma_m >= 0, "model: bad range noise");
  require(std::isfinite(mesh.roughness_m) && mesh.roughness_m >= 0, "model: bad roughness");
  for (const Vec3f& v : mesh.vertices) require_data(v.allFinite(), "model: a vertex is not finite");
  for (const auto& t : mesh.triangles) {
    for (uint32_t k : t) require(k < mesh.vertices.size(), "model: a triangle names no vertex");
  }
  for (const HitCount& h : mesh.hit) check_hit(h);
  require(mesh.light.empty() || mesh.light.size() == mesh.size(),
          "model: triangles and reflectances differ in number");
  for (const Reflectance& r : mesh.light) check_light(r);
  require(mesh.roughness.empty() || mesh.roughness.size() == mesh.size(),
          "model: triangles and roughnesses differ in number");
  for (const float h : mesh.roughness) {
    require(std::isfinite(h) && h >= 0, "model: a roughness is negative or not finite");
  }
}

}  // namespace

Mat3 Ellipsoid::covariance_matrix() const {
  const auto& c = covariance;
  Mat3 m;
  m << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return m;
}

void Ellipsoid::set_covariance(const Mat3& s) {
  covariance = {float(s(0, 0)), float(s(0, 1)), float(s(0, 2)),
                float(s(1, 1)), float(s(1, 2)), float(s(2, 2))};
}

ElementPlace PartOf::place(uint32_t element) const {
  Kind kind = Kind::kGround;
  if (element >= first(Kind::kEllipsoid)) {
    kind = Kind::kEllipsoid;
  } else if (element >= first(Kind::kSurface)) {
    kind = Kind::kSurface;
  }
  const std::vector<uint32_t>& all = numbers[size_t(kind)];
  const auto at = std::ranges::lower_bound(all, element - first(kind));
  return {kind, uint32_t(at - all.begin())};
}

size_t Model::whole_count(Kind kind) const {
  if (part_of) return part_of->counts[size_t(kind)];
  return kind == Kind::kEllipsoid ? ellipsoids.size() : mesh(kind).size();
}

Eigen::AlignedBox3d Model::box() const {
  Eigen::AlignedBox3d box;
  for (const TriangleMesh* mesh : {&ground, &surface}) {
    for (const Vec3f& v : mesh->vertices) box.extend(v.cast<double>());
  }
  for (const Ellipsoid& e : ellipsoids) {
    const Vec3 reach = tau * e.covariance_matrix().diagonal().cwiseSqrt();
    box.extend(e.mean.cast<double>() - reach);
    box.extend(e.mean.cast<double>() + reach);
  }
  return box;
}

HitCount& Model::hit(size_t element) {
  return const_cast<HitCount&>(static_cast<const Model*>(this)->hit(element));
}

const HitCount& Model::hit(size_t element) const {
  const ElementPlace at = place(element);
  return at.kind == Kind::kEllipsoid ? ellipsoids.at(at.index).hit : mesh(at.kind).hit[at.index];
}

std::string Model::class_name(uint32_t label) const {
  if (label < kClassNames.size()) return std::string(kClassNames[label]);
  const size_t own = label - kClassNames.size();
  return own < class_names.size() ? class_names[own] : std::to_string(label);
}

std::optional<uint32_t> Model::class_number(std::string_view name) const {
  if (const auto known = class_from_name(name)) return uint32_t(*known);
  for (size_t k = 0; k < class_names.size(); ++k) {
    if (class_names[k] == name) return uint32_t(kClassNames.size() + k);
  }
  return std::nullopt;
}

ChannelOffsets Model::channels_of(const LogInfo& log) const {
  const bool same = !sensor.empty() && log.sensor == sensor && log.sensor_file == sensor_file;
  return same ? channels : ChannelOffsets();
}

double Model::reach_of(const LogInfo& log) const {
  const bool same = log.sensor == sensor && log.sensor_file == sensor_file;
  return same ? max_range_m : std::numeric_limits<double>::infinity();
}

Model Model::like() const {
  Model out;
  out.origin = origin;
  for (const auto& [from, to] : {std::pair{&ground, &out.ground}, {&surface, &out.surface}}) {
    to->range_sigma_m = from->range_sigma_m;
    to->roughness_m = from->roughness_m;
  }
  out.tau = tau;
  out.voxel_m = voxel_m;
  out.class_names = class_names;
  out.grain = grain;
  out.light = light;
  out.range_noise_m = range_noise_m;
  out.sway_s = sway_s;
  out.leaf_angles = leaf_angles;
  out.max_range_m = max_range_m;
  out.sensor = sensor;
  out.sensor_file = sensor_file;
  out.channels = channels;
  out.all_echoes = all_echoes;
  out.fitter = fitter;
  return out;
}

static void check_part(const PartOf& part, const Model& model) {
  const std::array<size_t, 3> sizes{model.ground.size(), model.surface.size(),
                                    model.ellipsoids.size()};
  for (size_t k = 0; k < sizes.size(); ++k) {
    const std::vector<uint32_t>& numbers = part.numbers[k];
    require(numbers.size() == sizes[k], "model: elements of a part and their numbers differ");
    require(std::ranges::adjacent_find(numbers, std::greater_equal<>()) == numbers.end() &&
                (numbers.empty() || numbers.back() < part.counts[k]),
            "model: the numbers of a part do not ascend, or are larger than the whole");
  }
}

void Model::check() const {
  require(origin.allFinite(), "model: the origin is not finite");
  require(std::isfinite(tau) && tau > 0, "model: tau must be positive");
  require(max_range_m > 0, "model: the maximum range must be positive");
  require(std::isfinite(voxel_m) && voxel_m >= 0, "model: the voxels' side must not be negative");
  grain.check();
  if (observed) observed->check();
  for (const ClassGrain& c : grain.classes) {
    require(class_number(class_name(c.label)) == c.label, "model: a class of the grain is unknown");
  }
  require(std::isfinite(range_noise_m) && range_noise_m >= 0,
          "model: the range noise must not be negative");
  require(std::isfinite(sway_s) && (sway_s == 0 || sway_s >= 1e-6),
          "model: the correlation time of its matter must be 0 or at least 1e-6 s");
  for (size_t i = 0; i < channels.size(); ++i) {
    require(std::isfinite(channels[i].range_m) && channels[i].standard_error_m >= 0 &&
                std::isfinite(channels[i].standard_error_m),
            "model: a channel's offset or its standard error is not finite");
    require(i == 0 || channels[i - 1].ring < channels[i].ring,
            "model: the channels are not in ascending order");
  }
  if (part_of) check_part(*part_of, *this);
  light.check();
  if (keyframes) keyframes->check();
  check_mesh(ground);
  check_mesh(surface);
  for (const Ellipsoid& e : ellipsoids) {
    require(e.mean.allFinite(), "model: an ellipsoid's mean is not finite");
    const Mat3 sigma = e.covariance_matrix();
    require(sigma.allFinite(), "model: a covariance is not finite");
    require(is_positive_definite(sigma), "model: a covariance is not positive definite");
    require(std::isfinite(e.density_per_m) && e.density_per_m >= 0,
            "model: an ellipsoid's density is negative or not finite");
    check_hit(e.hit);
    check_light(e.light);
  }
}

/// Whether a symmetric matrix is positive definite, by Sylvester's criterion.
static bool is_positive(const Mat3& m) {
  return m(0, 0) > 0 && m.topLeftCorner<2, 2>().determinant() > 0 && m.determinant() > 0;
}

Mat3 floored_covariance(const Mat3& sigma, double floor_m) {
  Mat3 symmetric = 0.5 * (sigma + sigma.transpose());
  const double least = floor_m * floor_m;
  if (is_positive(symmetric - least * Mat3::Identity())) return symmetric;
  const auto [values, v] = quick_spectrum(symmetric);
  const Mat3 out = v * values.cwiseMax(least).asDiagonal() * v.transpose();
  return 0.5 * (out + out.transpose());
}

Mat3 floored_covariance(const Mat3& sigma, const Mat3& least) {
  Mat3 symmetric = 0.5 * (sigma + sigma.transpose());
  if (is_positive(symmetric - least)) return symmetric;
  const Mat3 root = cholesky(least), whiten = root.inverse();
  const Mat3 whitened = whiten * symmetric * whiten.transpose();
  const auto [values, vectors] = quick_spectrum(0.5 * (whitened + whitened.transpose()));
  const Mat3 v = root * vectors;
  const Mat3 out = v * values.cwiseMax(1).asDiagonal() * v.transpose();
  return 0.5 * (out + out.transpose());
}

}  // namespace underbrush::elements
