#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "steps.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {

struct Arguments {
  std::string model, like, sensor, trajectory, output, draw = "on_ray", beam = "thin";
  double tau = 0;
  simulate::Options simulate;
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("MODEL", a.model, "The folder of a model, or of a scene that compose made")
      ->required();
  app.add_option("-o,--output", a.output,
                 "Where the simulated log goes: .ply, .pcd, .csv, or a folder/ of KITTI .bin")
      ->required();
  auto* like = app.add_option("--like", a.like, "Answer the beams of this log")->type_name("LOG");
  auto* sensor =
      app.add_option("--sensor", a.sensor, "Fire a sensor of the catalogue (or a YAML file)");
  auto* trajectory = app.add_option("--trajectory", a.trajectory, "Poses of the sensor, TUM format")
                         ->type_name("POSES.txt");
  like->excludes(sensor);
  sensor->needs(trajectory);
  trajectory->needs(sensor);
  app.add_option("--draw", a.draw, "Where in an ellipsoid a range is drawn")
      ->check(CLI::IsMember({"on_ray", "volumetric"}))
      ->capture_default_str();
  app.add_option("--beam", a.beam,
                 "The ray that is traced: the beam's axis, or drawn from the sensor's cone")
      ->check(CLI::IsMember({"thin", "random"}))
      ->capture_default_str();
  app.add_option("--tau", a.tau,
                 "Mahalanobis distance within which a beam meets an ellipsoid, 0 = the model's")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--max-range", a.simulate.max_range_m,
                 "Maximum range, m, 0 = the log's or the sensor's")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--range-noise", a.simulate.range_noise_m, "Further noise on every range, m")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_flag("--element-ids", a.simulate.element_ids,
               "Write the element that stopped each beam, and its class");
}

Trajectory trajectory_of(const std::string& file) {
  const io::PoseList list = io::read_poses(file);
  if (list.time_s.empty()) {
    throw FormatError(file, "", "its poses have no times; give TUM rows (t tx ty tz qx qy qz qw)");
  }
  if (list.pose.size() < 2) throw FormatError(file, "", "a trajectory needs at least two poses");
  std::vector<StampedPose> poses(list.pose.size());
  for (size_t i = 0; i < poses.size(); ++i) poses[i] = {list.time_s[i], list.pose[i]};
  return Trajectory(std::move(poses));
}

std::unique_ptr<BeamSource> beams_of(const Arguments& a, Trajectory& path) {
  if (!a.like.empty()) return std::make_unique<io::LogReader>(a.like);
  require(!a.sensor.empty(), "simulate: give --like LOG, or --sensor NAME --trajectory POSES");
  path = trajectory_of(a.trajectory);
  return std::make_unique<sensor::PatternSource>(
      sensor::load(a.sensor), path, path.poses().front().time_s, path.poses().back().time_s);
}

void run(const Verb& verb, Arguments& a) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  elements::Scene scene;
  if (elements::is_scene(a.model)) {
    scene = elements::read_scene(a.model);
  } else {
    scene.models.push_back(elements::read_model(a.model));
  }
  for (elements::Model& model : scene.models) {
    if (a.tau > 0) model.tau = a.tau;
  }
  // A model alone takes the shorter way, and gives the same bits as ever.
  const trace::World world =
      scene.instances.empty() ? trace::World(scene.models[0]) : trace::World(scene);
  Trajectory path;
  const std::unique_ptr<BeamSource> beams = beams_of(a, path);
  a.simulate.seed = verb.seed;
  a.simulate.draw =
      a.draw == "on_ray" ? simulate::RangeDraw::kOnRay : simulate::RangeDraw::kVolumetric;
  if (a.beam == "random") {
    const std::string sensor = a.like.empty() ? a.sensor : beams->info().sensor;
    require(!sensor.empty(), "simulate: --beam random, but the log does not name its sensor");
    a.simulate.random_ray = sensor::load(sensor).beam;
  }
  std::vector<std::filesystem::path> inputs{a.model, a.like.empty() ? a.trajectory : a.like};
  if (std::filesystem::is_regular_file(a.sensor)) inputs.emplace_back(a.sensor);
  const SimulateStep step = simulate_log(verb, world, *beams, a.simulate, a.output, inputs);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const double rate = double(step.beams) / std::max(step.seconds_tracing, 1e-9);
  Json j;
  j["beams"] = step.beams;
  j["hits"] = step.hits;
  j["misses"] = step.beams - step.hits;
  j["seconds_tracing"] = step.seconds_tracing;
  j["seconds"] = seconds;
  j["beams_per_s"] = rate;
  verb.report(j, fmt::format("{} beams: {} hits, {} misses\n"
                             "  tracing     {:.2f} s, {} beams/s ({} threads, {})\n"
                             "  all         {:.2f} s\n  log         {}\n",
                             step.beams, step.hits, step.beams - step.hits, step.seconds_tracing,
                             si(rate), threads(), step.isa, seconds, a.output));
}

}  // namespace

void add_simulate(CLI::App& root) {
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      root, "simulate",
      "Answer beams from a model or scene: those of a log, or of a sensor on a trajectory",
      "underbrush simulate model/ --like log.ply -o sim.ply\n"
      "  underbrush simulate scene/ --like log.ply -o sim.ply\n"
      "  underbrush simulate model/ --sensor velodyne-hdl32e --trajectory poses.txt -o sim.ply",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb->app, *a);
}

}  // namespace underbrush::app
