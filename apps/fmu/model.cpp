#include "model.hpp"

#include <charconv>
#include <cstring>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/readable.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush::fmu {
namespace fs = std::filesystem;
namespace {

std::string text_of(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), size_t(end - buffer.data())};
}

}  // namespace

Values::Values() {
  for (const Variable& v : variables()) {
    const std::string start(v.start);
    if (v.type == Type::kInteger) integer[v.reference] = std::stoi(start);
    if (v.type == Type::kReal) real[v.reference] = std::stod(start);
    if (v.type == Type::kBoolean) integer[v.reference] = start == "true";
    if (v.type == Type::kString) text[v.reference] = start;
  }
}

Model::Model(fs::path resources, Warn warn)
    : resources_(std::move(resources)), warn_(std::move(warn)) {}

std::string_view Model::bytes(uint32_t r) const {
  const auto low = uint32_t(values.integer[r]), high = uint32_t(values.integer[r + 1]);
  const int32_t size = values.integer[r + 2];
  const uint64_t address = uint64_t(high) << 32 | low;
  if (address == 0 || size <= 0) return {};
  const std::string_view message(reinterpret_cast<const char*>(address), size_t(size));  // NOLINT
  require(osi::is_readable(message), "the address and the size of a message lead to no memory");
  return message;
}

void Model::point_to(uint32_t r, const std::string& bytes) {
  const auto address = reinterpret_cast<uint64_t>(bytes.data());
  values.integer[r] = int32_t(uint32_t(address));
  values.integer[r + 1] = int32_t(uint32_t(address >> 32));
  values.integer[r + 2] = int32_t(bytes.size());
}

void Model::set_bytes(uint32_t r, std::string_view bytes) {
  std::string& held = memory_.held[r];
  held.assign(bytes);
  point_to(r, held);
}

std::string Model::in_resources(const std::string& word) const {
  const fs::path path = resources_ / word;
  return !word.empty() && fs::exists(path) ? path.string() : word;
}

void Model::set_parameters(osi::ChainFile& file) const {
  const std::string seed = std::to_string(values.integer[kSeed]);
  for (const char* name : {"tracer", "front_end", "tracking"}) file.set(name, "seed", seed);
  if (!values.text[kProfile].empty()) {
    const std::string sensor = in_resources(values.text[kProfile]);
    file.set("tracer", "sensor", sensor);
    file.set("front_end", "sensor", sensor);
  }
  if (!values.text[kWorld].empty()) file.set("tracer", "world", in_resources(values.text[kWorld]));
  if (!values.text[kTracking].empty()) file.set("tracking", "pipeline", values.text[kTracking]);
  if (values.integer[kMaxEchoes] != 0) {
    file.set("front_end", "max_echoes", std::to_string(values.integer[kMaxEchoes]));
  }
  const auto set_real = [&](uint32_t reference, const char* strategy, const char* key) {
    if (values.real[reference] != 0) file.set(strategy, key, text_of(values.real[reference]));
  };
  set_real(kThresholdSnr, "front_end", "threshold_snr");
  set_real(kExistenceThreshold, "tracking", "threshold");
  set_real(kLatencyMs, "tracking", "latency_ms");
  const std::string_view config = bytes(kSensorViewInConfig);
  if (config.empty()) return;
  const auto given = osi::read_configuration(config, "OSMPSensorViewInConfig");
  const auto& mounting =
      given.lidar.empty() || !given.lidar[0].mounting ? given.mounting : given.lidar[0].mounting;
  if (!mounting) return;
  const Vec3 at = mounting->position_m.value_or(Vec3::Zero());
  const Vec3 turn = mounting->roll_pitch_yaw.value_or(Vec3::Zero()) * (180 / M_PI);
  const std::pair<const char*, double> place[] = {{"x_m", at.x()},         {"y_m", at.y()},
                                                  {"z_m", at.z()},         {"roll_deg", turn.x()},
                                                  {"pitch_deg", turn.y()}, {"yaw_deg", turn.z()}};
  for (const auto& [key, value] : place) file.set("tracer", key, text_of(value));
}

osi::ChainFile Model::chain_file() const {
  osi::ChainFile file = osi::read_chain(in_resources(values.text[kChain]));
  const std::string& mode = values.text[kInputMode];
  require(mode == "reflections" || mode == "ground_truth",
          "input_mode must be reflections or ground_truth");
  const std::string wanted = "," + values.text[kStrategies] + ",";
  std::erase_if(file.strategies, [&](const osi::StrategyEntry& e) {
    if (mode == "reflections" && e.name == "tracer") return true;
    return wanted != ",," && wanted.find("," + e.name + ",") == std::string::npos;
  });
  require(!file.strategies.empty(), "the parameter strategies leaves none of the chain");
  set_parameters(file);
  return file;
}

void Model::note_ground_truth() {
  const std::string_view given = bytes(kGroundTruthInit);
  if (given.empty()) return;
  try {
    osi::SensorView view;
    view.truth = osi::read_ground_truth(given, "OSMPGroundTruthInit");
    memory_.known.fill(view);
  } catch (const FormatError& e) {
    warn_(e.what());
  }
}

void Model::start() {
  for (const Variable& v : variables()) {
    if (!v.has_limits()) continue;
    const double value =
        v.type == Type::kInteger ? values.integer[v.reference] : values.real[v.reference];
    if (value >= v.least && value <= v.most) continue;
    throw std::invalid_argument(std::string(v.name) + " must be from " + text_of(v.least) + " to " +
                                text_of(v.most));
  }
  set_threads(values.integer[kThreads]);
  chain_.emplace(chain_file());
  note_ground_truth();
  if (!values.text[kTraceOutputPath].empty()) trace_.emplace(values.text[kTraceOutputPath]);
}

void Model::request() {
  const std::string_view given = bytes(kSensorViewInConfig);
  const std::string key = values.text[kProfile] + '\n' + values.text[kChain] + '\n' +
                          std::string(given.empty() ? "" : given);
  if (requested_.empty() || key != request_of_) {
    request_of_ = key;
    requested_.assign(given);  // What the environment simulator has offered is taken as it is.
    if (given.empty()) {
      osi::ChainFile file = osi::read_chain(in_resources(values.text[kChain]));
      set_parameters(file);
      std::string sensor = osi::kTracedSensor;
      int columns = 0, rows = 0;
      for (const osi::StrategyEntry& e : file.strategies) {
        if (e.name != "tracer" && e.name != "front_end") continue;
        const auto value = [&](const char* key_word, const std::string& fallback) {
          const auto at = e.parameters.find(key_word);
          return at == e.parameters.end() ? fallback : at->second;
        };
        sensor = value("sensor", sensor);
        columns = std::stoi(value("columns", std::to_string(columns)));
        rows = std::stoi(value("rows", std::to_string(rows)));
      }
      osi::write(osi::request_of(osi::make_profile(sensor, columns, rows), 0, {}), requested_);
    }
  }
  point_to(kSensorViewInConfigRequest, requested_);
}

// Runs the chain on the input and returns the output message.
std::string Model::process() {
  osi::SensorData data;
  std::optional<osi::Timestamp> time;
  const auto is_old = [&](const std::optional<osi::Timestamp>& now) {
    time = now;
    if (!now || !memory_.last) return false;
    const double passed = now->s() - memory_.last->s();
    if (passed < 0) throw DataError("the time of the input goes back");
    return passed == 0 || passed < values.real[kCycle] - kSameTimeS;
  };
  try {
    const std::string_view earlier = bytes(kSensorDataIn), view_bytes = bytes(kSensorViewIn);
    if (!earlier.empty()) {
      data = osi::read_sensor_data(earlier, "OSMPSensorDataIn");
      if (is_old(data.timestamp)) return {};
      memory_.last = time;
      chain_->step(data);
    } else if (!view_bytes.empty()) {
      auto view = std::make_shared<osi::SensorView>(
          osi::read_sensor_view(std::string(view_bytes), "OSMPSensorViewIn"));
      memory_.known.fill(*view);
      if (is_old(view->timestamp)) return {};
      memory_.last = time;
      data = chain_->step(std::move(view));
    } else {
      throw DataError("there is no input: OSMPSensorViewIn and OSMPSensorDataIn are empty");
    }
    memory_.is_valid = true;
    if (!values.integer[kCopySensorView]) data.views.clear();
  } catch (const std::invalid_argument& e) {
    warn_(e.what());
    memory_.is_valid = false;
    data = osi::no_data(time);
  } catch (const FormatError& e) {
    warn_(e.what());
    memory_.is_valid = false;
    data = osi::no_data(time);
  }
  values.integer[kCount] = int32_t(data.objects.size());
  std::string out;
  osi::write(data, out);
  return out;
}

void Model::step() {
  set_threads(values.integer[kThreads]);
  std::string out = process();
  if (out.empty()) out = memory_.output[memory_.current];  // The same cycle once more.
  if (out.size() > size_t(INT32_MAX)) {
    warn_("the output is larger than 2 GiB");
    out.clear();
    osi::write(osi::no_data(memory_.last), out);
  }
  memory_.current = 1 - memory_.current;  // The output of the step before stays where it is.
  memory_.output[memory_.current] = std::move(out);
  point_to(kSensorDataOut, memory_.output[memory_.current]);
  values.integer[kValid] = memory_.is_valid;
  if (trace_) trace_->write(memory_.output[memory_.current]);
}

void Model::stop() {
  if (!trace_) return;
  trace_->close();
  trace_.reset();
}

void Model::reset() {
  stop();
  values = {};
  memory_ = Memory();
  chain_.reset();
  requested_.clear();
  request_of_.clear();
}

Snapshot Model::snapshot() const {
  Snapshot s{values, memory_, std::nullopt};
  if (chain_) s.chain.emplace(chain_->clone());
  return s;
}

void Model::restore(const Snapshot& s) {
  values = s.values;
  memory_ = s.memory;
  chain_.reset();
  if (s.chain) chain_.emplace(s.chain->clone());
  for (const auto& [reference, held] : memory_.held) point_to(reference, held);
  if (!memory_.output[memory_.current].empty()) {
    point_to(kSensorDataOut, memory_.output[memory_.current]);
  }
}

}  // namespace underbrush::fmu
