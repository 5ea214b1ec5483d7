#include "underbrush/elements/keyframes_file.hpp"

#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/io/ply.hpp"

namespace underbrush::elements {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

template <class T, class Row, class F>
std::vector<T> column_of(const std::vector<const std::vector<Row>*>& rows, F value) {
  std::vector<T> out;
  for (const std::vector<Row>* frame : rows) {
    for (const Row& row : *frame) out.push_back(T(value(row)));
  }
  return out;
}

Json json_of_weights(const Keyframes& k) {
  Json list = Json::array();
  for (const KeyframeWeights& t : k.weights) {
    if (t.elements == 1) {
      list.push_back(nullptr);
      continue;
    }
    list.push_back({{"elements", t.elements},
                    {"pixels", t.pixel},
                    {"scales", t.scale},
                    {"sigma_m", t.sigma_m}});
  }
  return list;
}

template <size_t kCount>
std::array<double, kCount> array_of(const io::JsonValue& j) {
  const std::vector<double> values = j.numbers();
  if (values.size() != kCount) j.fail("needs " + std::to_string(kCount) + " numbers");
  std::array<double, kCount> out;
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

void read_weights(const io::JsonValue& j, Keyframes& k) {
  const std::vector<io::JsonValue> list = j.values();
  if (list.size() != k.weights.size()) j.fail("another number of situations");
  for (size_t s = 0; s < list.size(); ++s) {
    if (list[s].is_null()) continue;
    k.weights[s] = {list[s].at("elements").number(),
                    array_of<KeyframeWeights::kPixels>(list[s].at("pixels")),
                    array_of<KeyframeWeights::kScales>(list[s].at("scales")),
                    array_of<KeyframeWeights::kScales>(list[s].at("sigma_m"))};
  }
}

void read_pixels(const fs::path& file, Keyframes& k) {
  const io::PlyData data = io::read_ply(file);
  const io::PlyElement &pixel = element_of(file, data, "pixel"),
                       &column = element_of(file, data, "column");
  if (pixel.count != k.frames.size() * k.pixels() || column.count != k.frames.size() * k.columns) {
    throw FormatError(file.string(), "", "not as many pixels and columns as the frames have");
  }
  const auto& x = io::column_of<int16_t>(file, pixel, "x");
  const auto& y = io::column_of<int16_t>(file, pixel, "y");
  const auto& z = io::column_of<int16_t>(file, pixel, "z");
  const auto& intensity = io::column_of<uint16_t>(file, pixel, "intensity");
  const auto& ox = io::column_of<float>(file, column, "x");
  const auto& oy = io::column_of<float>(file, column, "y");
  const auto& oz = io::column_of<float>(file, column, "z");
  for (size_t f = 0; f < k.frames.size(); ++f) {
    for (size_t p = f * k.pixels(); p < (f + 1) * k.pixels(); ++p) {
      k.frames[f].pixels.push_back({x[p], y[p], z[p], intensity[p]});
    }
    for (size_t c = f * k.columns; c < (f + 1) * k.columns; ++c) {
      k.frames[f].column_origin.emplace_back(ox[c], oy[c], oz[c]);
    }
  }
}

}  // namespace

void write_keyframes(const fs::path& folder, const Keyframes& k) {
  std::vector<const std::vector<KeyframePixel>*> pixels;
  std::vector<const std::vector<Vec3f>*> origins;
  for (const Keyframe& f : k.frames) {
    pixels.push_back(&f.pixels);
    origins.push_back(&f.column_origin);
  }
  io::PlyElement pixel, column;
  pixel.name = "pixel";
  pixel.count = k.frames.size() * k.pixels();
  using P = KeyframePixel;
  pixel.columns = {
      {"x", column_of<int16_t>(pixels, [](const P& p) { return p.x; })},
      {"y", column_of<int16_t>(pixels, [](const P& p) { return p.y; })},
      {"z", column_of<int16_t>(pixels, [](const P& p) { return p.z; })},
      {"intensity", column_of<uint16_t>(pixels, [](const P& p) { return p.intensity; })}};
  column.name = "column";
  column.count = k.frames.size() * k.columns;
  column.columns = {{"x", column_of<float>(origins, [](const Vec3f& o) { return o.x(); })},
                    {"y", column_of<float>(origins, [](const Vec3f& o) { return o.y(); })},
                    {"z", column_of<float>(origins, [](const Vec3f& o) { return o.z(); })}};
  io::PlyData data;
  data.elements = {std::move(pixel), std::move(column)};
  io::write_ply(folder / kKeyframesFile, data);
}

std::string manifest_of_keyframes(const Keyframes& k) {
  Json frames = Json::array();
  for (const Keyframe& f : k.frames) {
    const Eigen::Quaterniond& q = f.sensor_from_world;
    frames.push_back({{"origin_m", {f.origin.x(), f.origin.y(), f.origin.z()}},
                      {"sensor_from_world_wxyz", {q.w(), q.x(), q.y(), q.z()}}});
  }
  return Json{{"file", kKeyframesFile},      {"elevation_rad", k.elevation},
              {"channels", k.channel},       {"columns", k.columns},
              {"unit_m", k.unit_m},          {"intensity_unit", k.intensity_unit},
              {"frames", std::move(frames)}, {"trust", json_of_weights(k)}}
      .dump();
}

std::shared_ptr<const Keyframes> read_keyframes(const io::JsonValue& j) {
  auto k = std::make_shared<Keyframes>();
  k->elevation = j.at("elevation_rad").numbers();
  for (const double ring : j.at("channels").numbers()) {
    if (!(ring >= 0 && ring <= 65535)) j.at("channels").fail("no numbers of channels");
    k->channel.push_back(uint16_t(ring));
  }
  k->columns = j.at("columns").count(1 << 20);
  if (k->elevation.size() > 1 << 16) j.at("elevation_rad").fail("too many rows");
  k->unit_m = j.at("unit_m").number();
  k->intensity_unit = j.at("intensity_unit").number();
  for (const io::JsonValue& f : j.at("frames").values()) {
    Keyframe frame;
    frame.origin = f.at("origin_m").vector();
    const auto q = array_of<4>(f.at("sensor_from_world_wxyz"));
    frame.sensor_from_world = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    k->frames.push_back(std::move(frame));
  }
  read_weights(j.at("trust"), *k);
  read_pixels(j.at("file").path(), *k);
  return k;
}

}  // namespace underbrush::elements
