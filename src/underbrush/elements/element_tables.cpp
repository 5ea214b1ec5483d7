#include "underbrush/elements/element_tables.hpp"

#include <algorithm>

namespace underbrush::elements {
namespace fs = std::filesystem;
namespace {

using io::PlyData;
using io::PlyElement;

template <class T, class F>
void add_column(PlyElement& element, const char* name, F value) {
  std::vector<T> column(element.count);
  for (size_t i = 0; i < element.count; ++i) column[i] = T(value(i));
  element.columns.emplace_back(name, std::move(column));
}

template <class GetHit>
void add_hit_columns(PlyElement& element, GetHit hit) {
  add_column<float>(element, "p_hit", [&](size_t i) { return hit(i).p; });
  add_column<uint32_t>(element, "hits", [&](size_t i) { return hit(i).hits; });
  add_column<uint32_t>(element, "misses", [&](size_t i) { return hit(i).misses; });
}

template <class GetLight>
void add_light_columns(PlyElement& element, GetLight light) {
  add_column<float>(element, "reflectance", [&](size_t i) { return light(i).mean; });
  add_column<float>(element, "reflectance_spread", [&](size_t i) { return light(i).spread; });
}

std::vector<HitCount> read_hits(const fs::path& file, const PlyElement& element) {
  const auto& p = io::column_of<float>(file, element, "p_hit");
  const auto& hits = io::column_of<uint32_t>(file, element, "hits");
  const auto& misses = io::column_of<uint32_t>(file, element, "misses");
  std::vector<HitCount> out(element.count);
  for (size_t i = 0; i < out.size(); ++i) out[i] = {p[i], hits[i], misses[i]};
  return out;
}

/// Empty where the file has no reflectances.
std::vector<Reflectance> read_light(const fs::path& file, const PlyElement& element) {
  if (!element.find("reflectance")) return {};
  const auto& mean = io::column_of<float>(file, element, "reflectance");
  const auto& spread = io::column_of<float>(file, element, "reflectance_spread");
  std::vector<Reflectance> out(element.count);
  for (size_t i = 0; i < out.size(); ++i) out[i] = {mean[i], spread[i]};
  return out;
}

}  // namespace

PlyData ply_of_mesh(const TriangleMesh& mesh, bool with_hits) {
  PlyElement vertex, face;
  vertex.name = "vertex";
  vertex.count = mesh.vertices.size();
  const char* axes[3] = {"x", "y", "z"};
  for (int d = 0; d < 3; ++d) {
    add_column<float>(vertex, axes[d], [&](size_t i) { return mesh.vertices[i][d]; });
  }
  face.name = "face";
  face.count = mesh.size();
  face.triangles = mesh.triangles;
  if (with_hits) add_hit_columns(face, [&](size_t i) { return mesh.hit[i]; });
  if (with_hits && !mesh.light.empty()) {
    add_light_columns(face, [&](size_t i) { return mesh.light[i]; });
  }
  if (with_hits && !mesh.roughness.empty()) {
    add_column<float>(face, "roughness", [&](size_t i) { return mesh.roughness[i]; });
  }
  PlyData data;
  data.elements = {std::move(vertex), std::move(face)};
  return data;
}

PlyData ply_of_ellipsoids(const std::vector<Ellipsoid>& ellipsoids, bool with_light) {
  PlyElement e;
  e.name = "vertex";  // Point viewers show the means of an element with this name.
  e.count = ellipsoids.size();
  const char* axes[3] = {"x", "y", "z"};
  for (int d = 0; d < 3; ++d) {
    add_column<float>(e, axes[d], [&](size_t i) { return ellipsoids[i].mean[d]; });
  }
  const char* entries[6] = {"cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"};
  for (size_t k = 0; k < 6; ++k) {
    add_column<float>(e, entries[k], [&](size_t i) { return ellipsoids[i].covariance[k]; });
  }
  add_hit_columns(e, [&](size_t i) { return ellipsoids[i].hit; });
  add_column<uint32_t>(e, "class", [&](size_t i) { return ellipsoids[i].label; });
  const auto dense = [](const Ellipsoid& x) { return x.density_per_m > 0; };
  if (std::any_of(ellipsoids.begin(), ellipsoids.end(), dense)) {
    add_column<float>(e, "density", [&](size_t i) { return ellipsoids[i].density_per_m; });
  }
  if (with_light) add_light_columns(e, [&](size_t i) { return ellipsoids[i].light; });
  PlyData data;
  data.elements = {std::move(e)};
  return data;
}

TriangleMesh read_mesh_table(const fs::path& file) {
  const PlyData data = io::read_ply(file);
  const PlyElement& vertex = element_of(file, data, "vertex");
  const PlyElement& face = element_of(file, data, "face");
  const auto& x = io::column_of<float>(file, vertex, "x");
  const auto& y = io::column_of<float>(file, vertex, "y");
  const auto& z = io::column_of<float>(file, vertex, "z");
  TriangleMesh mesh;
  for (size_t i = 0; i < vertex.count; ++i) mesh.vertices.emplace_back(x[i], y[i], z[i]);
  mesh.triangles = face.triangles;
  mesh.hit = read_hits(file, face);
  mesh.light = read_light(file, face);
  if (face.find("roughness")) mesh.roughness = io::column_of<float>(file, face, "roughness");
  return mesh;
}

std::vector<Ellipsoid> read_ellipsoid_table(const fs::path& file) {
  const PlyData data = io::read_ply(file);
  const PlyElement& e = element_of(file, data, "vertex");
  const std::vector<HitCount> hit = read_hits(file, e);
  const std::vector<Reflectance> light = read_light(file, e);
  const auto& x = io::column_of<float>(file, e, "x");
  const auto& y = io::column_of<float>(file, e, "y");
  const auto& z = io::column_of<float>(file, e, "z");
  const std::vector<float>* cov[6];
  const char* entries[6] = {"cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"};
  for (int k = 0; k < 6; ++k) cov[k] = &io::column_of<float>(file, e, entries[k]);
  const auto& label = io::column_of<uint32_t>(file, e, "class");
  const auto* density = e.find("density") ? &io::column_of<float>(file, e, "density") : nullptr;
  std::vector<Ellipsoid> out(e.count);
  for (size_t i = 0; i < e.count; ++i) {
    out[i].mean = Vec3f(x[i], y[i], z[i]);
    for (size_t k = 0; k < 6; ++k) out[i].covariance[k] = (*cov[k])[i];
    out[i].hit = hit[i];
    out[i].label = label[i];
    if (density) out[i].density_per_m = (*density)[i];
    if (!light.empty()) out[i].light = light[i];
  }
  return out;
}

}  // namespace underbrush::elements
