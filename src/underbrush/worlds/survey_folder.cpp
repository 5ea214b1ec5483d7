#include "underbrush/worlds/survey_folder.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::worlds {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

std::string poses_text(const Trajectory& trajectory) {
  std::string text = "# world from sensor: time x y z qx qy qz qw\n";
  for (const StampedPose& p : trajectory.poses()) {
    const Vec3& t = p.world_from_sensor.translation;
    const Eigen::Quaterniond& q = p.world_from_sensor.rotation;
    char line[256];
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", p.time_s,
                  t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    text += line;
  }
  return text;
}

std::string name_of(const SurveyLeg& leg) { return "leg-" + std::to_string(leg.number); }

/// Writes the sensor and the path of a leg. Throws `FormatError` for a sensor that no simulation
/// takes.
void write_leg(const fs::path& folder, const fs::path& survey, const SurveyLeg& leg) {
  const fs::path file = folder / (name_of(leg) + ".yaml");
  write_file(file, leg.sensor);
  if (!leg.table_name.empty()) write_file(folder / leg.table_name, leg.directions);
  write_file(folder / (name_of(leg) + ".txt"), poses_text(leg.trajectory));
  try {
    sensor::load(file.string());
  } catch (const FormatError& e) {
    throw FormatError(survey.string(), "leg " + std::to_string(leg.number), e.reason());
  }
}

}  // namespace

void check_survey_output(const fs::path& path) {
  io::check_output_folder(path, fs::is_regular_file(path / "survey.json"), "not a survey");
}

std::string write_survey(const fs::path& path, const World& world, const Survey& survey,
                         const std::string& provenance) {
  check_survey_output(path);
  Json j{{"format", "underbrush-survey"}, {"version", 1}, {"name", survey.name}};
  j["scene"] = "scene";
  j["legs"] = Json::array();
  for (const SurveyLeg& leg : survey.legs) {
    const auto& poses = leg.trajectory.poses();
    j["legs"].push_back({{"number", leg.number},
                         {"sensor", name_of(leg) + ".yaml"},
                         {"trajectory", name_of(leg) + ".txt"},
                         {"start_s", poses.front().time_s},
                         {"end_s", poses.back().time_s}});
  }
  j["left_out"] = survey.left_out;
  j["provenance"] = io::json_of_text(provenance);
  elements::SceneInfo info = world.info;
  info.provenance = provenance;
  std::string text = io::text_of_json(j, 1) + "\n";
  io::write_atomically(
      path,
      [&](const fs::path& folder) {
        make_temporary_folders(folder);
        elements::write_scene(folder / "scene", world.scene, info);
        for (const SurveyLeg& leg : survey.legs) write_leg(folder, survey.file, leg);
        write_file(folder / "survey.json", text);
      },
      io::OutputKind::kFolder);
  return text;
}

}  // namespace underbrush::worlds
