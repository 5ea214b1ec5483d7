#include "underbrush/osi/replay.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/osi/read.hpp"

namespace underbrush::osi {
namespace {

// Parses NAME[:KEY=VALUE,...].
StrategyEntry entry_of(const std::string& text) {
  StrategyEntry e;
  const size_t colon = text.find(':');
  e.name = text.substr(0, colon);
  e.file = "--strategy";
  e.place = e.name;
  for (size_t at = colon; at != std::string::npos && at + 1 < text.size();) {
    const size_t end = text.find(',', at + 1);
    const std::string word = text.substr(at + 1, end == std::string::npos ? end : end - at - 1);
    const size_t equals = word.find('=');
    require(equals != std::string::npos && equals > 0, "osi: --strategy takes NAME:KEY=VALUE,...");
    const std::string key = word.substr(0, equals), value = word.substr(equals + 1);
    if (key == "library") {
      e.library = value;
    } else {
      e.parameters[key] = value;
    }
    at = end;
  }
  return e;
}

// Whether the messages of a trace have a ground truth alone, by the first one.
bool is_truth_alone(TraceReader& reader) {
  if (reader.type() != MessageType::kSensorView) return reader.type() == MessageType::kGroundTruth;
  std::string message;
  const bool any = reader.next(message);
  const bool alone = any && read_sensor_view(std::move(message), reader.place()).lidar.empty();
  reader.rewind();
  return alone;
}

}  // namespace

Chain chain_of(const ReplayOptions& a, bool is_truth) {
  ChainFile file;
  if (!a.chain.empty()) {
    require(a.strategies.empty(), "osi: give --chain or --strategy, not both");
    file = read_chain(a.chain);
  } else if (a.strategies.empty()) {
    const bool traces = is_truth || !a.world.empty();
    file = traces ? traced_chain() : default_chain();
  }
  for (const std::string& s : a.strategies) file.strategies.push_back(entry_of(s));
  if (!a.world.empty()) {
    require(file.set("tracer", "world", a.world), "osi: --world needs a chain with a tracer");
  }
  if (!a.actors.empty()) {
    require(file.set("tracer", "mover_models", a.actors),
            "osi: --actors needs a chain with a tracer");
  }
  if (!a.sensor.empty()) {
    const bool traced = file.set("tracer", "sensor", a.sensor);
    const bool received = file.set("front_end", "sensor", a.sensor);
    require(traced || received, "osi: --sensor needs a chain with a tracer or a front end");
  }
  for (StrategyEntry& e : file.strategies) {
    if (!e.library.empty() ||
        (e.name != "front_end" && e.name != "tracking" && e.name != "tracer")) {
      continue;
    }
    e.parameters.emplace("seed", std::to_string(a.seed));
  }
  try {
    return Chain(file);
  } catch (const FormatError& e) {
    if (e.file() == "--strategy" || e.file() == "chain") {
      throw std::invalid_argument("osi: " + std::string(e.what()));
    }
    throw;
  }
}

Replay::Replay(TraceReader& reader, const ReplayOptions& options)
    : reader_(reader), chain_(chain_of(options, is_truth_alone(reader))) {
  // A view that is made of a ground truth alone is a message of this program.
  if (reader.type() == MessageType::kGroundTruth) known_ = StaticData(Version());
}

bool Replay::next(SensorData& data) {
  std::string message;
  if (!reader_.next(message)) return false;
  try {
    if (reader_.type() == MessageType::kSensorData) {
      data = read_sensor_data(message, reader_.place());
      chain_.step(data);
      return true;
    }
    const bool is_truth = reader_.type() == MessageType::kGroundTruth;
    auto view = std::make_shared<SensorView>(
        is_truth ? view_of_ground_truth(message, reader_.place())
                 : read_sensor_view(std::move(message), reader_.place()));
    known_.fill(*view);
    data = chain_.step(std::move(view));
    return true;
  } catch (const DataError& e) {
    throw FormatError(reader_.place(), "", e.what());
  }
}

}  // namespace underbrush::osi
