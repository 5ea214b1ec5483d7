#include "underbrush/fit/training_file.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/fit/fitters.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/ply.hpp"

namespace underbrush::fit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using ground::kPointCouplings;
using ground::SparseSums;
using io::PlyElement;

constexpr uint64_t kVersion = 1;
constexpr double kMostTileM = 1e6;  ///< The greatest value of --tile.
constexpr const char* kFolder = "training";
constexpr const char* kSums[kPointCouplings] = {"self", "east", "north", "north_east",
                                                "north_west"};

template <class T, class Rows, class F>
void add_column(PlyElement& element, const char* name, const Rows& rows, F value) {
  std::vector<T> column;
  column.reserve(rows.size());
  for (const auto& row : rows) column.push_back(T(value(row)));
  element.count = column.size();
  element.columns.emplace_back(name, std::move(column));
}

void write_table(const fs::path& file, PlyElement element) {
  io::PlyData data;
  data.comments = {"Underbrush"};
  data.elements.push_back(std::move(element));
  io::write_ply(file, data);
}

PlyElement table_of(const std::vector<TileRecord>& tiles) {
  using Tile = TileRecord;
  PlyElement t;
  t.name = "tile";
  add_column<int32_t>(t, "i", tiles, [](const Tile& r) { return r.key.i; });
  add_column<int32_t>(t, "j", tiles, [](const Tile& r) { return r.key.j; });
  add_column<double>(t, "points", tiles, [](const Tile& r) { return r.points; });
  add_column<double>(t, "later", tiles, [](const Tile& r) { return r.later; });
  add_column<double>(t, "unexplained", tiles, [](const Tile& r) { return r.unexplained; });
  add_column<uint32_t>(t, "ellipsoids", tiles, [](const Tile& r) { return r.ellipsoids; });
  add_column<double>(t, "ground_points", tiles, [](const Tile& r) { return r.ground.n; });
  add_column<double>(t, "ground_z", tiles, [](const Tile& r) { return r.ground.z; });
  add_column<double>(t, "ground_zz", tiles, [](const Tile& r) { return r.ground.zz; });
  add_column<uint32_t>(t, "nodes", tiles, [](const Tile& r) { return r.ground.nodes.size(); });
  return t;
}

PlyElement table_of(const std::vector<SparseSums::Node>& nodes) {
  using Node = SparseSums::Node;
  PlyElement t;
  t.name = "node";
  add_column<int32_t>(t, "block_x", nodes, [](const Node& n) { return n.block.x; });
  add_column<int32_t>(t, "block_y", nodes, [](const Node& n) { return n.block.y; });
  add_column<uint16_t>(t, "place", nodes, [](const Node& n) { return n.place; });
  for (size_t c = 0; c < kPointCouplings; ++c) {
    add_column<double>(t, kSums[c], nodes, [c](const Node& n) { return n.sums.a[c]; });
  }
  add_column<double>(t, "height", nodes, [](const Node& n) { return n.sums.b; });
  return t;
}

/// A file with one table of numbers.
class Table {
 public:
  Table(fs::path file, const char* element) : file_(std::move(file)), data_(io::read_ply(file_)) {
    element_ = data_.find(element);
    if (!element_) fail(std::string("no element ") + element);
  }
  size_t rows() const { return element_->count; }
  template <class T>
  const std::vector<T>& column(const char* name) const {
    const ExtraColumn* column = element_->find(name);
    const auto* values = column ? std::get_if<std::vector<T>>(column) : nullptr;
    if (!values) fail(std::string("no column ") + name);
    if constexpr (std::is_same_v<T, double>) {
      for (const double x : *values) {
        if (!std::isfinite(x)) fail(std::string("not finite: ") + name);
      }
    }
    return *values;
  }
  /// A column of counts.
  std::vector<uint64_t> counts(const char* name) const {
    std::vector<uint64_t> out;
    for (const double x : column<double>(name)) {
      if (!(x >= 0 && x <= double(uint64_t(1) << 53))) fail(std::string("not a count: ") + name);
      out.push_back(uint64_t(x));
    }
    return out;
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw FormatError(file_.string(), "", why);
  }

 private:
  fs::path file_;
  io::PlyData data_;
  const PlyElement* element_ = nullptr;
};

std::vector<SparseSums::Node> read_nodes(const fs::path& file) {
  const Table t(file, "node");
  const auto &x = t.column<int32_t>("block_x"), &y = t.column<int32_t>("block_y");
  const auto& place = t.column<uint16_t>("place");
  const auto& height = t.column<double>("height");
  std::vector<SparseSums::Node> out(t.rows());
  for (size_t k = 0; k < out.size(); ++k) {
    constexpr int kMostBlocks = 1 << 23;
    if (std::max(std::abs(double(x[k])), std::abs(double(y[k]))) > kMostBlocks ||
        place[k] >= ground::kSumSide * ground::kSumSide) {
      t.fail("a node is out of range");
    }
    out[k] = {{y[k], x[k]}, place[k], {{}, height[k]}};
  }
  for (size_t c = 0; c < kPointCouplings; ++c) {
    const auto& sums = t.column<double>(kSums[c]);
    for (size_t k = 0; k < out.size(); ++k) out[k].sums.a[c] = sums[k];
  }
  return out;
}

std::vector<TileRecord> read_tiles(const fs::path& folder) {
  const Table t(folder / "tiles.ply", "tile");
  std::vector<SparseSums::Node> nodes = read_nodes(folder / "ground.ply");
  const auto &i = t.column<int32_t>("i"), &j = t.column<int32_t>("j");
  const auto points = t.counts("points"), later = t.counts("later"),
             unexplained = t.counts("unexplained"), ground_points = t.counts("ground_points");
  const auto &z = t.column<double>("ground_z"), &zz = t.column<double>("ground_zz");
  const auto &ellipsoids = t.column<uint32_t>("ellipsoids"), &count = t.column<uint32_t>("nodes");
  std::vector<TileRecord> out(t.rows());
  size_t next = 0;
  for (size_t k = 0; k < out.size(); ++k) {
    out[k] = {{i[k], j[k]}, points[k], later[k], unexplained[k], ellipsoids[k], {}};
    if (k > 0 && !(out[k - 1].key < out[k].key)) t.fail("the tiles are not in ascending order");
    if (count[k] > nodes.size() - next) t.fail("it has more nodes than ground.ply");
    const auto first = nodes.begin() + ptrdiff_t(next);
    out[k].ground = {ground_points[k], z[k], zz[k], {first, first + count[k]}};
    next += count[k];
  }
  if (next != nodes.size()) t.fail("it has fewer nodes than ground.ply");
  return out;
}

std::vector<uint32_t> read_residuals(const fs::path& folder) {
  const Table t(folder / "residuals.ply", "residual");
  std::vector<uint32_t> out = t.column<uint32_t>("count");
  if (!out.empty() && out.size() != credit::MeshResiduals(1).counts().size())
    t.fail("a row is missing");
  return out;
}

LastReturns read_last_returns(const io::JsonValue& j) {
  LastReturns out;
  const io::JsonValue largest = j.at("largest_m"), counts = j.at("counts");
  out.largest_m = float(largest.number());
  if (!(out.largest_m >= 0 && std::isfinite(out.largest_m))) largest.fail("not a range");
  for (const io::JsonValue& count : counts.values()) {
    out.counts.push_back(uint32_t(count.count(UINT32_MAX)));
  }
  if (out.counts.size() > RangeCut::kMostCounts) counts.fail("too many");
  return out;
}

/// Reads the value of a parameter into its field.
void read_parameter(const Parameter& p, const io::JsonValue& value, FitOptions& options) {
  std::visit(
      [&](const auto field) {
        auto& place = field(options);
        using T = std::decay_t<decltype(place)>;
        if constexpr (std::is_same_v<T, std::string>) {
          place = value.text();
        } else if constexpr (std::is_same_v<T, bool>) {
          place = value.boolean();
        } else if constexpr (std::is_arithmetic_v<T>) {
          place = T(std::is_same_v<T, double> ? value.number() : double(value.count(1 << 30)));
        }
      },
      p.field);
  const std::string expected = wrong_value(p, options);
  if (!expected.empty()) value.fail("it is " + expected);
}

}  // namespace

void write_training(const fs::path& model, const Training& training) {
  const fs::path folder = model / kFolder;
  make_temporary_folders(folder);
  std::vector<SparseSums::Node> nodes;
  for (const TileRecord& tile : training.record.tiles) {
    nodes.insert(nodes.end(), tile.ground.nodes.begin(), tile.ground.nodes.end());
  }
  write_table(folder / "tiles.ply", table_of(training.record.tiles));
  write_table(folder / "ground.ply", table_of(nodes));
  PlyElement residuals;
  residuals.name = "residual";
  add_column<uint32_t>(residuals, "count", training.record.residuals, [](uint32_t n) { return n; });
  write_table(folder / "residuals.ply", std::move(residuals));
  FitOptions options = training.options;
  Json j{{"format", "underbrush-training"}, {"version", kVersion}};
  j["seed"] = options.seed;
  for (const Parameter& p : parameters()) {
    std::visit([&](const auto field) { j["parameters"][std::string(p.name)] = field(options); },
               p.field);
  }
  if (!options.sensor.empty()) j["sensor"] = options.sensor;
  if (!options.sensor_file.empty()) j["sensor_file"] = options.sensor_file;
  j["footprint"] = training.footprint;
  j["logs"] = Json::array();
  for (const TrainingLog& log : training.logs) {
    j["logs"].push_back({{"file", log.file}, {"hash", log.hash}, {"beams", log.beams}});
  }
  j["tile_m"] = training.record.tile_m;
  const LastReturns& last = training.record.last_returns;
  j["last_returns"] = {{"largest_m", last.largest_m}, {"counts", last.counts}};
  write_file(folder / "training.json", io::text_of_json(j, 2) + "\n");
}

bool has_training(const fs::path& model) {
  return fs::is_regular_file(model / kFolder / "training.json");
}

Training read_training(const fs::path& model) {
  const fs::path folder = model / kFolder;
  const io::JsonFile json(folder / "training.json");
  const io::JsonValue j =
      json.manifest("underbrush-training", kVersion, "the training of an underbrush model");
  Training out;
  out.options.seed = j.at("seed").count(UINT64_MAX);
  const io::JsonValue given = j.at("parameters");
  for (const Parameter& p : parameters()) {
    if (const auto value = given.find(std::string(p.name).c_str())) {
      read_parameter(p, *value, out.options);
    }
  }
  try {
    fitter_named(out.options.fitter);
    start_of(out.options);
  } catch (const std::invalid_argument& e) {
    given.fail(e.what());
  }
  if (const auto sensor = j.find("sensor")) out.options.sensor = sensor->text();
  if (const auto file = j.find("sensor_file")) out.options.sensor_file = file->text();
  out.footprint = j.at("footprint").boolean();
  for (const io::JsonValue& log : j.at("logs").values()) {
    if (log.at("file").text().empty()) log.at("file").fail("no name");
    out.logs.push_back({log.at("file").text(), log.at("hash").text(), log.at("beams").count()});
  }
  out.record.tile_m = j.at("tile_m").number();
  if (!(out.record.tile_m >= 1 && out.record.tile_m <= kMostTileM)) {
    j.at("tile_m").fail("not a side of tiles");
  }
  if (const auto last = j.find("last_returns")) out.record.last_returns = read_last_returns(*last);
  out.record.tiles = read_tiles(folder);
  out.record.residuals = read_residuals(folder);
  return out;
}

}  // namespace underbrush::fit
