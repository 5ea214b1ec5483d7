#include "underbrush/elements/observed_space_file.hpp"

#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/io/ply.hpp"

namespace underbrush::elements {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

void read_blocks(const fs::path& file, ObservedSpace& space) {
  const io::PlyData data = io::read_ply(file);
  const io::PlyElement& block = element_of(file, data, "block");
  const auto& x = io::column_of<int32_t>(file, block, "x");
  const auto& y = io::column_of<int32_t>(file, block, "y");
  const auto& z = io::column_of<int32_t>(file, block, "z");
  const auto& beams = io::column_of<uint8_t>(file, element_of(file, data, "cell"), "beams");
  if (beams.size() != x.size() * ObservedBlock::kCells) {
    throw FormatError(file.string(), "cell",
                      "not " + std::to_string(ObservedBlock::kCells) + " cells a block");
  }
  const io::PlyElement& squares = element_of(file, data, "lost");
  const auto& lost_x = io::column_of<int32_t>(file, squares, "x");
  const auto& lost_y = io::column_of<int32_t>(file, squares, "y");
  const auto& lost = io::column_of<uint32_t>(file, squares, "beams");
  for (size_t k = 0; k < lost.size(); ++k) space.lost.push_back({{lost_x[k], lost_y[k]}, lost[k]});
  space.blocks.resize(x.size());
  for (size_t k = 0; k < x.size(); ++k) {
    space.blocks[k].at = {x[k], y[k], z[k]};
    std::copy_n(&beams[k * ObservedBlock::kCells], ObservedBlock::kCells,
                space.blocks[k].beams.begin());
  }
}

}  // namespace

void write_observed_space(const fs::path& folder, const ObservedSpace& space) {
  std::vector<int32_t> at[3];
  std::vector<uint8_t> beams;
  for (const ObservedBlock& b : space.blocks) {
    at[0].push_back(b.at.x);
    at[1].push_back(b.at.y);
    at[2].push_back(b.at.z);
    beams.insert(beams.end(), b.beams.begin(), b.beams.end());
  }
  io::PlyElement block, cell;
  block.name = "block";
  block.count = space.blocks.size();
  block.columns = {{"x", std::move(at[0])}, {"y", std::move(at[1])}, {"z", std::move(at[2])}};
  cell.name = "cell";
  cell.count = beams.size();
  cell.columns = {{"beams", std::move(beams)}};
  io::PlyElement lost;
  lost.name = "lost";
  lost.count = space.lost.size();
  std::vector<int32_t> lost_at[2];
  std::vector<uint32_t> lost_beams;
  for (const LostBeams& l : space.lost) {
    lost_at[0].push_back(l.at.x);
    lost_at[1].push_back(l.at.y);
    lost_beams.push_back(l.beams);
  }
  lost.columns = {
      {"x", std::move(lost_at[0])}, {"y", std::move(lost_at[1])}, {"beams", std::move(lost_beams)}};
  io::PlyData data;
  data.elements = {std::move(block), std::move(cell), std::move(lost)};
  io::write_ply(folder / kObservedSpaceFile, data);
}

std::string manifest_of_observed_space(const ObservedSpace& space) {
  return Json{{"file", kObservedSpaceFile},
              {"cell_m", space.cell_m},
              {"top_m", space.top_m},
              {"blocks", space.blocks.size()},
              {"heights_m", ObservedSpace::kHeightsM},
              {"ranges_m", ObservedSpace::kRangesM},
              {"density_per_m", space.density_per_m},
              {"ground_returns", space.ground_returns}}
      .dump();
}

std::shared_ptr<const ObservedSpace> read_observed_space(const io::JsonValue& j) {
  auto space = std::make_shared<ObservedSpace>();
  space->cell_m = j.at("cell_m").number();
  if (const auto top = j.find("top_m")) space->top_m = top->number();
  const std::vector<io::JsonValue> rows = j.at("density_per_m").values();
  if (rows.size() != ObservedSpace::kHeights)
    j.at("density_per_m").fail("another number of heights");
  for (size_t h = 0; h < rows.size(); ++h) {
    const std::vector<double> row = rows[h].numbers();
    if (row.size() != ObservedSpace::kRanges) rows[h].fail("another number of ranges");
    for (size_t r = 0; r < row.size(); ++r) space->density_per_m[h][r] = float(row[r]);
  }
  const std::vector<double> returns = j.at("ground_returns").numbers();
  if (returns.size() != ObservedSpace::kRanges)
    j.at("ground_returns").fail("another number of ranges");
  std::copy(returns.begin(), returns.end(), space->ground_returns.begin());
  read_blocks(j.at("file").path(), *space);
  return space;
}

}  // namespace underbrush::elements
