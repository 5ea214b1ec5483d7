#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/pipeline/osi_trace.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace osi_verb {

struct Arguments {
  std::string action, input, output;
  osi::OsiOptions options;
};

void info(const Verb& verb, const Arguments& a) {
  osi::TraceReader reader(a.input);
  const osi::TraceContents c = osi::contents_of(reader);
  std::string versions;
  for (const std::string& v : c.versions) versions += (versions.empty() ? "" : ", ") + v;
  std::string text =
      fmt::format("{} {} messages, OSI {}\n", c.messages, osi::name(reader.type()), versions);
  if (c.first_s) text += line("time", "{:.3f} to {:.3f} s", *c.first_s, *c.last_s);
  if (c.stands) text += line("standing", "{} times do not ascend", c.stands);
  if (c.host) text += line("host", "{}", *c.host);
  text += line("truth", "{} moving objects, {} stationary, {} lanes", c.moving.size(), c.stationary,
               c.lanes);
  if (c.reflections) {
    text += line("lidar", "{} rays, {} returns, {} sensors", c.reflections, c.returns, c.lidars);
  }
  if (reader.type() == osi::MessageType::kSensorData) {
    text += line("detections", "{} of lidars, {} in the vehicle's frame", c.detections, c.logical);
    text += line("objects", "{} in {} lists, {} tracks", c.objects, c.listed, c.tracks.size());
  }
  verb.report(pipeline::json_of(c, reader.type()), text);
}

void record(const Verb& verb, const Arguments& a) {
  const osi::RecordCounts n = pipeline::record_trace(a.input, a.output, a.options,
                                                     provenance(verb, {a.input, a.options.truth}));
  verb.report(
      {{"views", n.views}, {"rays", n.rays}, {"true_objects", n.objects}},
      fmt::format("{} SensorViews: {} rays, {} true objects\n", n.views, n.rays, n.objects) +
          line("trace", "{}", a.output));
}

/// What a replay without a return or an object is likely to be due to.
std::vector<std::string> warnings_of(const pipeline::ReplayCounts& n) {
  if (n.messages == 0) return {"the trace has no messages"};
  const std::string others = fmt::format("the ground truth has {} others than the host", n.others);
  if (n.rays > 0 && n.returns == 0) {
    return {fmt::format(
        "no reflection came back of {} rays, and {}: the lidar faces neither them nor the ground "
        "within its range, or the --world lies elsewhere",
        n.rays, others)};
  }
  if (n.rays == 0 && n.echoes == 0 && n.objects == 0) {
    return {"the messages have no reflections, and no tracer makes any: see --strategy tracer"};
  }
  if (n.lists == 0 || n.objects > 0) return {};
  if (n.others == 0) return {fmt::format("no object was found in {} echoes: {}", n.echoes, others)};
  return {fmt::format(
      "no object was found in {} echoes, and {}: they are out of the lidar's range or view, or the "
      "vehicle's axle is not as high above the ground as the chain has it "
      "(tracking:axle_height_m)",
      n.echoes, others)};
}

void replay(const Verb& verb, Arguments& a) {
  a.options.replay.seed = verb.seed;
  const pipeline::ReplayCounts n =
      pipeline::replay_trace(a.input, a.output, a.options, provenance(verb, {a.input}));
  const std::vector<std::string> warnings = warnings_of(n);
  Json j{{"messages", n.messages}, {"objects", n.objects}, {"seconds", n.seconds}};
  if (!warnings.empty()) j["warnings"] = warnings;
  verb.report(j, fmt::format("{} messages: {} objects\n", n.messages, n.objects) +
                     line("chain", "{:.2f} s", n.seconds) + text_of_warnings(warnings) +
                     line("output", "{}", a.output));
}

void convert(const Verb& verb, const Arguments& a) {
  const pipeline::ConvertCounts n =
      pipeline::convert_trace(a.input, a.output, a.options, provenance(verb, {a.input}));
  if (n.is_log) {
    return verb.report(
        {{"rows", n.rows}, {"scans", n.scans}},
        fmt::format("{} rows of {} scans\n", n.rows, n.scans) + line("log", "{}", a.output));
  }
  verb.report(
      {{"lists", n.lists}, {"objects", n.objects}},
      fmt::format("{} lists: {} objects\n", n.lists, n.objects) + line("output", "{}", a.output));
}

void run(const Verb& verb, Arguments& a) {
  a.options.check(a.action);
  try {
    if (a.action == "info") return info(verb, a);
    require(!a.output.empty(), "osi: record, replay and convert need an output (-o)");
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
                 "A trace (.osi: SensorView, SensorData or GroundTruth). For record it is a log; "
                 "convert also takes lists of objects (.csv, .json)")
      ->required();
  verb->output("-o,--output", a->output,
               "A trace (.osi). replay and convert also write lists of objects (.csv, .json), and "
               "convert a log (.ply)")
      ->type_name("FILE");
  add_options(*verb, osi::osi_options(), a->options, "Replay");
}

}  // namespace underbrush::app
