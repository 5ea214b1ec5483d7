#include "underbrush/worlds/helios_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/geotiff.hpp"
#include "underbrush/io/mesh_readers.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/worlds/voxel_file.hpp"
#include "underbrush/worlds/xml_file.hpp"

namespace underbrush::worlds {
namespace fs = std::filesystem;
namespace {

using elements::Instance;

/// A geometry that was read, to be placed any number of times.
struct Geometry {
  PartModels models;
  Vec3 offset = Vec3::Zero();  ///< The origin of the models, in coordinates of the file.
  double lowest = 0;           ///< m; in the file's coordinates, with z up.
  double unit_m = 1;           ///< m; unit of the file, if that states one.
};

/// Finds the values of a filter's parameters.
class Parameters {
 public:
  Parameters(const XmlFile& xml, const pugi::xml_node& filter) : xml_(xml), filter_(filter) {}
  pugi::xml_node find(const char* key) const {
    for (const pugi::xml_node& param : filter_.children("param")) {
      if (std::strcmp(param.attribute("key").value(), key) == 0) return param;
    }
    return {};
  }
  std::string text(const char* key) const {
    const pugi::xml_node param = find(key);
    return param ? param.attribute("value").value() : "";
  }
  double number(const char* key, double otherwise) const {
    const pugi::xml_node param = find(key);
    return param ? xml_.number(param, "value", otherwise) : otherwise;
  }
  Vec3 vector(const char* key) const {
    const pugi::xml_node param = find(key);
    if (!param) return Vec3::Zero();
    std::string value = param.attribute("value").value();
    std::replace(value.begin(), value.end(), ';', ' ');
    const auto words = io::words_of(value);
    Vec3 out = Vec3::Zero();
    for (size_t d = 0; d < 3; ++d) {
      const auto number = words.size() == 3 ? io::number_of(words[d]) : std::nullopt;
      if (!number || !(std::abs(*number) <= 1e9)) {
        xml_.fail(param, std::string(key) + ": " + in_quotes(value) + " is not three numbers");
      }
      out[Eigen::Index(d)] = *number;
    }
    return out;
  }

 private:
  const XmlFile& xml_;
  const pugi::xml_node filter_;
};

/// Reads the parts of a scene into a world.
class SceneReader {
 public:
  SceneReader(const XmlFile& xml, const Assets& assets)
      : xml_(xml), assets_(assets), world_(empty_world(Vec3::Zero())) {}

  World read(const pugi::xml_node& scene) {
    xml_.count_others(scene, {"part"}, world_.report.left_out);
    for (const pugi::xml_node& part : scene.children("part")) add_part(part);
    if (world_.report.parts == 0) xml_.fail(scene, "no part of this scene can be read");
    // What stands on the ground is moved when all of the ground is there.
    for (const auto& [first, end, lowest] : on_ground_) put_on_ground(first, end, lowest);
    return std::move(world_);
  }

 private:
  struct OnGround {
    size_t first, end;
    double lowest_m;
  };

  void add_part(const pugi::xml_node& part) {
    xml_.count_others(part, {"filter"}, world_.report.left_out);
    PartPlace place;
    const Geometry* geometry = nullptr;
    bool on_ground = false;
    for (const pugi::xml_node& filter : part.children("filter")) {
      const Parameters parameters(xml_, filter);
      std::string type = xml_.text(filter, "type");
      std::transform(type.begin(), type.end(), type.begin(),
                     [](unsigned char c) { return std::tolower(c); });
      if (type == "scale") {
        place.scale = parameters.number("scale", place.scale);
        if (!(place.scale > 0)) xml_.fail(filter, "scale: must be positive");
      } else if (type == "rotate") {
        place.rotation = (xml_.rotation(parameters.find("rotation")) * place.rotation).normalized();
      } else if (type == "translate") {
        place.translation = parameters.vector("offset");
        on_ground = on_ground || parameters.number("onGround", 0) != 0;
      } else if (type == "objloader" || type == "detailedvoxels" || type == "geotiffloader") {
        geometry = load(filter, parameters, type);
      } else {
        refuse_loader(filter, parameters, type);
        ++world_.report.left_out["filters " + printable(type, 40)];
      }
    }
    if (!geometry) {
      ++world_.report.left_out["parts without a geometry that can be read"];
      return;
    }
    if (geometry->unit_m != 1 && place.scale == 1) {
      xml_.fail(part,
                "its map is in feet: add a filter scale of 0.3048, or 'gdalwarp -t_srs "
                "EPSG:NUMBER' makes a map in metres");
    }
    put(*geometry, place, on_ground);
  }

  /// A scene without a part of its terrain would be another one.
  void refuse_loader(const pugi::xml_node& filter, const Parameters& parameters,
                     const std::string& type) const {
    const std::string file = in_quotes(parameters.text("filepath"));
    if (type == "xyzloader") {
      xml_.fail(filter, file +
                            " is a point cloud, which is not read: mesh it as OBJ and load it "
                            "with objloader, or as voxels with detailedvoxels");
    }
  }

  void put(const Geometry& geometry, const PartPlace& at, bool on_ground) {
    Instance placed;
    placed.world_from_model.rotation = at.rotation;
    placed.world_from_model.translation =
        at.translation + at.scale * (at.rotation * geometry.offset);
    placed.scale = float(at.scale);
    const size_t first = world_.scene.instances.size();
    place(world_, geometry.models, placed);
    if (on_ground) {
      on_ground_.push_back(
          {first, world_.scene.instances.size(), at.translation.z() + at.scale * geometry.lowest});
    }
  }

  /// Moves instances up or down so that the part's lowest point lies on the ground below its
  /// origin.
  void put_on_ground(size_t first, size_t end, double lowest_m) {
    const Vec3& at = world_.scene.instances[first].world_from_model.translation;
    const std::optional<double> ground = ground_at(world_, at.x(), at.y());
    if (!ground) {
      ++world_.report.left_out["onGround where there is no ground"];
      return;
    }
    for (size_t k = first; k < end; ++k) {
      world_.scene.instances[k].world_from_model.translation.z() += *ground - lowest_m;
    }
  }

  const Geometry* load(const pugi::xml_node& filter, const Parameters& parameters,
                       const std::string& type) {
    const std::string name = parameters.text("filepath");
    if (name.empty()) {
      ++world_.report.left_out[parameters.find("efilepath") ? "loaders with an efilepath"
                                                            : "loaders without a filepath"];
      return nullptr;
    }
    const bool voxels = type == "detailedvoxels";
    const std::string mode = voxels ? parameters.text("intersectionMode") : parameters.text("up");
    const auto [at, added] = read_.try_emplace({name, mode});
    if (added) {
      at->second = voxels                    ? voxels_of(name, mode, parameters)
                   : type == "geotiffloader" ? terrain_of(name, parameters)
                                             : mesh_of(filter, name, mode);
    }
    return &at->second;
  }

  Geometry mesh_of(const pugi::xml_node& filter, const std::string& name, const std::string& up) {
    if (!up.empty() && up != "y" && up != "z") xml_.fail(filter, "up: must be y or z");
    io::MeshScene mesh = io::read_mesh_scene(assets_.path(xml_.path(), name));
    if (up == "y") {
      for (Vec3& v : mesh.vertices) v = Vec3(v.x(), -v.z(), v.y());
    }
    return geometry_of(mesh);
  }

  /// A surface through the middles of the cells of an elevation map.
  Geometry terrain_of(const std::string& name, const Parameters& p) {
    const io::Raster map =
        io::read_geotiff(assets_.path(xml_.path(), name), world_.report.left_out);
    io::MeshScene mesh;
    const std::string material = p.text("matname");
    const io::MeshPart part{"", material.empty() ? "ground" : material};
    const auto height =
        std::find_if(map.value.begin(), map.value.end(), [](float z) { return std::isfinite(z); });
    if (height == map.value.end()) throw FormatError(name, "", "it has no heights");
    for (uint32_t r = 0; r < map.rows; ++r) {
      for (uint32_t c = 0; c < map.columns; ++c) {
        const uint32_t at = r * map.columns + c;
        const double z = double(map.value[at]);
        mesh.vertices.emplace_back(map.west + (c + 0.5) * map.cell_m,
                                   map.north - (r + 0.5) * map.cell_m,
                                   std::isfinite(z) ? z : double(*height));
        if (r == 0 || c == 0) continue;
        const uint32_t above = at - map.columns;
        const float sum =
            map.value[at] + map.value[at - 1] + map.value[above] + map.value[above - 1];
        if (!std::isfinite(sum)) continue;  // A corner has no height.
        mesh.add({above - 1, at - 1, at}, part);
        mesh.add({above - 1, at, above}, part);
      }
    }
    if (mesh.triangles.empty()) throw FormatError(name, "", "no four cells that meet have heights");
    const std::string material_file = p.text("matfile");
    if (!material_file.empty()) {
      mesh.materials = io::read_mtl(assets_.path(xml_.path(), material_file), mesh.left_out);
    }
    Geometry out = geometry_of(mesh);
    out.unit_m = map.unit_m;
    return out;
  }

  Geometry geometry_of(const io::MeshScene& mesh) {
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
    for (const Vec3& v : mesh.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    Geometry out;
    out.offset = offset_of(low, high);
    out.lowest = low.z();
    out.models = add_models(world_, mesh, mesh.vertices, out.offset);
    return out;
  }

  Geometry voxels_of(const std::string& name, const std::string& mode, const Parameters& p) {
    const VoxelFile voxels = read_voxels(assets_.path(xml_.path(), name));
    for (const auto& [what, n] : voxels.left_out) world_.report.left_out[what] += n;
    const std::string material_file = p.text("matfile"), material = p.text("matname");
    io::MeshScene cubes;
    if (!mode.empty() && mode != "transmittive") cubes = cubes_of(voxels);
    if (mode == "scaled") ++world_.report.left_out["scaled voxels, which are whole here"];
    if (!material_file.empty()) {
      cubes.materials = io::read_mtl(assets_.path(xml_.path(), material_file), cubes.left_out);
    }
    if (!cubes.triangles.empty()) {
      cubes.parts.at(0).material = material;
      return geometry_of(cubes);
    }
    cubes.parts = {{"", material.empty() ? "leaf" : material}};
    Geometry out;
    const Vec3 high = voxels.low + voxels.side_m.cwiseProduct(
                                       Vec3(voxels.split[0], voxels.split[1], voxels.split[2]));
    out.offset = offset_of(voxels.low, high);
    out.lowest = voxels.low.z();
    out.models = add_models(world_, cubes, {}, out.offset);
    elements::Model& model = world_.scene.models.back();
    model.ellipsoids = ellipsoids_of(voxels, out.offset);
    model.tau = kVoxelTau;
    world_.report.voxels += model.ellipsoids.size();
    return out;
  }

  const XmlFile& xml_;
  const Assets& assets_;
  World world_;
  std::map<std::pair<std::string, std::string>, Geometry> read_;
  std::vector<OnGround> on_ground_;
};

}  // namespace

bool is_helios(const fs::path& path) { return path.extension() == ".xml" && is_file(path); }

World read_helios_scene(const fs::path& path, const std::string& id, const fs::path& assets) {
  const XmlFile xml(path);
  const Assets folders{fs::absolute(path).parent_path(),
                       assets.empty() ? assets : fs::absolute(assets)};
  const pugi::xml_node survey = xml.root().child("survey");
  if (survey && id.empty()) {
    const std::string scene = xml.text(survey, "scene");
    const size_t hash = scene.find('#');
    const fs::path file = folders.path(path, scene);
    const XmlFile other(file);
    return SceneReader(other, folders)
        .read(hash == std::string::npos ? other.root().child("scene")
                                        : other.with_id("scene", scene.substr(hash + 1)));
  }
  const pugi::xml_node scene = id.empty() ? xml.root().child("scene") : xml.with_id("scene", id);
  if (!scene) throw FormatError(path.string(), "", "neither a scene nor a survey of HELIOS++");
  return SceneReader(xml, folders).read(scene);
}

std::optional<double> ground_at(const World& world, double x, double y) {
  std::optional<double> highest;
  for (const Instance& placed : world.scene.instances) {
    const elements::TriangleMesh& mesh = world.scene.models[placed.model].ground;
    for (const auto& t : mesh.triangles) {
      Vec3 v[3];
      for (size_t c = 0; c < 3; ++c) {
        v[c] = placed.world_from_model.translation +
               double(placed.scale) *
                   (placed.world_from_model.rotation * mesh.vertices[t[c]].cast<double>());
      }
      const Vec3 a = v[1] - v[0], b = v[2] - v[0];
      const double det = a.x() * b.y() - a.y() * b.x();
      if (std::abs(det) < 1e-12) continue;
      const double px = x - v[0].x(), py = y - v[0].y();
      const double s = (px * b.y() - py * b.x()) / det, r = (a.x() * py - a.y() * px) / det;
      if (s < -1e-9 || r < -1e-9 || s + r > 1 + 1e-9) continue;
      const double z = v[0].z() + s * a.z() + r * b.z();
      if (!highest || z > *highest) highest = z;
    }
  }
  return highest;
}

}  // namespace underbrush::worlds
