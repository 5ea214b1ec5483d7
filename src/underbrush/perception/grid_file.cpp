#include "underbrush/perception/grid_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "underbrush/io/json_text.inl"

namespace underbrush::perception {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kNames{"unknown", "free", "permeable", "solid"};
constexpr std::array<std::array<uint8_t, 3>, 4> kColours{
    {{190, 190, 190}, {255, 255, 255}, {90, 160, 60}, {0, 0, 0}}};

double millimetres(double m) { return std::round(1000 * m) / 1000; }

// The labels and the lengths of runs in turn.
Json runs_of(const std::vector<CellLabel>& labels) {
  Json runs = Json::array();
  for (size_t begin = 0, end = 0; begin < labels.size(); begin = end) {
    while (end < labels.size() && labels[end] == labels[begin]) ++end;
    runs.push_back(int(labels[begin]));
    runs.push_back(end - begin);
  }
  return runs;
}

}  // namespace

std::vector<CellLabel> cell_labels(const OccupancyGrid& grid, double probability) {
  std::vector<CellLabel> labels(grid.columns() * grid.columns());
  for (size_t k = 0; k < labels.size(); ++k) {
    const auto p = grid.probability(k);
    const auto most = std::max_element(p.begin(), p.end());
    if (*most >= probability) labels[k] = CellLabel(1 + (most - p.begin()));
  }
  return labels;
}

io::Image picture_of_grid(const OccupancyGrid& grid, double probability) {
  const size_t n = grid.columns();
  const std::vector<CellLabel> labels = cell_labels(grid, probability);
  io::Image image{int(n), int(n)};
  for (size_t y = 0; y < n; ++y) {
    for (size_t x = 0; x < n; ++x) {
      const auto& colour = kColours[size_t(labels[y * n + x])];
      std::copy(colour.begin(), colour.end(), &image.rgb[3 * ((n - 1 - y) * n + x)]);
    }
  }
  return image;
}

GridWriter::GridWriter(const std::filesystem::path& path, const std::string& provenance,
                       const FreeAreaOptions& area)
    : area_(area), file_(path), out_(file_.temporary(), path.string()) {
  Json head;
  head["format"] = "underbrush-occupancy-grids";
  head["version"] = 1;
  head["provenance"] = provenance.empty() ? Json::object() : io::json_of_text(provenance);
  head["labels"] = kNames;
  std::string text = io::text_of_json(head);
  text.pop_back();
  text += ",\n\"grids\": [";
  out_.append(text.data(), text.size());
}

void GridWriter::write(const OccupancyGrid& grid, const Pose& world_from_vehicle, double time_s) {
  find_free_area(grid, world_from_vehicle, area_, outline_);
  Json j;
  j["time"] = time_s;
  j["cell"] = grid.cell_m();
  j["corner"] = grid.corner_m();
  j["columns"] = j["rows"] = grid.columns();
  j["free_area"] = Json::array();
  for (const Vec3& corner : outline_) {
    j["free_area"].push_back({millimetres(corner.x()), millimetres(corner.y())});
  }
  j["runs"] = runs_of(cell_labels(grid, area_.free_probability));
  const std::string text = (is_first_ ? "\n " : ",\n ") + io::text_of_json(j);
  is_first_ = false;
  out_.append(text.data(), text.size());
}

void GridWriter::close() {
  const std::string end = "\n]}\n";
  out_.append(end.data(), end.size());
  out_.close();
  file_.commit();
}

}  // namespace underbrush::perception
