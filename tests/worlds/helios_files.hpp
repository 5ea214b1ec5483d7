/// \file
/// This file writes the files of scenes and surveys of HELIOS++ for the tests.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/worlds/helios_scene.hpp"
#include "underbrush/worlds/helios_survey.hpp"
#include "underbrush/worlds/survey_folder.hpp"

namespace underbrush::worlds {

namespace fs = std::filesystem;

class Helios : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  fs::path scene(const std::string& parts) {
    write("parts/a.obj", "v 1 2 3\nv 4 5 6.5\nv -1 0.25 2\nf 1 2 3\n");
    write("parts/ground.obj",
          "mtllib g.mtl\nv -100 -100 0\nv 100 -100 0\nv 0 200 10\nusemtl earth\nf 1 2 3\n");
    write("parts/g.mtl", "newmtl earth\nhelios_isGround 1\n");
    return write("s.xml", "<?xml version=\"1.0\"?>\n<document><scene id=\"s\" name=\"S\">\n" +
                              parts + "</scene></document>\n");
  }
  std::string refused(const fs::path& file) {
    try {
      read_helios_scene(file);
    } catch (const FormatError& e) {
      return e.what();
    }
    return "";
  }
  io::TemporaryFolder folder;
};

inline std::string filter(const std::string& type, const std::string& params) {
  return "<filter type=\"" + type + "\">" + params + "</filter>";
}
inline std::string param(const std::string& key, const std::string& value) {
  return "<param type=\"string\" key=\"" + key + "\" value=\"" + value + "\"/>";
}
inline const std::string kObj = filter("objloader", param("filepath", "parts/a.obj"));

class HeliosSurvey : public Helios {
 protected:
  fs::path survey(const std::string& attributes, const std::string& content,
                  const std::string& optics, const std::string& more = "",
                  const std::string& children = "") {
    scene("<part>" + kObj + "</part>");
    write("platforms.xml",
          "<document><platform id=\"tripod\" type=\"static\"><scannerMount x=\"0\" y=\"0\" "
          "z=\"1.5\"/></platform>"
          "<platform id=\"plane\" type=\"linearpath\"><scannerMount z=\"0.7\"><rot axis=\"x\" "
          "angle_deg=\"-90\"/>"
          "<rot axis=\"z\" angle_deg=\"90\"/></scannerMount></platform>"
          "<platform id=\"copter\" type=\"multicopter\"/></document>");
    write("scanners.xml",
          "<document><scanner id=\"one\" accuracy_m=\"0.01\" beamDivergence_rad=\"0.001\" "
          "pulseLength_ns=\"5\" rangeMin_m=\"0.5\" rangeMax_m=\"250\" scanAngleMax_deg=\"60\" "
          "scanAngleEffectiveMax_deg=\"50\" headRotatePerSecMax_deg=\"40\" wavelength_nm=\"1550\" "
          "maxNOR=\"4\" optics=\"" +
              optics + "\" " + more +
              "><FWFSettings beamSampleQuality=\"2\"/><beamOrigin z=\"0.2\"/>" + children +
              "</scanner></document>");
    return write("survey.xml",
                 "<document>\n<scannerSettings id=\"t\" active=\"true\" pulseFreq_hz=\"1000\" "
                 "scanFreq_hz=\"10\" scanAngle_deg=\"45\"/>\n<survey name=\"v\" scene=\"s.xml#s\" "
                 "scanner=\"scanners.xml#one\" " +
                     attributes + ">" + content + "</survey></document>");
  }
  /// Writes the files of a leg and returns the beams that it fires.
  BeamLog beams_of(const SurveyLeg& leg) {
    write("leg.yaml", leg.sensor);
    if (!leg.table_name.empty()) write(leg.table_name, leg.directions);
    sensor_ = sensor::load((folder / "leg.yaml").string());
    const auto& poses = leg.trajectory.poses();
    return sensor::beams(sensor_, leg.trajectory, poses.front().time_s, poses.back().time_s);
  }
  sensor::Sensor sensor_;
};

}  // namespace underbrush::worlds
