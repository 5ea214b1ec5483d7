#include "underbrush/osi/chain.hpp"

#include <yaml-cpp/yaml.h>

#include <filesystem>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush::osi {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t kMostChainBytes = 1 << 20;

// A file beside the chain's, or the word itself.
std::string beside(const std::string& chain, const std::string& word) {
  const fs::path path = fs::path(chain).parent_path() / word;
  std::error_code error;  // for a word that no file can be called
  return fs::exists(path, error) ? path.string() : word;
}

StrategyEntry entry_of(const std::string& file, size_t k, const YAML::Node& node) {
  StrategyEntry e;
  e.file = file;
  e.place = "chain[" + std::to_string(k) + "]";
  const auto fail = [&](const std::string& reason) { throw FormatError(file, e.place, reason); };
  if (!node.IsMap()) fail("expected lines of KEY: VALUE");
  for (const auto& line : node) {
    if (!line.first.IsScalar() || !line.second.IsScalar()) fail("expected lines of KEY: VALUE");
    const std::string key = line.first.Scalar(), value = line.second.Scalar();
    if (key == "strategy") {
      e.name = value;
    } else if (key == "library") {
      e.library = beside(file, value);
      if (e.library.find('/') == std::string::npos) e.library = "./" + e.library;
    } else if (!e.parameters.emplace(key, value).second) {
      fail("the parameter " + in_quotes(key) + " occurs twice");
    }
  }
  if (e.name.empty()) fail("names no strategy");
  for (const char* key : {"sensor", "world", "mover_models"}) {
    const auto at = e.parameters.find(key);
    if (at != e.parameters.end()) at->second = beside(file, at->second);
  }
  return e;
}

}  // namespace

bool ChainFile::set(const std::string& strategy, const std::string& key, const std::string& value) {
  bool found = false;
  for (StrategyEntry& e : strategies) {
    if (e.name != strategy) continue;
    e.parameters[key] = value;
    found = true;
  }
  return found;
}

ChainFile read_chain(const std::string& path) {
  const std::string text = read_file(path, kMostChainBytes);
  try {
    const YAML::Node root = YAML::Load(text);
    if (!root.IsMap() || root.size() != 1 || !root["chain"] || !root["chain"].IsSequence() ||
        root["chain"].size() == 0) {
      throw FormatError(path, "", "expected a list of strategies under the key chain");
    }
    ChainFile file;
    const YAML::Node list = root["chain"];
    for (size_t k = 0; k < list.size(); ++k) file.strategies.push_back(entry_of(path, k, list[k]));
    return file;
  } catch (const YAML::Exception& e) {
    throw FormatError(path, "line " + std::to_string(e.mark.line + 1), e.msg);
  }
}

ChainFile default_chain() {
  ChainFile file;
  for (const char* name : {"front_end", "alignment", "tracking", "classification", "grid"}) {
    file.strategies.push_back({name, "", {}, "chain", name});
  }
  return file;
}

ChainFile traced_chain() {
  ChainFile file = default_chain();
  file.strategies.insert(file.strategies.begin(), {"tracer", "", {}, "chain", "tracer"});
  for (const char* name : {"tracer", "front_end"}) file.set(name, "sensor", kTracedSensor);
  file.set("tracer", "x_m", "3.7");
  file.set("tracer", "z_m", "0.3");
  return file;
}

Chain::Chain(const ChainFile& file) {
  for (const StrategyEntry& e : file.strategies) strategies_.push_back(make_strategy(e));
}

SensorData Chain::step(std::shared_ptr<const SensorView> view) {
  SensorData data = begin_data(std::move(view));
  step(data);
  return data;
}

void Chain::step(SensorData& data) {
  for (const auto& s : strategies_) s->step(data);
}

void Chain::reset() {
  for (const auto& s : strategies_) s->reset();
}

Chain Chain::clone() const {
  Chain copy;
  for (const auto& s : strategies_) copy.strategies_.push_back(s->clone());
  return copy;
}

SensorData begin_data(std::shared_ptr<const SensorView> view) {
  require_data(view->timestamp.has_value(), "the SensorView has no time");
  SensorData d;
  d.version = Version{};
  d.timestamp = d.last_measurement_time = view->timestamp;
  d.sensor_id = view->sensor_id.value_or(0);
  d.mounting = view->mounting ? view->mounting : Mounting::of({});
  if (view->truth) {
    const MovingObject* host = view->host();
    require_data(host != nullptr, "the SensorView's ground truth has no host vehicle");
    const Pose pose = world_from_vehicle(*host);
    d.host = host->base;
    d.host->dimension_m.reset();
    d.host->position_m = pose.translation;
  }
  d.views = {std::move(view)};
  return d;
}

SensorData no_data(const std::optional<Timestamp>& time) {
  SensorData d;
  d.version = Version{};
  d.timestamp = d.last_measurement_time = time.value_or(Timestamp{});
  d.sensor_id = 0;
  d.mounting = Mounting::of({});
  d.object_header = ObjectHeader{d.timestamp, std::nullopt, DataQualifier::kNotAvailable};
  LidarDetectionData& l = d.lidar.emplace_back();
  l.header.measurement_time = d.timestamp;
  l.header.qualifier = DataQualifier::kNotAvailable;
  l.header.valid_detections = 0;
  d.logical.emplace();
  d.logical->time = d.timestamp;
  d.logical->qualifier = DataQualifier::kNotAvailable;
  d.logical->valid_detections = 0;
  return d;
}

}  // namespace underbrush::osi
