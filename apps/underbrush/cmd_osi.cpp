#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/record.hpp"
#include "underbrush/osi/replay.hpp"
#include "underbrush/osi/trace_contents.hpp"
#include "underbrush/osi/write.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace osi_verb {

struct Arguments {
  std::string action, input, output, truth;
  osi::ReplayOptions replay;
  osi::LidarLogOptions lidar;
  bool without_view = false;
  double truth_elevation_deg = 0;
};

Json json_of(const osi::TraceContents& c, osi::MessageType type) {
  Json j;
  j["message"] = osi::name(type);
  j["messages"] = c.messages;
  j["bytes"] = c.bytes;
  j["versions"] = c.versions;
  if (c.first_s) j["first_s"] = *c.first_s;
  if (c.last_s) j["last_s"] = *c.last_s;
  j["times_that_do_not_ascend"] = c.stands;
  if (c.host) j["host_vehicle_id"] = *c.host;
  j["moving_objects"] = c.moving.size();
  j["most_moving_objects"] = c.most_moving;
  j["stationary_objects"] = c.stationary;
  j["lanes"] = c.lanes;
  j["lidars"] = c.lidars;
  j["reflections"] = c.reflections;
  j["returns"] = c.returns;
  if (type == osi::MessageType::kSensorData) {
    j["detections"] = c.detections;
    j["logical_detections"] = c.logical;
    j["object_lists"] = c.listed;
    j["objects"] = c.objects;
    j["tracks"] = c.tracks.size();
  }
  return j;
}

void info(const Verb& verb, const Arguments& a) {
  osi::TraceReader reader(a.input);
  const osi::TraceContents c = osi::contents_of(reader);
  std::string versions;
  for (const std::string& v : c.versions) versions += (versions.empty() ? "" : ", ") + v;
  std::string text =
      fmt::format("{} {} messages, OSI {}\n", c.messages, osi::name(reader.type()), versions);
  if (c.first_s) text += fmt::format("  time        {:.3f} to {:.3f} s\n", *c.first_s, *c.last_s);
  if (c.stands) text += fmt::format("  standing    {} times do not ascend\n", c.stands);
  if (c.host) text += fmt::format("  host        {}\n", *c.host);
  text += fmt::format("  truth       {} moving objects, {} stationary, {} lanes\n", c.moving.size(),
                      c.stationary, c.lanes);
  if (c.reflections) {
    text += fmt::format("  lidar       {} rays, {} returns, {} sensors\n", c.reflections, c.returns,
                        c.lidars);
  }
  if (reader.type() == osi::MessageType::kSensorData) {
    text += fmt::format("  detections  {} of lidars, {} in the vehicle's frame\n", c.detections,
                        c.logical);
    text += fmt::format("  objects     {} in {} lists, {} tracks\n", c.objects, c.listed,
                        c.tracks.size());
  }
  verb.report(json_of(c, reader.type()), text);
}

void record(const Verb& verb, const Arguments& a) {
  io::LogReader log(a.input);
  std::vector<std::filesystem::path> inputs{a.input};
  std::optional<perception::LogTruth> truth;
  if (!a.truth.empty()) {
    inputs.emplace_back(a.truth);
    truth = osi::truth_of_log(a.truth, log.info(), {a.truth_elevation_deg * M_PI / 180});
  }
  osi::TraceWriter writer(a.output, provenance(verb, inputs));
  const osi::RecordCounts n = osi::record_log(log, truth ? &*truth : nullptr, a.lidar, writer);
  writer.close();
  const Json j{{"views", n.views}, {"rays", n.rays}, {"true_objects", n.objects}};
  verb.report(j, fmt::format("{} SensorViews: {} rays, {} true objects\n  trace       {}\n",
                             n.views, n.rays, n.objects, a.output));
}

void replay(const Verb& verb, const Arguments& a) {
  using Clock = std::chrono::steady_clock;
  osi::TraceReader reader(a.input);
  osi::ReplayOptions options = a.replay;
  options.seed = verb.seed;
  osi::Replay chain(reader, options);
  std::optional<osi::TraceWriter> trace;
  if (osi::is_trace_file(a.output)) trace.emplace(a.output, provenance(verb, {a.input}));
  std::vector<perception::ObjectList> lists;
  size_t objects = 0;
  double seconds = 0;
  const auto next = [&](osi::SensorData& data) {
    const auto start = Clock::now();
    const bool more = chain.next(data);
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    return more;
  };
  std::string bytes;
  for (osi::SensorData data; next(data);) {
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
    osi::write_lists(a.output, lists, provenance(verb, {a.input}));
  }
  const Json j{{"messages", reader.read()}, {"objects", objects}, {"seconds", seconds}};
  verb.report(j, fmt::format("{} messages: {} objects\n  chain       {:.2f} s\n  output      {}\n",
                             reader.read(), objects, seconds, a.output));
}

void convert(const Verb& verb, const Arguments& a) {
  const std::string extension = std::filesystem::path(a.output).extension().string();
  if (osi::is_trace_file(a.input) && extension == ".ply") {
    osi::TraceReader reader(a.input);
    if (reader.type() != osi::MessageType::kSensorView) {
      throw FormatError(a.input, "", "only SensorViews have the reflections of a log");
    }
    const BeamLog log = osi::log_of_views(reader, a.lidar);
    io::write_log(a.output, log, provenance(verb, {a.input}));
    const Json j{{"rows", log.size()}, {"scans", log.info.scans.size()}};
    return verb.report(j, fmt::format("{} rows of {} scans\n  log         {}\n", log.size(),
                                      log.info.scans.size(), a.output));
  }
  require(osi::is_list_file(a.input) || osi::is_trace_file(a.output),
          "osi convert: takes a trace or lists of objects");
  require(extension == ".csv" || extension == ".json" || extension == ".osi",
          "osi convert: writes .osi, .csv, .json and .ply files");
  const std::vector<perception::ObjectList> lists = osi::read_lists(a.input);
  osi::write_lists(a.output, lists, provenance(verb, {a.input}));
  size_t objects = 0;
  for (const auto& list : lists) objects += list.objects.size();
  const Json j{{"lists", lists.size()}, {"objects", objects}};
  verb.report(
      j, fmt::format("{} lists: {} objects\n  output      {}\n", lists.size(), objects, a.output));
}

void run(const Verb& verb, const Arguments& a) {
  const osi::ReplayOptions& r = a.replay;
  if (a.action != "info") {
    require(!a.output.empty(), "osi: record, replay and convert need an output (-o)");
  }
  require(a.action == "replay" || (r.chain.empty() && r.strategies.empty() && !a.without_view &&
                                   r.sensor.empty() && r.world.empty()),
          "osi: --chain, --strategy, --sensor, --world and --without-view are of replay");
  require(a.action == "record" || a.truth.empty(), "osi: --truth is of record");
  try {
    if (a.action == "info") return info(verb, a);
    io::check_output(a.output);
    if (a.action == "record") return record(verb, a);
    if (a.action == "replay") return replay(verb, a);
    convert(verb, a);
  } catch (const DataError& e) {
    throw FormatError(a.input, "", e.what());
  }
}

}  // namespace osi_verb
}  // namespace

void add_osi(Program& program) {
  using namespace osi_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Simulation", "osi",
      "Read, make, replay and convert traces of the Open Simulation Interface",
      "underbrush osi info views.osi\n"
      "  underbrush osi record log.ply --truth objects.csv -o views.osi\n"
      "  underbrush osi replay views.osi --chain chain.yaml -o data.osi\n"
      "  underbrush osi replay data.osi --strategy tracking:pipeline=real -o objects.json\n"
      "  underbrush osi replay truth_gt_.osi --world model/ -o objects.csv\n"
      "  underbrush osi convert data.osi -o objects.csv\n"
      "  underbrush osi convert views.osi -o log.ply",
      [a](const Verb& v) { run(v, *a); });
  CLI::App& app = verb->app;
  app.add_option("ACTION", a->action, "info, record, replay or convert")
      ->required()
      ->check(CLI::IsMember({"info", "record", "replay", "convert"}));
  app.add_option("INPUT", a->input,
                 "A trace (.osi: SensorView, SensorData or GroundTruth); record: a log; convert: "
                 "also lists of objects (.csv, .json)")
      ->required();
  verb->output("-o,--output", a->output,
               "A trace (.osi); replay and convert: also lists of objects (.csv, .json); convert: "
               "also a log (.ply)")
      ->type_name("FILE");
  app.add_option("--truth", a->truth,
                 "record: the true objects, as perceive takes them, for the ground truth")
      ->type_name("FILE");
  app.add_option("--chain", a->replay.chain, "replay: the strategies and their parameters")
      ->type_name("CHAIN.yaml");
  app.add_option("--strategy", a->replay.strategies,
                 "replay: run this strategy; may be repeated. Without it and without --chain, all "
                 "run: front_end, alignment, tracking, classification, grid; on a GroundTruth or "
                 "with --world behind a tracer")
      ->type_name("NAME[:KEY=VALUE,...]")
      ->take_all();
  app.add_option("--sensor", a->replay.sensor, "replay: the sensor of the tracer and the front end")
      ->type_name("NAME|FILE");
  app.add_option("--world", a->replay.world,
                 "replay: the model or scene that the tracer's rays meet")
      ->type_name("DIR");
  app.add_flag("--without-view", a->without_view,
               "replay: leave the SensorView out of the SensorData, which makes them small; the "
               "tracking model needs its ground truth");
  verb->begin_rare_group();
  app.add_option("--white", a->lidar.white_intensity,
                 "record, convert: the log's intensity of a white target, for signal strengths")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--truth-elevation-deg", a->truth_elevation_deg,
                 "record: turn labelled boxes up by this angle, as import turned the beams")
      ->capture_default_str();
}

}  // namespace underbrush::app
