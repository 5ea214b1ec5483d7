#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "report/light_text.hpp"
#include "report/waveform_outputs.hpp"
#include "report/world_text.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/io/driver_layout.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/pipeline/out_of_reach.hpp"
#include "underbrush/pipeline/requested_beams.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/regions/world_folder.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace simulate_verb {

struct Arguments {
  std::string model, like, sensor, rig, trajectory, output;
  std::vector<std::string> movers;  ///< Each is MODEL:POSES[:MATERIAL].
  report::SimulateFiles files;
  worlds::ReadOptions world;
  pipeline::SimulateOptions options;
};

/// An object that moves, as the command line names it.
struct MoverWords {
  std::string model, poses, material;
};

/// Splits MODEL:POSES[:MATERIAL]. Throws `std::invalid_argument`.
MoverWords mover_words(const std::string& text) {
  const size_t first = text.find(':');
  const size_t second = first == std::string::npos ? first : text.find(':', first + 1);
  require(first != std::string::npos && first > 0 && first + 1 < text.size(),
          "simulate: --mover takes MODEL:POSES.txt or MODEL:POSES.txt:MATERIAL");
  MoverWords w{text.substr(0, first), text.substr(first + 1, second - first - 1), ""};
  if (second != std::string::npos) w.material = text.substr(second + 1);
  return w;
}

void add_beam_options(CLI::App& app, Arguments& a) {
  auto* like = app.add_option("--like", a.like, "Simulate the beams of this log")->type_name("LOG");
  auto* sensor =
      app.add_option("--sensor", a.sensor, "Simulate a sensor of the catalogue (or a YAML file)");
  auto* rig =
      app.add_option("--rig", a.rig, "Simulate all sensors of a vehicle")->type_name("RIG.yaml");
  auto* trajectory = app.add_option("--trajectory", a.trajectory,
                                    "Poses of the sensor or vehicle: TUM file or log")
                         ->type_name("POSES");
  like->excludes(trajectory);
  rig->excludes(sensor);
  rig->needs(trajectory);
}

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option(
         "MODEL", a.model,
         "The folder of a model, scene or world of regions, or a world of another program, such "
         "as a mesh")
      ->required();
  verb.output("-o,--output", a.output,
              "The simulated log: a .ply, .ublog, .pcd or .csv file, or a folder/ for KITTI .bin "
              "files (with --profile: for PCD files)")
      ->required();
  add_beam_options(app, a);
  app::add_options(verb, pipeline::simulate_options(), a.options, "Instrument");
  app::add_options(verb, report::simulate_files(), a.files, "Instrument");
  verb.mark_output("--waveforms", app.get_option("--waveforms"), a.files.waveforms);
  verb.begin_rare_group("Things that move");
  app.add_option("--mover", a.movers,
                 "Add an object (a model's folder, or an OBJ or PLY mesh) that moves along poses "
                 "(TUM format, world from object); may be repeated")
      ->type_name("MODEL:POSES.txt[:MATERIAL]")
      ->take_all();
  app::add_options(verb, worlds::read_options(), a.world);
}

pipeline::World world_of(const Arguments& a) {
  pipeline::World world = pipeline::open_world(a.model, a.world);
  for (const std::string& text : a.movers) {
    const MoverWords w = mover_words(text);
    pipeline::add_mover(world, actors::read_mover(w.model), io::read_trajectory(w.poses),
                        w.material);
  }
  pipeline::change_world(world, a.options);
  world.info.materials.resize(world.scene.models.size());
  return world;
}

pipeline::RequestedBeams beams_of(const Arguments& a) {
  if (!a.like.empty()) {
    std::optional<sensor::Sensor> instrument;
    if (!a.sensor.empty()) instrument = sensor::load(a.sensor);
    return {std::make_unique<io::BeamReader>(a.like, pipeline::kSimulatedBeams), a.like,
            std::move(instrument)};
  }
  require(!a.trajectory.empty() && a.sensor.empty() == !a.rig.empty(),
          "simulate: give --like LOG, or --sensor NAME or --rig FILE with --trajectory POSES");
  std::optional<sensor::Sensor> sensor;
  if (!a.sensor.empty()) sensor = sensor::load(a.sensor);
  const Trajectory path = io::read_trajectory(a.trajectory);
  if (path.empty()) throw FormatError(a.trajectory, "", "holds no pose");
  try {
    if (!sensor) return {perception::load_rig(a.rig), path};
    return {std::move(*sensor), path};
  } catch (const std::invalid_argument& e) {
    throw FormatError(a.trajectory, "", e.what());
  }
}

std::vector<std::filesystem::path> inputs_of(const Arguments& a) {
  std::vector<std::filesystem::path> inputs = regions::hashed_parts(a.model);
  inputs.emplace_back(a.like.empty() ? a.trajectory : a.like);
  for (const std::string& text : a.movers) {
    const MoverWords w = mover_words(text);
    inputs.emplace_back(w.model);
    inputs.emplace_back(w.poses);
  }
  inputs.emplace_back(a.options.actors);
  for (const std::string& file : {a.sensor, a.rig, a.options.instrument.materials}) {
    if (std::filesystem::is_regular_file(file)) inputs.emplace_back(file);
  }
  return inputs;
}

/// Says what the output's format cannot hold; nothing where it holds all.
std::string lost_in(const Arguments& a) {
  const std::string extension = std::filesystem::path(a.output).extension().string();
  std::string lost = io::lost_in(!a.files.profile.empty() ? a.files.profile
                                 : extension.empty()      ? "kitti"
                                                          : extension.substr(1));
  if (a.options.element_ids && !lost.empty() && extension != ".pcd") {
    lost += ", element, class and instance numbers";
  }
  return lost;
}

/// Says that the beams of a log stay those of its sensor; nothing where --sensor names the same.
std::string text_of_other_sensor(const Arguments& a, const LogInfo& log) {
  if (a.like.empty() || a.sensor.empty() || log.sensor.empty()) return {};
  const std::string name = sensor::load(a.sensor).name;
  if (name == log.sensor) return {};
  return fmt::format(
      "the beams are those of {}, a {}; of --sensor {} only the instrument is taken. Its own beams "
      "on the same path: --sensor {} --trajectory {}",
      printable(a.like), printable(log.sensor), printable(name), printable(a.sensor),
      printable(a.like));
}

/// What was simulated, for the report.
struct Done {
  const pipeline::Simulation& simulation;
  pipeline::SimulateCounts counts;
  const LogInfo& beams;
  double seconds;
  size_t waveforms;
};

/// Says what of the model had a part in the answers.
std::string text_of_model(const Done& done, const elements::Model& model) {
  const std::string sensor = model.sensor.empty() ? "the model's log" : printable(model.sensor);
  std::string text;
  if (!model.channels.empty()) {
    const size_t added = model.channels_of(done.beams).size();
    text += added > 0
                ? fmt::format("  channels    {} range offsets added\n", added)
                : fmt::format("  channels    no range offsets added: they are of {}\n", sensor);
  }
  if (model.keyframes) {
    text += done.simulation.keyframes_serve(done.beams)
                ? fmt::format("  keyframes   used for beams near {} of them\n",
                              model.keyframes->frames.size())
                : fmt::format(
                      "  keyframes   not used: they are of beams of {} with one echo, without "
                      "--element-ids{}\n",
                      sensor,
                      done.beams.sensor.empty() && !model.sensor.empty()
                          ? "; the log of these beams names no sensor (import --deskew)"
                          : "");
  }
  return text;
}

void report(const Verb& verb, const Arguments& a, const Done& done,
            const report::WorldSummary& world) {
  const pipeline::SimulateCounts& n = done.counts;
  const pipeline::TracedWorld& traced = done.simulation.world();
  const elements::Model& model = traced.dynamic().model(0);
  const size_t sub_rays = done.simulation.sub_rays(), misses = n.rows - n.hits;
  const double rate = double(n.beams) / std::max(n.seconds, 1e-9);
  const double mean_traced =
      double(done.simulation.rays_traced()) / double(std::max<size_t>(1, n.beams));
  const std::string lost = lost_in(a);
  const std::string intensities = report::intensities_in_words(traced.models(), done.beams,
                                                               done.simulation.uses_learnt_light());
  Json j;
  j["beams"] = n.beams;
  j["hits"] = n.beams - misses;
  j["misses"] = misses;
  if (sub_rays) j["echoes"] = n.hits;
  if (sub_rays) j["sub_rays"] = sub_rays;
  if (sub_rays) j["sub_rays_traced"] = mean_traced;
  if (!a.files.waveforms.empty()) j["waveforms"] = done.waveforms;
  if (!lost.empty()) j["lost"] = lost;
  if (traced.sway_s() > 0) j["sway_s"] = traced.sway_s();
  if (!model.channels.empty()) j["channel_offsets"] = model.channels_of(done.beams).size();
  if (!intensities.empty()) j["intensity"] = intensities;
  if (model.keyframes) j["keyframes"] = done.simulation.keyframes_serve(done.beams);
  if (world.read.parts) j["world"] = json_of(world);
  if (!n.warnings.empty()) j["warnings"] = n.warnings;
  j["seconds_tracing"] = n.seconds;
  j["seconds"] = done.seconds;
  j["beams_per_s"] = rate;
  std::string text =
      fmt::format("{} beams: {} hits, {} misses\n", n.beams, n.beams - misses, misses);
  if (sub_rays) {
    text += fmt::format("  echoes      {}, of {} sub-rays a beam", n.hits, sub_rays);
    text += mean_traced < double(sub_rays) ? fmt::format(" ({:.1f} traced)\n", mean_traced) : "\n";
  }
  text += fmt::format("  {}     {:.2f} s, {} beams/s ({} threads, {})\n  all         {:.2f} s\n",
                      sub_rays ? "answers" : "tracing", n.seconds, si(rate), threads(),
                      traced.still().isa(), done.seconds);
  if (!intensities.empty()) text += fmt::format("  intensity   {}\n", intensities);
  if (traced.sway_s() > 0) {
    text +=
        fmt::format("  matter      sways with a correlation time of {:.2g} s\n", traced.sway_s());
  }
  if (!lost.empty()) text += fmt::format("  not kept    {}\n", lost);
  if (!a.files.waveforms.empty()) {
    text += fmt::format("  waveforms   {}; beams of keyframes have none\n", done.waveforms);
  }
  text += text_of_model(done, model);
  if (world.read.parts) text += text_of(world);
  text += text_of_warnings(n.warnings);
  verb.report(j, text + fmt::format("  log         {}\n", a.output));
}

void run(const Verb& verb, Arguments& a) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  for (const std::string& file : a.files.waveforms) {
    require(a.rig.empty() || !report::is_waveform_file(file),
            "simulate: waveforms of all beams are those of one sensor, not of --rig");
  }
  report::WaveformOutputs waveforms(a.files.waveforms);
  waveforms.receive_from(a.options);
  a.options.seed = verb.seed;
  a.options.check();
  const pipeline::TracedWorld traced(world_of(a), pipeline::matter_of(a.options));
  const pipeline::RequestedBeams beams = beams_of(a);
  pipeline::Simulation simulation = beams.simulation(traced, a.options);
  const std::string origin = provenance(verb, inputs_of(a));
  const auto write = [&](BeamSource& log) {
    if (a.files.profile.empty()) return io::export_log(a.output, log, "", origin);
    io::export_driver_layout(a.output, log, io::driver_layout_from_name(a.files.profile),
                             beams.path(), origin);
  };
  Progress progress("simulate");
  pipeline::SimulateCounts counts =
      pipeline::simulate_log(simulation, beams.source(), write, std::ref(progress));
  if (std::string note = text_of_other_sensor(a, beams.source().info()); !note.empty())
    counts.warnings.push_back(std::move(note));
  for (std::string& note : pipeline::warnings_of_path(beams.path()))
    counts.warnings.push_back(std::move(note));
  waveforms.write(simulation.sensor());
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  report(verb, a, {simulation, counts, beams.source().info(), seconds, waveforms.size()},
         report::WorldSummary{traced.own()->read, traced.own()->info});
}

}  // namespace simulate_verb
}  // namespace

void add_simulate(Program& program) {
  using namespace simulate_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Simulation", "simulate",
      "Simulate beams on a model or scene: those of a log, or of a sensor on a trajectory",
      "underbrush simulate model/ --like log.ply -o sim.ply\n"
      "  underbrush simulate model/ --sensor velodyne-hdl32e --trajectory log.ply -o sim.ply\n"
      "  underbrush simulate model/ --rig rig.yaml --trajectory poses.txt --super-sample sensor -o "
      "sim.ply",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
