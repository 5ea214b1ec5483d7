#include "underbrush/io/gltf_mesh.hpp"

#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <cstring>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t kMostBytes = uint64_t(1) << 31;
constexpr size_t kMostTriangles = size_t(1) << 28;
constexpr int kDeepest = 64;

// Returns the JSON of a GLB file: the first chunk, behind a header of 12 bytes and its own of 8.
std::string json_chunk(const std::string& bytes) {
  uint32_t size = 0;
  if (bytes.size() < 20) return "";
  std::memcpy(&size, bytes.data() + 12, 4);
  return bytes.substr(20, size);
}

// Extensions that do not say what a beam meets may be required and left out.
bool changes_only_looks(const std::string& extension) {
  for (const char* looks : {"KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_",
                            "EXT_lights_", "KHR_xmp", "MSFT_texture_"}) {
    if (extension.starts_with(looks)) return true;
  }
  return false;
}

// A pipe would be waited for.
bool exists_as_file(const std::string& name, void*) {
  std::error_code error;
  return fs::is_regular_file(name, error);
}

bool read_inside(std::vector<unsigned char>* to, std::string* error, const std::string& name,
                 void* folder) {
  const fs::path base = *static_cast<const std::string*>(folder);
  try {
    if (leads_out(base, fs::path(name).lexically_relative(base))) {
      *error = "uri " + in_quotes(name) + " leads out of the folder of this file";
      return false;
    }
    const std::string bytes = read_file(name, kMostBytes);
    to->assign(bytes.begin(), bytes.end());
    return true;
  } catch (const FormatError& e) {
    *error = e.what();
    return false;
  }
}

/// Extracts a mesh from what tinygltf has parsed. Numbers are checked where they are used.
class GltfReader {
 public:
  explicit GltfReader(const fs::path& path) : path_(path) {
    const std::string bytes = read_file(path, kMostBytes);
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int,
                             const unsigned char*, int, void*) { return true; },
                          nullptr);
    check_json(path, bytes.starts_with("glTF") ? json_chunk(bytes) : bytes);
    std::string error, warning;
    const std::string folder = fs::absolute(path).parent_path().string();
    // What the file refers to lies in its folder, which may come from somebody else.
    loader.SetFsCallbacks({exists_as_file, [](const std::string& name, void*) { return name; },
                           read_inside, nullptr, const_cast<std::string*>(&folder)});
    bool read = false;
    try {
      read = bytes.starts_with("glTF")
                 ? loader.LoadBinaryFromMemory(&model_, &error, &warning,
                                               reinterpret_cast<const unsigned char*>(bytes.data()),
                                               unsigned(bytes.size()), folder)
                 : loader.LoadASCIIFromString(&model_, &error, &warning, bytes.data(),
                                              unsigned(bytes.size()), folder);
    } catch (const std::exception&) {
      error = "not glTF 2.0";
    }
    if (!read) fail("", error.empty() ? "not glTF 2.0" : error.substr(0, error.find('\n')));
    for (const std::string& extension : model_.extensionsRequired) {
      if (!changes_only_looks(extension)) fail(extension, "is required and not supported");
    }
  }

  MeshScene read() {
    std::vector<int> roots;
    if (model_.scenes.empty()) {
      std::vector<bool> child(model_.nodes.size(), false);
      for (const auto& n : model_.nodes) {
        for (const int c : n.children) child.at(at(c, model_.nodes.size(), "nodes")) = true;
      }
      for (size_t n = 0; n < child.size(); ++n) {
        if (!child[n]) roots.push_back(int(n));
      }
    } else {
      const int scene = std::max(0, model_.defaultScene);
      roots = model_.scenes[at(scene, model_.scenes.size(), "scene")].nodes;
    }
    seen_.assign(model_.nodes.size(), false);
    for (const int n : roots) add_node(n, Eigen::Affine3d::Identity(), 0);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& reason) const {
    throw FormatError(path_.string(), place, reason);
  }

  size_t at(int index, size_t size, const char* what) const {
    if (index < 0 || size_t(index) >= size) {
      fail(what, "there is no number " + std::to_string(index));
    }
    return size_t(index);
  }

  static Eigen::Affine3d transform_of(const tinygltf::Node& n) {
    Eigen::Affine3d t = Eigen::Affine3d::Identity();
    if (n.matrix.size() == 16) {
      // Both libraries store matrices by columns.
      t.matrix() = Eigen::Map<const Eigen::Matrix4d>(n.matrix.data());
      return t;
    }
    if (n.translation.size() == 3) t.translate(Eigen::Map<const Vec3>(n.translation.data()));
    if (n.rotation.size() == 4) {
      const auto& q = n.rotation;
      t.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized());
    }
    if (n.scale.size() == 3) t.scale(Eigen::Map<const Vec3>(n.scale.data()));
    return t;
  }

  void add_node(int number, const Eigen::Affine3d& parent, int depth) {
    if (depth > kDeepest) fail("nodes", "nested deeper than 64, or in a circle");
    const size_t k = at(number, model_.nodes.size(), "nodes");
    if (seen_[k]) fail("nodes", "number " + std::to_string(k) + " has two parents");
    seen_[k] = true;
    const tinygltf::Node& n = model_.nodes[k];
    constexpr const char* kInstances = "EXT_mesh_gpu_instancing";
    if (n.extensions.count(kInstances)) fail(kInstances, "is not supported: give each a node");
    const Eigen::Affine3d here = parent * transform_of(n);
    if (n.mesh >= 0) {
      for (const auto& p : model_.meshes[at(n.mesh, model_.meshes.size(), "meshes")].primitives) {
        add_primitive(p, here, n.name.empty() ? model_.meshes[size_t(n.mesh)].name : n.name);
      }
    }
    for (const int child : n.children) add_node(child, here, depth + 1);
  }

  /// The bytes of an accessor's elements, `stride` bytes apart.
  struct View {
    const unsigned char* data;
    size_t stride, count;
    int component;
  };

  View view_of(int accessor, int type, const std::string& place) const {
    const auto& a = model_.accessors[at(accessor, model_.accessors.size(), "accessors")];
    if (a.sparse.isSparse) fail(place, "sparse accessors are not supported");
    if (a.type != type) fail(place, "an accessor is not of the type that it should be");
    const auto& v = model_.bufferViews[at(a.bufferView, model_.bufferViews.size(), "bufferViews")];
    const auto& b = model_.buffers[at(v.buffer, model_.buffers.size(), "buffers")];
    const int component = tinygltf::GetComponentSizeInBytes(uint32_t(a.componentType));
    if (component <= 0) fail(place, "a component type that is none");
    const size_t size =
        size_t(component) * size_t(tinygltf::GetNumComponentsInType(uint32_t(type)));
    const size_t stride = v.byteStride ? v.byteStride : size;
    const size_t room = b.data.size();
    const bool inside = v.byteOffset <= room && v.byteLength <= room - v.byteOffset &&
                        a.byteOffset <= v.byteLength && stride >= size && a.count > 0 &&
                        v.byteLength - a.byteOffset >= size &&
                        (v.byteLength - a.byteOffset - size) / stride >= a.count - 1;
    if (!inside) fail(place, "an accessor reaches beyond its buffer");
    return {b.data.data() + v.byteOffset + a.byteOffset, stride, a.count, a.componentType};
  }

  std::vector<uint32_t> indices_of(const tinygltf::Primitive& p, size_t vertices) const {
    std::vector<uint32_t> out;
    if (p.indices < 0) {
      for (uint32_t k = 0; k < vertices; ++k) out.push_back(k);
      return out;
    }
    const View v = view_of(p.indices, TINYGLTF_TYPE_SCALAR, "indices");
    const size_t size = v.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 1
                        : v.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                        : v.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT   ? 4
                                                                                : 0;
    if (size == 0) fail("indices", "they are no whole numbers from 0 on");
    for (size_t k = 0; k < v.count; ++k) {
      uint32_t index = 0;  // Both the file and this machine are little-endian.
      std::memcpy(&index, v.data + k * v.stride, size);
      if (index >= vertices) fail("indices", "an index names no vertex");
      out.push_back(index);
    }
    return out;
  }

  void add_primitive(const tinygltf::Primitive& p, const Eigen::Affine3d& here,
                     const std::string& object) {
    const bool strip = p.mode == TINYGLTF_MODE_TRIANGLE_STRIP;
    const bool fan = p.mode == TINYGLTF_MODE_TRIANGLE_FAN;
    if (!strip && !fan && p.mode != -1 && p.mode != TINYGLTF_MODE_TRIANGLES) return;
    const auto position = p.attributes.find("POSITION");
    if (position == p.attributes.end()) return;
    const View v = view_of(position->second, TINYGLTF_TYPE_VEC3, "POSITION");
    if (v.component != TINYGLTF_COMPONENT_TYPE_FLOAT) fail("POSITION", "positions are not floats");
    const uint32_t first = uint32_t(mesh_.vertices.size());
    for (size_t k = 0; k < v.count; ++k) {
      Vec3f x;
      std::memcpy(x.data(), v.data + k * v.stride, sizeof x);
      mesh_.vertices.push_back(here * x.cast<double>());
      if (!is_within(mesh_.vertices.back(), 1e9)) {
        fail("POSITION", "a coordinate is not finite");
      }
    }
    const std::vector<uint32_t> index = indices_of(p, v.count);
    MeshPart part{object, ""};
    if (p.material >= 0) {
      part.material = model_.materials[at(p.material, model_.materials.size(), "materials")].name;
    }
    for (size_t k = 0; k + 2 < index.size(); k += strip || fan ? 1 : 3) {
      const uint32_t a = fan ? index[0] : index[k];
      if (mesh_.triangles.size() >= kMostTriangles) fail("meshes", "too many triangles");
      mesh_.add({first + a, first + index[k + 1], first + index[k + 2]}, part);
    }
  }

  fs::path path_;
  tinygltf::Model model_;
  std::vector<bool> seen_;  // One a node.
  MeshScene mesh_;
};

}  // namespace

MeshScene read_gltf(const fs::path& path) { return GltfReader(path).read(); }

}  // namespace underbrush::io
