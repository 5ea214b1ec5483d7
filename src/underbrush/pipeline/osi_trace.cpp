#include "underbrush/pipeline/osi_trace.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>

#include "underbrush/actors/actor_edits.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush::pipeline {
namespace fs = std::filesystem;

osi::RecordCounts record_trace(const fs::path& log, const fs::path& output,
                               const osi::OsiOptions& options, const std::string& provenance) {
  options.check("record");
  if (!output.extension().empty() && !osi::is_trace_file(output)) {
    throw std::invalid_argument(output.string() + ": traces are written as .osi, not as " +
                                output.extension().string());
  }
  io::LogReader reader(log);
  std::optional<perception::LogTruth> truth;
  std::vector<std::string> models;
  if (!options.truth.empty() && elements::is_scene(options.truth)) {
    const std::vector<actors::Actor> actors = actors::read_actors(options.truth);
    truth = actors::truth_of(actors, reader.info());
    models = actors::names_of(actors);
  } else if (!options.truth.empty()) {
    truth =
        osi::truth_of_log(options.truth, reader.info(), {options.truth_elevation_deg * M_PI / 180});
  }
  osi::TraceWriter writer(output, provenance);
  const osi::RecordCounts out =
      osi::record_log(reader, truth ? &*truth : nullptr, options.lidar, writer, models);
  writer.close();
  return out;
}

namespace {

void count(const osi::SensorData& data, ReplayCounts& n) {
  n.lists += data.object_header.has_value();
  n.objects += data.objects.size();
  for (const osi::LidarDetectionData& lidar : data.lidar) n.echoes += lidar.detections.size();
  if (data.lidar.empty() && data.logical) n.echoes += data.logical->detections.size();
  for (const auto& view : data.views) {
    for (const osi::LidarSensorView& lidar : view->lidar) {
      n.rays += lidar.reflections.size();
      n.returns +=
          size_t(std::ranges::count_if(lidar.reflections, std::not_fn(&osi::Reflection::is_miss)));
    }
    if (view->truth) n.others += view->truth->moving.size() - (view->host() != nullptr);
  }
}

}  // namespace

ReplayCounts replay_trace(const fs::path& trace, const fs::path& output,
                          const osi::OsiOptions& options, const std::string& provenance) {
  using Clock = std::chrono::steady_clock;
  options.check("replay");
  osi::check_list_name(output);
  osi::TraceReader reader(trace);
  osi::Replay chain(reader, options.replay);
  std::optional<osi::TraceWriter> writer;
  if (osi::is_trace_file(output)) writer.emplace(output, provenance);
  ReplayCounts out;
  const auto next = [&](osi::SensorData& data) {
    const auto start = Clock::now();
    const bool more = chain.next(data);
    out.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    return more;
  };
  std::vector<perception::ObjectList> lists;
  std::string bytes;
  for (osi::SensorData data; next(data);) {
    count(data, out);
    if (writer) {
      if (options.without_view) data.views.clear();
      bytes.clear();
      osi::write(data, bytes);
      writer->write(bytes);
    } else {
      lists.push_back(osi::list_of(data));
    }
  }
  if (writer) {
    writer->close();
  } else {
    osi::write_lists(output, lists, provenance);
  }
  out.messages = reader.read();
  return out;
}

ConvertCounts convert_trace(const fs::path& input, const fs::path& output,
                            const osi::OsiOptions& options, const std::string& provenance) {
  options.check("convert");
  ConvertCounts out;
  const fs::path extension = output.extension();
  out.is_log = osi::is_trace_file(input) && io::is_log_name(output);
  if (out.is_log) {
    osi::TraceReader reader(input);
    if (reader.type() != osi::MessageType::kSensorView) {
      throw FormatError(input.string(), "", "only SensorViews have the reflections of a log");
    }
    const BeamLog log = osi::log_of_views(reader, options.lidar);
    io::write_log(output, log, provenance);
    out.rows = log.size();
    out.scans = log.info.scans.size();
    return out;
  }
  require(osi::is_list_file(input) || osi::is_trace_file(output),
          "osi convert: takes a trace or lists of objects");
  require(extension == ".csv" || extension == ".json" || extension == ".osi",
          "osi convert: writes .osi, .csv, .json, .ply and .ublog files");
  const std::vector<perception::ObjectList> lists = osi::read_lists(input);
  osi::write_lists(output, lists, provenance);
  out.lists = lists.size();
  for (const auto& list : lists) out.objects += list.objects.size();
  return out;
}

}  // namespace underbrush::pipeline
