// Embree's closest hit on triangles, as the reference for speed.
#pragma once
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include "underbrush/core/ray.hpp"
#include "underbrush/elements/scene.hpp"

namespace underbrush::bench {

/// The way in which rays are handed over: singly, or 8 or 16 neighbours together.
enum class EmbreeMode { kSingle = 1, kPacket8 = 8, kPacket16 = 16 };

class Embree {
 public:
  /// `config` is in Embree's own form, such as "isa=avx2"; nullptr lets Embree choose.
  explicit Embree(const elements::TriangleMesh& mesh, const char* config = nullptr,
                  RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM)
      : Embree(config) {
    scene_ = scene_of(mesh, quality);
  }

  /// Builds each mesh once and places it by the instances; their models count the meshes.
  Embree(std::span<const elements::TriangleMesh> meshes,
         std::span<const elements::Instance> instances, const char* config = nullptr)
      : Embree(config) {
    scene_ = rtcNewScene(device_);
    for (const auto& mesh : meshes) parts_.push_back(scene_of(mesh, RTC_BUILD_QUALITY_MEDIUM));
    for (const elements::Instance& i : instances) {
      RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(g, parts_[i.model]);
      Eigen::Matrix<float, 3, 4> m;
      m.leftCols<3>() =
          (double(i.scale) * i.world_from_model.rotation.toRotationMatrix()).cast<float>();
      m.col(3) = i.world_from_model.translation.cast<float>();
      rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, m.data());
      rtcCommitGeometry(g);
      rtcAttachGeometry(scene_, g);
      rtcReleaseGeometry(g);
    }
    rtcCommitScene(scene_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    rtcReleaseScene(scene_);
    for (RTCScene part : parts_) rtcReleaseScene(part);
    rtcReleaseDevice(device_);
  }

  /// The memory of the tree and its copy of the mesh, bytes.
  size_t bytes() const { return size_t(bytes_); }

  /// Returns the ranges of the rays (relative to the mesh's origin), in their order.
  void closest_hits(std::span<const Ray> rays, EmbreeMode mode, float max_range_m,
                    std::span<float> range) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if (mode == EmbreeMode::kPacket8) {
      packets<8, RTCRayHit8>(rays, max_range_m, range, [&](const int* valid, RTCRayHit8* p) {
        rtcIntersect8(valid, scene_, &context, p);
      });
    } else if (mode == EmbreeMode::kPacket16) {
      packets<16, RTCRayHit16>(rays, max_range_m, range, [&](const int* valid, RTCRayHit16* p) {
        rtcIntersect16(valid, scene_, &context, p);
      });
    } else {
      for (size_t i = 0; i < rays.size(); ++i) {
        const Vec3f o = rays[i].origin.cast<float>(), d = rays[i].direction.cast<float>();
        RTCRayHit ray{};
        ray.ray = {o.x(), o.y(), o.z(), 0, d.x(), d.y(), d.z(), 0, max_range_m, ~0u, 0, 0};
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &ray);
        range[i] = ray.ray.tfar;
      }
    }
  }

 private:
  explicit Embree(const char* config) : device_(rtcNewDevice(config)) {
    const auto count = [](void* sum, ssize_t bytes, bool) {
      *static_cast<std::atomic<ssize_t>*>(sum) += bytes;
      return true;
    };
    rtcSetDeviceMemoryMonitorFunction(device_, count, &bytes_);
  }

  RTCScene scene_of(const elements::TriangleMesh& mesh, RTCBuildQuality quality) const {
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene, quality);
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.vertices.size()));
    for (const Vec3f& p : mesh.vertices) v = std::copy_n(p.data(), 3, v);
    auto* t = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.size()));
    for (const auto& corners : mesh.triangles) t = std::copy(corners.begin(), corners.end(), t);
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(scene);
    return scene;
  }

  template <size_t kSize, class Packet, class Trace>
  static void packets(std::span<const Ray> rays, float max_range_m, std::span<float> range,
                      Trace trace) {
    alignas(64) int valid[kSize];
    alignas(64) Packet p;
    for (size_t i = 0; i < rays.size(); i += kSize) {
      const size_t n = std::min(kSize, rays.size() - i);
      for (size_t k = 0; k < kSize; ++k) {
        const Ray& ray = rays[i + std::min(k, n - 1)];
        valid[k] = k < n ? -1 : 0;
        p.ray.org_x[k] = float(ray.origin[0]);
        p.ray.org_y[k] = float(ray.origin[1]);
        p.ray.org_z[k] = float(ray.origin[2]);
        p.ray.dir_x[k] = float(ray.direction[0]);
        p.ray.dir_y[k] = float(ray.direction[1]);
        p.ray.dir_z[k] = float(ray.direction[2]);
        p.ray.tnear[k] = p.ray.time[k] = 0;
        p.ray.tfar[k] = max_range_m;
        p.ray.mask[k] = ~0u;
        p.ray.id[k] = p.ray.flags[k] = 0;
        p.hit.geomID[k] = p.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      }
      trace(valid, &p);
      for (size_t k = 0; k < n; ++k) range[i + k] = p.ray.tfar[k];
    }
  }

  std::atomic<ssize_t> bytes_ = 0;
  RTCDevice device_;
  RTCScene scene_ = nullptr;
  std::vector<RTCScene> parts_;
};

}  // namespace underbrush::bench
