#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "answer.hpp"
#include "cli/progress.hpp"
#include "light_report.hpp"
#include "rig_answer.hpp"
#include "stages.hpp"
#include "traced_scene.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/io/driver_layout.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "verbs.hpp"
#include "world_summary.hpp"

namespace underbrush::app {
namespace {
namespace simulate_verb {

struct Arguments {
  std::string model, like, sensor, rig, trajectory, output, profile, matter = "once";
  AnswerArguments answer;
  SceneArguments target;
};

void add_beam_options(CLI::App& app, Arguments& a) {
  auto* like =
      app.add_option("--like", a.like, "Simulate this log's beams (by --sensor or its own)")
          ->type_name("LOG");
  auto* sensor =
      app.add_option("--sensor", a.sensor, "Simulate a sensor of the catalogue (or a YAML file)");
  auto* rig =
      app.add_option("--rig", a.rig, "Simulate all sensors of a vehicle")->type_name("RIG.yaml");
  auto* trajectory =
      app.add_option("--trajectory", a.trajectory, "Poses of the sensor or vehicle, TUM format")
          ->type_name("POSES.txt");
  like->excludes(trajectory);
  rig->excludes(sensor);
  rig->needs(trajectory);
}

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("MODEL", a.model,
                 "The folder of a model or scene, or a world of another program, such as a mesh")
      ->required();
  verb.output("-o,--output", a.output,
              "The simulated log: .ply, .pcd, .csv, or a folder/ of KITTI .bin files (with "
              "--profile: of PCD files)")
      ->required();
  add_beam_options(app, a);
  app.add_flag("--element-ids", a.answer.simulate.element_ids,
               "Write the element that stopped each beam, and its class; for a scene also the "
               "plant (column instance)");
  verb.begin_rare_group("Drivers");
  app.add_option(
         "--profile", a.profile,
         "Write a folder with a PCD file for each scan, in this driver's PointCloud2 layout")
      ->check(CLI::IsMember({"velodyne", "ouster", "autoware"}));
  verb.begin_rare_group("Matter");
  app.add_option(
         "--matter", a.matter,
         "Draw the world's matter once, so that beams which pass near each other meet the same "
         "leaf, or anew for each beam")
      ->check(CLI::IsMember({"once", "anew"}))
      ->capture_default_str();
  app.add_option("--grain", a.target.grain_m,
                 "Size of what beams meet as one, with --matter once, m; 0 = the model's")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb.begin_rare_group("Wind");
  app.add_option("--wind", a.answer.simulate.sway_s,
                 "Time in which the leaves that a beam meets become others, with --matter once, s; "
                 "0 = they stand still")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb.begin_rare_group("Thin rays");
  app.add_option("--draw", a.answer.draw,
                 "Draw the range in an ellipsoid along the beam or in its volume, or draw nothing "
                 "and answer the median of all that a beam may measure, which has the least error")
      ->check(CLI::IsMember({"on_ray", "volumetric", "median"}))
      ->capture_default_str();
  app.add_option("--intensity", a.answer.intensity,
                 "Answer the expected intensity of an element, or draw it with the element's "
                 "spread; for models that were fitted to a log with intensities")
      ->check(CLI::IsMember({"mean", "drawn"}))
      ->capture_default_str();
  app.add_option("--beam", a.answer.beam,
                 "Trace a ray on the beam's axis, or one drawn from the sensor's cone")
      ->check(CLI::IsMember({"thin", "random"}))
      ->capture_default_str();
  app.add_option("--max-range", a.answer.simulate.max_range_m,
                 "Maximum range, m; 0 = the log's or the sensor's")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--range-noise", a.answer.simulate.range_noise_m,
                 "Standard deviation of additional noise on every range, m")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

constexpr size_t kChunk = 1 << 18;  // Number of beams; each may have up to 16 echoes.

/// Throws `FormatError` where poses lie so far apart in time that one of them must be wrong.
void check_gaps(const std::string& file, const Trajectory& path) {
  constexpr double kLongestS = 3600;
  for (size_t k = 1; k < path.poses().size(); ++k) {
    const double gap_s = path.poses()[k].time_s - path.poses()[k - 1].time_s;
    if (gap_s <= kLongestS) continue;
    throw FormatError(file, fmt::format("poses {} and {}", k, k + 1),
                      fmt::format("{:.1f} s apart, more than an hour", gap_s));
  }
}

std::unique_ptr<BeamSource> beams_of(const Arguments& a, Trajectory& path) {
  if (!a.like.empty()) return std::make_unique<io::BeamReader>(a.like, kChunk);
  require(!a.trajectory.empty() && a.sensor.empty() == !a.rig.empty(),
          "simulate: give --like LOG, or --sensor NAME or --rig FILE with --trajectory POSES");
  path = io::read_trajectory(a.trajectory);
  if (path.empty()) throw FormatError(a.trajectory, "", "holds no pose");
  if (path.poses().size() < 2 && !a.rig.empty()) {
    throw FormatError(a.trajectory, "", "a vehicle needs at least two poses");
  }
  check_gaps(a.trajectory, path);
  try {
    if (!a.rig.empty()) {
      return std::make_unique<perception::RigSource>(perception::load_rig(a.rig), path, kChunk);
    }
    const sensor::Sensor sensor = sensor::load(a.sensor);
    if (path.poses().size() == 1) path = sensor::one_scan(sensor, path.poses().front());
    return std::make_unique<sensor::PatternSource>(sensor, path, path.poses().front().time_s,
                                                   path.poses().back().time_s, kChunk);
  } catch (const std::invalid_argument& e) {
    throw FormatError(a.trajectory, "", e.what());
  }
}

/// Returns the sensor of the beams, where one is needed.
sensor::Sensor sensor_of(const Arguments& a, const BeamSource& beams, const char* what) {
  if (!a.sensor.empty()) return sensor::load(a.sensor);
  if (beams.info().sensor.empty()) {
    throw std::invalid_argument(std::string("simulate: ") + what +
                                ", but the log does not name its sensor");
  }
  return sensor::sensor_of_log(a.like, beams.info());
}

/// Writes the log, and reports what the format cannot hold of it.
SimulateStep write(const Verb& verb, const Arguments& a, simulate::SimulatedSource& simulated,
                   const Trajectory& path, std::string& lost) {
  std::vector<std::filesystem::path> inputs{a.model, a.like.empty() ? a.trajectory : a.like};
  for (const auto& file : mover_files(a.target)) inputs.push_back(file);
  for (const std::string& file : {a.sensor, a.rig, a.answer.instrument.materials}) {
    if (std::filesystem::is_regular_file(file)) inputs.emplace_back(file);
  }
  const std::string extension = std::filesystem::path(a.output).extension().string();
  lost = io::lost_in(!a.profile.empty()  ? a.profile
                     : extension.empty() ? "kitti"
                                         : extension.substr(1));
  if (a.answer.simulate.element_ids && !lost.empty() && extension != ".pcd") {
    lost += ", element, class and instance numbers";
  }
  return simulate_log(
      verb, simulated,
      [&](BeamSource& log, const std::string& origin) {
        if (a.profile.empty()) return io::export_log(a.output, log, "", origin);
        io::export_driver_layout(a.output, log, io::driver_layout_from_name(a.profile), path,
                                 origin);
      },
      inputs);
}

void report(const Verb& verb, const Arguments& a, const SimulateStep& step, size_t sub_rays,
            size_t traced, double seconds, std::string_view isa, const std::string& lost,
            const WorldSummary& world, const elements::Model& model, const LogInfo& beams,
            const std::string& intensities, bool keyframes) {
  const double rate = double(step.beams) / std::max(step.seconds_tracing, 1e-9);
  const size_t misses = step.rows - step.hits;
  Json j;
  j["beams"] = step.beams;
  j["hits"] = step.beams - misses;
  j["misses"] = misses;
  if (sub_rays) j["echoes"] = step.hits;
  if (sub_rays) j["sub_rays"] = sub_rays;
  if (sub_rays) j["sub_rays_traced"] = double(traced) / double(std::max<size_t>(1, step.beams));
  if (!lost.empty()) j["lost"] = lost;
  if (!model.channels.empty()) j["channel_offsets"] = model.channels_of(beams).size();
  if (!intensities.empty()) j["intensity"] = intensities;
  if (model.keyframes) j["keyframes"] = keyframes;
  if (world.read.parts) j["world"] = json_of(world);
  j["seconds_tracing"] = step.seconds_tracing;
  j["seconds"] = seconds;
  j["beams_per_s"] = rate;
  std::string text =
      fmt::format("{} beams: {} hits, {} misses\n", step.beams, step.beams - misses, misses);
  if (sub_rays) {
    text += fmt::format("  echoes      {}, of {} sub-rays a beam", step.hits, sub_rays);
    const double mean = double(traced) / double(std::max<size_t>(1, step.beams));
    text += mean < double(sub_rays) ? fmt::format(" ({:.1f} traced)\n", mean) : "\n";
  }
  text += fmt::format("  {}     {:.2f} s, {} beams/s ({} threads, {})\n  all         {:.2f} s\n",
                      sub_rays ? "answers" : "tracing", step.seconds_tracing, si(rate), threads(),
                      isa, seconds);
  if (!intensities.empty()) text += fmt::format("  intensity   {}\n", intensities);
  if (!lost.empty()) text += fmt::format("  not kept    {}\n", lost);
  if (!model.channels.empty()) {
    const size_t added = model.channels_of(beams).size();
    text += added > 0 ? fmt::format("  channels    {} range offsets added\n", added)
                      : fmt::format("  channels    no range offsets added: they are of {}\n",
                                    printable(model.sensor));
  }
  if (model.keyframes) {
    text += keyframes
                ? fmt::format("  keyframes   beams near {} of them are answered as recorded\n",
                              model.keyframes->frames.size())
                : fmt::format(
                      "  keyframes   not used: they are of thin rays of {}, without "
                      "elements, movers or wind\n",
                      printable(model.sensor));
  }
  if (world.read.parts) text += text_of(world);
  verb.report(j, text + fmt::format("  log         {}\n", a.output));
}

void run(const Verb& verb, Arguments& a) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  a.answer.instrument.check();
  elements::SceneInfo info;
  worlds::WorldReport read;
  const elements::Scene scene = scene_of(a.model, a.target, info, &read);
  const TracedScene target =
      traced_scene(scene, info, draws_of(a.matter, a.answer.simulate.sway_s));
  if (!scene.instances.empty()) a.answer.simulate.instance_labels = info.labels;
  const simulate::InstanceKinds kinds = simulate::instance_kinds(scene, info);
  const radiometry::Materials materials = materials_of(a.answer.instrument, kinds);
  for (const std::string& name : info.materials) {
    if (!name.empty()) materials.named(name);  // throws for an unknown name
  }
  Trajectory path;
  const std::unique_ptr<BeamSource> beams = beams_of(a, path);
  a.answer.simulate.seed = verb.seed;
  const auto made = [&](const Answer::SensorOf& sensor_of) {
    return std::make_unique<Answer>(a.answer, *target.dynamic_world, kinds,
                                    recorder_of(scene.models), sensor_of);
  };
  for (const std::string& file : a.answer.instrument.waveforms) {
    require(a.rig.empty() || !is_waveform_file(file),
            "simulate: waveforms of all beams are those of one sensor, not of --rig");
  }
  const auto answered = [&](auto& answer) {
    simulate::SimulatedSource simulated(std::ref(answer), *beams, a.answer.simulate.max_range_m);
    if (a.answer.simulate.element_ids) simulated.name_classes(elements::element_classes(info));
    std::string lost;
    const SimulateStep step = write(verb, a, simulated, path, lost);
    answer.write_waveforms();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    report(verb, a, step, answer.sub_rays(), answer.rays_traced(), seconds,
           target.dynamic_world->world().isa(), lost, WorldSummary{read, info},
           target.dynamic_world->model(0), beams->info(),
           intensities_in_words(scene.models, beams->info(), answer.sub_rays() > 0),
           answer.sub_rays() == 0 &&
               simulate::keyframes_serve(*target.dynamic_world, a.answer.simulate, beams->info()));
  };
  if (const auto* rig = dynamic_cast<const perception::RigSource*>(beams.get())) {
    RigAnswer answer(rig->sensors(),
                     [&](const sensor::Sensor& s) { return made([&](const char*) { return s; }); });
    return answered(answer);
  }
  const auto answer = made([&](const char* what) { return sensor_of(a, *beams, what); });
  answered(*answer);
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
      "  underbrush simulate model/ --sensor velodyne-hdl32e --trajectory poses.txt -o sim.ply\n"
      "  underbrush simulate model/ --rig rig.yaml --trajectory poses.txt --super-sample sensor -o "
      "sim.ply",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
  add_scene_options(*verb, a->target);
  add_instrument_options(*verb, a->answer.instrument);
}

}  // namespace underbrush::app
