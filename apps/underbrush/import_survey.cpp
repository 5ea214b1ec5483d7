#include "import_survey.hpp"

#include <fmt/format.h>

#include <fstream>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/worlds/helios_survey.hpp"
#include "underbrush/worlds/read_world.hpp"
#include "world_summary.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

void check_survey_output(const fs::path& path) {
  io::check_output(path, io::OutputKind::kFolder);
  if (fs::exists(path) && !fs::is_regular_file(path / "survey.json") && !fs::is_empty(path)) {
    throw IoError(path.string() +
                  ": cannot write: exists and is not a survey; remove it or name another");
  }
}

std::string poses_text(const Trajectory& trajectory) {
  std::string text = "# world from sensor: time x y z qx qy qz qw\n";
  for (const StampedPose& p : trajectory.poses()) {
    const Vec3& t = p.world_from_sensor.translation;
    const Eigen::Quaterniond& q = p.world_from_sensor.rotation;
    text += fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n",
                        p.time_s, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

Json json_of_legs(const worlds::Survey& survey) {
  Json legs = Json::array();
  for (const worlds::SurveyLeg& leg : survey.legs) {
    const auto& poses = leg.trajectory.poses();
    legs.push_back({{"number", leg.number},
                    {"sensor", fmt::format("leg-{}.yaml", leg.number)},
                    {"trajectory", fmt::format("leg-{}.txt", leg.number)},
                    {"start_s", poses.front().time_s},
                    {"end_s", poses.back().time_s}});
  }
  return legs;
}

std::string commands_of(const worlds::Survey& survey, const std::string& folder) {
  std::string text;
  for (size_t k = 0; k < survey.legs.size() && k < 8; ++k) {
    text += fmt::format(
        "  underbrush simulate {0}/scene --sensor {0}/leg-{1}.yaml --trajectory {0}/leg-{1}.txt -o "
        "leg-{1}.ply\n",
        folder, survey.legs[k].number);
  }
  return text;
}

}  // namespace

void import_survey(const Verb& verb, const fs::path& path, const fs::path& output,
                   const fs::path& assets) {
  check_survey_output(output);
  const worlds::World world = worlds::read_helios_scene(path, "", assets);
  const worlds::Survey survey = worlds::read_helios_survey(
      path, [&](double x, double y) { return worlds::ground_at(world, x, y); }, assets);
  Json j{{"format", "underbrush-survey"}, {"version", 1}, {"name", survey.name}};
  j["scene"] = "scene";
  j["legs"] = json_of_legs(survey);
  j["left_out"] = survey.left_out;
  const std::string origin = provenance(verb, {path});
  j["provenance"] = io::json_of_text(origin);
  elements::SceneInfo info = world.info;
  info.provenance = origin;
  io::write_atomically(
      output,
      [&](const fs::path& folder) {
        make_temporary_folders(folder);
        elements::write_scene(folder / "scene", world.scene, info);
        for (const worlds::SurveyLeg& leg : survey.legs) {
          const std::string name = fmt::format("leg-{}", leg.number);
          write_file(folder / (name + ".yaml"), leg.sensor);
          write_file(folder / leg.table_name, leg.directions);
          write_file(folder / (name + ".txt"), poses_text(leg.trajectory));
        }
        write_file(folder / "survey.json", io::text_of_json(j, 1) + "\n");
      },
      io::OutputKind::kFolder);
  const WorldSummary summary{world.report, world.info};
  j["world"] = json_of(summary);
  std::string text = fmt::format("{}: survey of {} legs on which the scanner measures\n",
                                 path.string(), survey.legs.size());
  text += text_of(summary);
  for (const auto& [what, n] : survey.left_out) {
    text += fmt::format("  left out    {} ({})\n", n, what);
  }
  text += fmt::format("  survey      {}\n", output.string());
  verb.report(j, text + commands_of(survey, output.lexically_normal().string()));
}

}  // namespace underbrush::app
