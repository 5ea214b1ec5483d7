#include "arrow_tables.hpp"

#include <nlohmann/json.hpp>

namespace underbrush::python {
namespace {

using elements::Kind;

template <class T>
ArrowColumn column(const char* name, const std::vector<T>& values) {
  return {name, arrow_format<T>(), 0, values.data()};
}

template <class T, size_t Width>
ArrowColumn lists(const char* name, const std::vector<std::array<T, Width>>& values) {
  return {name, arrow_format<T>(), int(Width), values.data()};
}

/// The facts about a log but for its scans, of which there may be many.
std::string json_of(const LogInfo& info) {
  const nlohmann::ordered_json j = {{"sensor", info.sensor},
                                    {"sensor_file", info.sensor_file},
                                    {"min_range_m", info.min_range_m},
                                    {"max_range_m", info.max_range_m},
                                    {"has_misses", info.has_misses},
                                    {"classes", info.classes},
                                    {"element_classes", info.element_classes},
                                    {"deskewed", info.deskewed}};
  return j.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

/// The columns of a model's table.
struct ElementColumns {
  std::vector<uint8_t> kind;
  std::vector<std::array<double, 3>> centre;
  std::vector<std::array<float, 6>> covariance;
  std::vector<uint8_t> is_ellipsoid;  ///< A bit a row.
  std::vector<float> hit_probability, density_per_m;
  std::vector<uint32_t> hits, misses, label;

  void add(Kind k, const Vec3& at, const elements::HitCount& hit) {
    kind.push_back(uint8_t(k));
    centre.push_back({at.x(), at.y(), at.z()});
    hit_probability.push_back(hit.p);
    hits.push_back(hit.hits);
    misses.push_back(hit.misses);
  }
};

ElementColumns columns_of(const elements::Model& model) {
  ElementColumns out;
  for (const Kind kind : {Kind::kGround, Kind::kSurface}) {
    const elements::TriangleMesh& mesh = model.mesh(kind);
    for (size_t i = 0; i < mesh.size(); ++i) {
      Vec3 sum = Vec3::Zero();
      for (const uint32_t v : mesh.triangles[i]) sum += mesh.vertices[v].cast<double>();
      out.add(kind, model.origin + sum / 3, mesh.hit[i]);
    }
  }
  out.covariance.resize(out.kind.size());
  out.label.resize(out.kind.size());
  out.density_per_m.resize(out.kind.size());
  for (const elements::Ellipsoid& e : model.ellipsoids) {
    out.add(Kind::kEllipsoid, model.origin + e.mean.cast<double>(), e.hit);
    out.covariance.push_back(e.covariance);
    out.label.push_back(e.label);
    out.density_per_m.push_back(e.density_per_m);
  }
  out.is_ellipsoid.resize((model.size() + 7) / 8);
  for (size_t i = model.triangle_count(); i < model.size(); ++i) {
    out.is_ellipsoid[i / 8] |= uint8_t(1 << i % 8);
  }
  return out;
}

}  // namespace

ArrowTable table_of(const BeamLog& log, std::shared_ptr<const void> owner) {
  ArrowTable out;
  out.columns = {{"origin", "g", 3, log.origin.data()},
                 {"direction", "f", 3, log.direction.data()},
                 column("range_m", log.range_m),
                 column("intensity", log.intensity),
                 column("time_s", log.time_s),
                 column("ring", log.ring),
                 column("scan", log.scan),
                 column("packet", log.packet),
                 column("flags", log.flags)};
  for (const auto& [name, values] : log.extra) {
    out.columns.push_back(
        std::visit([&](const auto& v) { return column(name.c_str(), v); }, values));
  }
  out.rows = int64_t(log.size());
  out.owner = std::move(owner);
  out.metadata = json_of(log.info);
  return out;
}

ArrowTable table_of(const elements::Model& model) {
  const auto c = std::make_shared<const ElementColumns>(columns_of(model));
  ArrowTable out;
  out.columns = {column("kind", c->kind),
                 lists("centre", c->centre),
                 lists("covariance", c->covariance),
                 column("hit_probability", c->hit_probability),
                 column("hits", c->hits),
                 column("misses", c->misses),
                 column("label", c->label),
                 column("density_per_m", c->density_per_m)};
  out.columns[2].valid = c->is_ellipsoid.data();
  out.columns[2].nulls = int64_t(model.triangle_count());
  out.rows = int64_t(model.size());
  out.owner = c;
  return out;
}

}  // namespace underbrush::python
