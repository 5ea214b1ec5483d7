#include "osi_actions.hpp"
#include "underbrush/core/check.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace osi_verb {

void run(const Verb& verb, const OsiArguments& a) {
  if (a.action != "info") {
    require(!a.output.empty(), "osi: record, replay and convert need an output (-o)");
  }
  require(a.action == "replay" || (a.chain.empty() && a.strategies.empty() && !a.without_view &&
                                   a.sensor.empty() && a.world.empty()),
          "osi: --chain, --strategy, --sensor, --world and --without-view are of replay");
  require(a.action == "record" || a.truth.empty(), "osi: --truth is of record");
  try {
    if (a.action == "info") return osi_info(verb, a);
    if (a.action == "record") return osi_record(verb, a);
    if (a.action == "replay") return osi_replay(verb, a);
    osi_convert(verb, a);
  } catch (const DataError& e) {
    throw FormatError(a.input, "", e.what());
  }
}

}  // namespace osi_verb
}  // namespace

void add_osi(Program& program) {
  using namespace osi_verb;
  auto a = std::make_shared<OsiArguments>();
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
  app.add_option("--chain", a->chain, "replay: the strategies and their parameters")
      ->type_name("CHAIN.yaml");
  app.add_option("--strategy", a->strategies,
                 "replay: run this strategy; may be repeated. Without it and without --chain, all "
                 "run: front_end, alignment, tracking, classification, grid; on a GroundTruth or "
                 "with --world behind a tracer")
      ->type_name("NAME[:KEY=VALUE,...]")
      ->take_all();
  app.add_option("--sensor", a->sensor, "replay: the sensor of the tracer and the front end")
      ->type_name("NAME|FILE");
  app.add_option("--world", a->world, "replay: the model or scene that the tracer's rays meet")
      ->type_name("DIR");
  app.add_flag("--without-view", a->without_view,
               "replay: leave the SensorView out of the SensorData, which makes them small; the "
               "tracking model needs its ground truth");
  verb->begin_rare_group();
  app.add_option("--white", a->white_intensity,
                 "record, convert: the log's intensity of a white target, for signal strengths")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--truth-elevation-deg", a->truth_elevation_deg,
                 "record: turn labelled boxes up by this angle, as import turned the beams")
      ->capture_default_str();
}

}  // namespace underbrush::app
