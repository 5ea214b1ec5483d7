#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "studies/mesh_fidelity.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::studies {

void add_conditions(const StudyRun& run, const SweepPlant& plant, StudyResult& result) {
  report::Table table{"What the score of one plant depends on: " + plant.name,
                   "The same plant and way; each row changes one thing.",
                   {"condition", "points", "μ", "σ", "ε", "criterion", "gap"},
                   {}};
  const auto add = [&](const std::string& name, const std::vector<Vec3f>& cloud) {
    const metrics::LeafInclination leaves = metrics::leaf_inclination(cloud);
    std::vector<std::string> row{name};
    for (std::string& cell : cells(leaves)) row.push_back(std::move(cell));
    table.rows.push_back(std::move(row));
    result.figures["conditions"][name] = json_of(leaves);
  };
  const BeamLog beams = approach_beams(plant.plant, run.quick, {});
  const BeamLog scan = approach_scan(plant.plant, beams, run.seed);
  const std::vector<Vec3f> cloud = registered(scan, {}, run.seed);
  add("as in the sweep", cloud);
  add("registered to 2 cm, 0.1°", registered(scan, kOdometry, run.seed));
  ApproachOptions worse = kOdometry;
  worse.registration_m *= 2, worse.registration_rad *= 2;
  add("registered to 4 cm, 0.2°", registered(scan, worse, run.seed));
  const BeamLog flat = approach_beams(plant.plant, run.quick, kSmooth);
  add("no pitch, roll or heave", registered(approach_scan(plant.plant, flat, run.seed), {}, 0));
  add("no noise of the range",
      registered(approach_scan(plant.plant, beams, run.seed, {0, 9}), {}, 0));
  add("one thin ray a beam, no noise",
      registered(approach_scan(plant.plant, beams, run.seed, {0, 1}), {}, 0));
  std::vector<Vec3f> few;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (random_bits(run.seed, uint32_t(i), Purpose::kSignal) % 8 == 0) few.push_back(cloud[i]);
  }
  add("every eighth point", few);
  std::vector<Vec3f> surface = surface_points(plant.plant, cloud.size(), run.seed);
  add("no lidar: as many points drawn from the surface", surface);
  for (Vec3f& p : surface) p = {p.x(), -p.z(), p.y()};
  add("the same, the plant lying on its side", surface);
  add("no lidar: ten times the points", surface_points(plant.plant, 10 * cloud.size(), run.seed));
  result.tables.push_back(table);
}

void add_sensors(const StudyRun& run, const std::vector<SweepPlant>& plants, StudyResult& result) {
  report::Table table{
      "The same plants by other sensors",
      "Single sensors stand where the upper one of the sweep does; a single scan is "
      "taken so far before the plant. Seen: heights above the ground, 1 and 99 %.",
      {"plant", "sensor", "from", "seen, m", "points", "μ", "σ", "ε", "criterion", "gap"},
      {}};
  const auto add = [&](const SweepPlant& plant, const std::string& sensor, const std::string& from,
                       const ApproachOptions& options) {
    const BeamLog beams = approach_beams(plant.plant, run.quick, options);
    const std::vector<Vec3f> cloud = registered(approach_scan(plant.plant, beams, run.seed), {}, 0);
    if (cloud.size() < 30) return;
    std::vector<float> z;
    z.reserve(cloud.size());
    for (const Vec3f& p : cloud) z.push_back(p.z());
    std::sort(z.begin(), z.end());
    const metrics::LeafInclination leaves = metrics::leaf_inclination(cloud);
    std::vector<std::string> row{
        plant.name, sensor, from,
        fmt::format("{:.1f} to {:.1f}", z[z.size() / 100], z[z.size() - 1 - z.size() / 100])};
    for (std::string& cell : cells(leaves)) row.push_back(std::move(cell));
    table.rows.push_back(std::move(row));
    result.figures["sensors"][plant.name][sensor + ", " + from] = json_of(leaves);
  };
  for (const SweepPlant& plant : plants) {
    const std::array known{"broadleaf 80 mm", "conifer 150 mm", "shrub 250 mm"};
    if (std::find(known.begin(), known.end(), plant.name) == known.end()) continue;
    run.say(plant.name + " by other sensors");
    add(plant, "two OS1-64", "the approach", {});
    for (const char* sensor : {"ouster-os1-64", "velodyne-hdl64e"}) {
      ApproachOptions options;
      options.sensor = sensor;
      options.lower = false;
      add(plant, sensor, "the approach", options);
      for (const double distance : {5.0, 10.0, 20.0}) {
        options.from_m = distance;
        options.to_m = distance - 0.5;
        add(plant, sensor, fmt::format("{:g} m, one scan", distance), options);
      }
    }
  }
  if (!table.rows.empty()) result.tables.push_back(table);
}

}  // namespace underbrush::studies
