#include <fmt/format.h>

#include <chrono>

#include "osi_actions.hpp"
#include "osi_lists.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/chain.hpp"
#include "underbrush/osi/lidar_log.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/static_data.hpp"
#include "underbrush/osi/trace.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush::app {
namespace {

// Parses NAME[:KEY=VALUE,...].
osi::StrategyEntry entry_of(const std::string& text) {
  osi::StrategyEntry e;
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

// A ground truth has no reflections, so that its default chain begins with a tracer.
osi::Chain chain_of(const Verb& verb, const OsiArguments& a, bool is_truth) {
  osi::ChainFile file;
  if (!a.chain.empty()) {
    require(a.strategies.empty(), "osi: give --chain or --strategy, not both");
    file = osi::read_chain(a.chain);
  } else if (a.strategies.empty()) {
    const bool traces = is_truth || !a.world.empty();
    file = traces ? osi::traced_chain() : osi::default_chain();
  }
  for (const std::string& s : a.strategies) file.strategies.push_back(entry_of(s));
  if (!a.world.empty()) {
    require(file.set("tracer", "world", a.world), "osi: --world needs a chain with a tracer");
  }
  if (!a.sensor.empty()) {
    const bool traced = file.set("tracer", "sensor", a.sensor);
    const bool received = file.set("front_end", "sensor", a.sensor);
    require(traced || received, "osi: --sensor needs a chain with a tracer or a front end");
  }
  for (osi::StrategyEntry& e : file.strategies) {
    if (!e.library.empty() ||
        (e.name != "front_end" && e.name != "tracking" && e.name != "tracer")) {
      continue;
    }
    e.parameters.emplace("seed", std::to_string(verb.seed));
  }
  try {
    return osi::Chain(file);
  } catch (const FormatError& e) {
    if (e.file() == "--strategy" || e.file() == "chain") {
      throw std::invalid_argument("osi: " + std::string(e.what()));
    }
    throw;
  }
}

osi::SensorData next_data(osi::TraceReader& reader, std::string message, osi::StaticData& known,
                          osi::Chain& chain) {
  try {
    if (reader.type() == osi::MessageType::kSensorData) {
      osi::SensorData data = osi::read_sensor_data(message, reader.place());
      chain.step(data);
      return data;
    }
    const bool is_truth = reader.type() == osi::MessageType::kGroundTruth;
    auto view = std::make_shared<osi::SensorView>(
        is_truth ? osi::view_of_ground_truth(message, reader.place())
                 : osi::read_sensor_view(std::move(message), reader.place()));
    known.fill(*view);
    return chain.step(std::move(view));
  } catch (const DataError& e) {
    throw FormatError(reader.place(), "", e.what());
  }
}

}  // namespace

void osi_replay(const Verb& verb, const OsiArguments& a) {
  using Clock = std::chrono::steady_clock;
  io::check_output(a.output);
  osi::TraceReader reader(a.input);
  osi::Chain chain = chain_of(verb, a, reader.type() == osi::MessageType::kGroundTruth);
  std::optional<osi::TraceWriter> trace;
  if (osi::is_trace_file(a.output)) trace.emplace(a.output, provenance(verb, {a.input}));
  std::vector<perception::ObjectList> lists;
  osi::StaticData known;
  size_t objects = 0;
  double seconds = 0;
  std::string bytes;
  for (std::string message; reader.next(message);) {
    const auto start = Clock::now();
    osi::SensorData data = next_data(reader, std::move(message), known, chain);
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    objects += data.objects.size();
    if (trace) {
      if (a.without_view) data.views.clear();
      bytes.clear();
      osi::write(data, bytes);
      trace->write(bytes);
    } else {
      lists.push_back(osi::list_of(data));
    }
  }
  if (trace) {
    trace->close();
  } else {
    write_lists(a.output, lists, provenance(verb, {a.input}));
  }
  Json j;
  j["messages"] = reader.read();
  j["objects"] = objects;
  j["seconds"] = seconds;
  verb.report(j, fmt::format("{} messages: {} objects\n  chain       {:.2f} s\n  output      {}\n",
                             reader.read(), objects, seconds, a.output));
}

namespace {

void convert_views_to_log(const Verb& verb, const OsiArguments& a, osi::TraceReader& reader) {
  osi::LidarLogOptions options;
  options.white_intensity = a.white_intensity;
  BeamLog log;
  log.info.has_misses = true;
  osi::StaticData known;
  for (std::string message; reader.next(message);) {
    osi::SensorView view = osi::read_sensor_view(std::move(message), reader.place());
    known.fill(view);
    try {
      osi::append_beams(view, uint32_t(reader.read() - 1), options, log);
    } catch (const DataError& e) {
      throw FormatError(reader.place(), "", e.what());
    }
  }
  if (log.empty()) throw FormatError(a.input, "", "the views have no reflections");
  double farthest = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    if (log.is_hit(i)) farthest = std::max(farthest, double(log.range_m[i]));
  }
  log.info.max_range_m = std::max(log.info.max_range_m, std::ceil(farthest));
  io::write_log(a.output, log, provenance(verb, {a.input}));
  Json j;
  j["rows"] = log.size();
  j["scans"] = log.info.scans.size();
  verb.report(j, fmt::format("{} rows of {} scans\n  log         {}\n", log.size(),
                             log.info.scans.size(), a.output));
}

}  // namespace

void osi_convert(const Verb& verb, const OsiArguments& a) {
  io::check_output(a.output);
  const std::string extension = std::filesystem::path(a.output).extension().string();
  if (osi::is_trace_file(a.input) && extension == ".ply") {
    osi::TraceReader reader(a.input);
    if (reader.type() != osi::MessageType::kSensorView) {
      throw FormatError(a.input, "", "only SensorViews have the reflections of a log");
    }
    return convert_views_to_log(verb, a, reader);
  }
  require(is_list_file(a.input) || osi::is_trace_file(a.output),
          "osi convert: takes a trace or lists of objects");
  require(extension == ".csv" || extension == ".json" || extension == ".osi",
          "osi convert: writes .osi, .csv, .json and .ply files");
  const std::vector<perception::ObjectList> lists = read_lists(a.input);
  write_lists(a.output, lists, provenance(verb, {a.input}));
  size_t objects = 0;
  for (const auto& list : lists) objects += list.objects.size();
  Json j;
  j["lists"] = lists.size();
  j["objects"] = objects;
  verb.report(
      j, fmt::format("{} lists: {} objects\n  output      {}\n", lists.size(), objects, a.output));
}

}  // namespace underbrush::app
