#include "underbrush/regions/site_folder.hpp"

#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/primitives/annotation.hpp"

namespace underbrush::regions {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSiteFile = "site.json";

fs::path name_of(const Cell2& place) {
  return fs::path("parts") / (std::to_string(place.x) + "_" + std::to_string(place.y));
}

/// Generates the parts of a site one after another.
class PartMaker {
 public:
  PartMaker(const test_site::TerrainParameters& parameters, double spacing_m, double sigma_m,
            const sites::GenerateOptions& options, double side_m)
      : terrain_(parameters, options.seed),
        spacing_m_(spacing_m),
        sigma_m_(sigma_m),
        cells_(std::max<int32_t>(1, int32_t(std::lround(side_m / spacing_m)))),
        grid_(terrain_.grid(spacing_m, 0)),
        size_m_(parameters.size_x_m, parameters.size_y_m),
        generator_(options, box_of({0, 0}, grid_)) {}

  /// The numbers of columns and rows of parts.
  Cell2 count() const { return {(grid_.x - 1) / cells_ + 1, (grid_.y - 1) / cells_ + 1}; }
  double side_m() const { return cells_ * spacing_m_; }
  double south_m(int32_t row) const { return box_of({0, row * cells_}, grid_).min().y(); }

  /// Makes the objects of a part, and its ground. Parts are asked for row by row.
  std::vector<primitives::PlacedObject> make(const Cell2& place, elements::Model& ground) {
    const Cell2 first{place.x * cells_, place.y * cells_};
    const Cell2 end{std::min(first.x + cells_, grid_.x), std::min(first.y + cells_, grid_.y)};
    ground = {};
    ground.ground = terrain_.mesh(spacing_m_, 0, first, end);
    ground.ground.range_sigma_m = sigma_m_;
    ground.fitter = "generated_ground";
    const Eigen::AlignedBox2d box = box_of(first, end);
    if (place.x == 0) generator_.forget_below(box.min().y() - kReachM);
    const uint64_t number = uint64_t(uint32_t(place.y)) << 32 | uint32_t(place.x);
    return generator_.objects(primitives::GroundSurface(ground), box, number + 1).objects;
  }

 private:
  static constexpr double kReachM = 100;  // m; more than the largest crowns

  Eigen::AlignedBox2d box_of(const Cell2& first, const Cell2& end) const {
    const auto at = [&](const Cell2& c) {
      return Eigen::Vector2d(size_m_.x() * (double(c.x) / double(grid_.x) - 0.5),
                             size_m_.y() * (double(c.y) / double(grid_.y) - 0.5));
    };
    return {at(first), at(end)};
  }

  test_site::Terrain terrain_;
  double spacing_m_, sigma_m_;
  int32_t cells_;  // along a side of a part
  Cell2 grid_;
  Eigen::Vector2d size_m_;
  sites::SiteGenerator generator_;
};

}  // namespace

GeneratedSite generate_site(const fs::path& path, const test_site::TerrainParameters& terrain,
                            double spacing_m, double ground_sigma_m,
                            const sites::GenerateOptions& options, double side_m,
                            const std::string& provenance, const PartProgress& progress) {
  PartMaker maker(terrain, spacing_m, ground_sigma_m, options, side_m);
  check_site_output(path);
  io::AtomicFile folder(path, io::OutputKind::kFolder);
  const fs::path written = fs::absolute(folder.temporary()).lexically_normal();
  make_temporary_folders(written / "parts");
  GeneratedSite out;
  const Cell2 count = maker.count();
  Json rows = Json::array();
  for (int32_t y = 0; y < count.y; ++y) rows.push_back(maker.south_m(y));
  for (int32_t y = 0; y < count.y; ++y) {
    for (int32_t x = 0; x < count.x; ++x) {
      elements::Model ground;
      primitives::Annotation part;
      part.objects = maker.make({x, y}, ground);
      const fs::path name = written / name_of({x, y});
      part.ground = name;
      elements::write_model(name, ground);
      primitives::write_annotation(name.string() + ".json", part);
      for (const primitives::PlacedObject& o : part.objects) ++out.objects[o.label];
      out.triangles += ground.ground.size();
      ++out.parts;
      if (progress) progress(out.parts, size_t(count.x) * size_t(count.y));
    }
  }
  Json j{{"format", "underbrush-site"}, {"version", kSiteVersion}, {"side_m", maker.side_m()}};
  j["columns"] = count.x;
  j["south_m"] = std::move(rows);
  j["provenance"] = io::json_of_text(provenance);
  write_file(folder.temporary() / kSiteFile, io::text_of_json(j, 1) + "\n");
  folder.commit();
  return out;
}

bool is_site(const fs::path& path) { return fs::is_regular_file(path / kSiteFile); }

void check_site_output(const fs::path& path) {
  io::check_output_folder(path, is_site(path), "not a site");
}

SiteFolder read_site(const fs::path& path) {
  const io::JsonFile json(path / kSiteFile);
  const io::JsonValue j = json.manifest("underbrush-site", kSiteVersion, "an underbrush site");
  j.check_members(
      {"$schema", "format", "version", "comment", "side_m", "columns", "south_m", "provenance"});
  SiteFolder site;
  site.side_m = j.at("side_m").number();
  if (!(site.side_m > 0)) j.at("side_m").fail("must be positive");
  const auto columns = int32_t(j.at("columns").count(1 << 20));
  const std::vector<double> south_m = j.at("south_m").numbers();
  const auto annotation = [&](const Cell2& place) {
    return path / (name_of(place).string() + ".json");
  };
  const Cell2 last{columns - 1, int32_t(south_m.size()) - 1};
  if (last.x >= 0 && last.y >= 0 && !fs::is_regular_file(annotation(last))) {
    j.at("columns").fail("the part of the last column and row is missing");
  }
  for (const Cell2& beyond : {Cell2{columns, 0}, Cell2{0, int32_t(south_m.size())}}) {
    if (fs::exists(annotation(beyond))) j.at("columns").fail("there are more parts than it states");
  }
  for (int32_t y = 0; y < int32_t(south_m.size()); ++y) {
    for (int32_t x = 0; x < columns; ++x) {
      site.parts.push_back({{x, y}, annotation({x, y}), south_m[size_t(y)]});
    }
  }
  return site;
}

}  // namespace underbrush::regions
