#include "studies/chain_lists.hpp"

#include <filesystem>

#include "underbrush/actors/actor.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/osi/chain.hpp"
#include "underbrush/osi/objects.hpp"

namespace underbrush::studies {
namespace {
namespace fs = std::filesystem;

std::string name_of(uint64_t object) { return "object-" + std::to_string(object); }

/// The strategies up to the points of all beams, in the world of a folder.
osi::Chain sensing(const LogInfo& log, const fs::path& folder, uint64_t seed) {
  osi::ChainFile file = osi::traced_chain();
  std::erase_if(file.strategies, [](const osi::StrategyEntry& e) {
    return e.name != "tracer" && e.name != "front_end" && e.name != "alignment";
  });
  for (const char* name : {"tracer", "front_end"}) {
    file.set(name, "sensor", log.sensor);
    file.set(name, "seed", std::to_string(seed));
  }
  for (const char* axis : {"x_m", "z_m"}) file.set("tracer", axis, "0");
  file.set("tracer", "world", folder / "world");
  file.set("tracer", "mover_models", folder / "objects");
  return osi::Chain(file);
}

osi::Chain tracking(std::map<std::string, std::string> parameters, const char* pipeline,
                    uint64_t seed) {
  parameters["pipeline"] = pipeline;
  parameters["seed"] = std::to_string(seed);
  return osi::Chain({{{"tracking", "", std::move(parameters), "study", "tracking"}}});
}

/// What the FMU is given for a scan: the truth, with the vehicle's frame at the sensor.
osi::SensorView view_of(const ScanInfo& scan, const perception::TruthFrame& frame) {
  osi::SensorView view;
  view.version = osi::Version{};
  view.timestamp = osi::Timestamp::of(scan.time_s);
  view.truth = osi::ground_truth_of(frame, scan.world_from_sensor, scan.time_s);
  view.host_vehicle_id = osi::kHostId;
  for (osi::MovingObject& m : view.truth->moving) m.model_reference = name_of(m.id + 1);
  return view;
}

}  // namespace

ChainLists chain_lists(const LogInfo& log, const perception::LogTruth& truth,
                       const ChainWorld& world,
                       const std::map<std::string, std::string>& parameters, uint64_t seed) {
  require(!log.sensor.empty(), "study: the log does not name its sensor");
  const TemporaryPath folder(fs::temp_directory_path(), "chain");
  make_temporary_folders(folder.path() / "objects");
  elements::write_model(folder.path() / "world", world.world);
  for (size_t k = 0; k < world.tracks.size(); ++k) {
    elements::write_model(folder.path() / "objects" / name_of(world.tracks[k].id),
                          actors::at_zero(world.models[k]));
  }
  osi::Chain sensor = sensing(log, folder.path(), seed);
  osi::Chain model = tracking(parameters, "model", seed);
  osi::Chain pipeline = tracking(parameters, "real", seed);
  const auto scans = log.scans.size();
  const double cycle_s =
      scans > 1 ? (log.scans.back().time_s - log.scans.front().time_s) / double(scans - 1) : 0;
  ChainLists out;
  perception::TruthFrame frame;
  for (const ScanInfo& scan : log.scans) {
    truth.at(scan.scan, scan.time_s, cycle_s, frame);
    const osi::SensorView view = view_of(scan, frame);
    osi::SensorData data = sensor.step(std::make_shared<osi::SensorView>(view));
    data.views = {std::make_shared<osi::SensorView>(view)};  // without the many reflections
    osi::SensorData same = data;
    model.step(data);
    pipeline.step(same);
    out.model.push_back(osi::list_of(data));
    out.pipeline.push_back(osi::list_of(same));
  }
  return out;
}

}  // namespace underbrush::studies
