#include "underbrush/worlds/helios_survey.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "underbrush/core/check.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/worlds/helios_path.hpp"
#include "underbrush/worlds/helios_risley.hpp"
#include "underbrush/worlds/xml_file.hpp"

namespace underbrush::worlds {
namespace fs = std::filesystem;
namespace {

/// From the frame of HELIOS++ (x right, y forward) to ours (x forward, y left).
Vec3 ours(const Vec3& helios) { return {helios.y(), -helios.x(), helios.z()}; }

/// An element of another file that a survey names.
struct Named {
  std::unique_ptr<XmlFile> file;
  pugi::xml_node node;
};

/// Reads the legs of a survey.
class SurveyReader {
 public:
  SurveyReader(const fs::path& path, const HeightAt& ground_at, const fs::path& assets)
      : xml_(path),
        folders_{fs::absolute(path).parent_path(), assets.empty() ? assets : fs::absolute(assets)},
        ground_at_(ground_at),
        survey_(xml_.root().child("survey")) {
    if (!survey_) throw FormatError(path.string(), "", "no survey of HELIOS++");
    out_.file = path;
    out_.name = printable(survey_.attribute("name").value(), 100);
    xml_.count_others(survey_, {"leg", "FWFSettings", "scannerMount", "detectorSettings"},
                      out_.left_out);
    scanner_ = named("scanner", xml_.text(survey_, "scanner"));
    const std::string platform = xml_.text(survey_, "platform");
    interpolated_ = platform == "interpolated";
    const std::string base = survey_.attribute("basePlatform").value();
    if (!interpolated_ || !base.empty())
      platform_ = named("platform", interpolated_ ? base : platform);
    read_mount();
    scanner_.file->count_others(
        scanner_.node, {"FWFSettings", "beamOrigin", "headRotateAxis", "channels"}, out_.left_out);
    optics_ = scanner_.file->text(scanner_.node, "optics");
    read_emitters();
  }

  Survey read() {
    std::vector<pugi::xml_node> legs;
    for (const pugi::xml_node& leg : survey_.children("leg")) legs.push_back(leg);
    if (legs.empty()) xml_.fail(survey_, "no leg");
    double start_s = 0;
    for (size_t k = 0; k < legs.size(); ++k) {
      LegSettings settings = settings_of(legs[k]);
      limit_head(settings);
      xml_.count_others(legs[k], {"platformSettings", "scannerSettings"}, out_.left_out);
      const LegPath path = checked_path(legs, k, settings, start_s);
      if (path.poses.size() >= 2) start_s = path.poses.back().time_s;
      if (!settings.active || path.poses.size() < 2) {
        ++out_.left_out[settings.active ? "legs without a duration"
                                        : "legs with an inactive scanner"];
        continue;
      }
      check(settings, legs[k]);
      add_leg(k, settings, path);
    }
    if (out_.legs.empty()) {
      std::string why = "no leg on which the scanner measures";
      for (const auto& [what, n] : out_.left_out) why += "; " + std::to_string(n) + " " + what;
      xml_.fail(survey_, why);
    }
    return std::move(out_);
  }

 private:
  Named named(const char* element, const std::string& location) const {
    const size_t hash = location.find('#');
    if (hash == std::string::npos) xml_.fail(survey_, std::string(element) + ": must be FILE#ID");
    Named out{std::make_unique<XmlFile>(folders_.path(xml_.path(), location)), {}};
    out.node = out.file->with_id(element, location.substr(hash + 1));
    return out;
  }

  void read_mount() {
    const pugi::xml_node own = survey_.child("scannerMount");
    const XmlFile& file = own ? xml_ : platform_.file ? *platform_.file : xml_;
    const pugi::xml_node mount = own ? own : platform_.node.child("scannerMount");
    if (platform_.file)
      platform_.file->count_others(platform_.node, {"scannerMount"}, out_.left_out);
    mount_.position = file.vector(mount);
    mount_.rotation = file.rotation(mount);
    const pugi::xml_node origin = scanner_.node.child("beamOrigin");
    mount_.position += scanner_.file->vector(origin);
    emitter_ = scanner_.file->rotation(origin);
    const pugi::xml_node axis = scanner_.node.child("headRotateAxis");
    mount_.head_axis = axis ? scanner_.file->vector(axis) : Vec3::UnitZ();
    if (!(mount_.head_axis.norm() > 0.1)) mount_.head_axis = Vec3::UnitZ();
    mount_.head_axis.normalize();
  }

  /// Returns the settings of a leg over those of its template.
  LegSettings settings_of(const pugi::xml_node& leg) const {
    LegSettings s;
    for (const char* element : {"platformSettings", "scannerSettings"}) {
      const pugi::xml_node own = leg.child(element);
      const std::string name = own.attribute("template").value();
      if (!name.empty()) read_settings(xml_.with_id(element, name), s);
      if (own) read_settings(own, s);
    }
    return s;
  }

  void read_settings(const pugi::xml_node& n, LegSettings& s) const {
    if (std::string(n.name()) == "platformSettings") {
      s.position = {xml_.number(n, "x", s.position.x()), xml_.number(n, "y", s.position.y()),
                    xml_.number(n, "z", s.position.z())};
      s.on_ground = xml_.truth(n, "onGround", s.on_ground);
      s.speed_m_per_s = xml_.number(n, "movePerSec_m", s.speed_m_per_s);
      return;
    }
    const auto angle = [&](const char* name, double& value) {
      value = xml_.number(n, name, value / kDegree) * kDegree;
    };
    s.active = xml_.truth(n, "active", s.active);
    s.pulse_hz = xml_.number(n, "pulseFreq_hz", s.pulse_hz);
    s.scan_hz = xml_.number(n, "scanFreq_hz", s.scan_hz);
    angle("scanAngle_deg", s.scan_rad);
    angle("verticalAngleMin_deg", s.low_rad);
    angle("verticalAngleMax_deg", s.high_rad);
    angle("headRotatePerSec_deg", s.head_rad_per_s);
    angle("headRotateStart_deg", s.head_start_rad);
    angle("headRotateStop_deg", s.head_stop_rad);
    angle("verticalResolution_deg", s.vertical_step_rad);
    angle("horizontalResolution_deg", s.horizontal_step_rad);
    s.longest_s = xml_.number(n, "maxDuration_s", s.longest_s);
    s.warmup_s = xml_.number(n, "opticsWarmupPhase_s", s.warmup_s);
    const double device = xml_max("scanAngleMax_deg") * kDegree;
    if (s.vertical_step_rad > 0 && device > 0) {
      s.scan_hz = s.pulse_hz * s.vertical_step_rad / (2 * device);
      s.head_rad_per_s = s.horizontal_step_rad * s.scan_hz;
    }
  }

  /// Limits the speed of the head to that of the scanner, if it states one. Without one, HELIOS++
  /// does not turn the head at all.
  void limit_head(LegSettings& s) {
    const double most = xml_max("headRotatePerSecMax_deg") * kDegree;
    if (!(most > 0) || std::abs(s.head_rad_per_s) <= most * (1 + 1e-9)) return;
    s.head_rad_per_s = std::copysign(most, s.head_rad_per_s);
    if (s.active) ++out_.left_out["speeds of the head above headRotatePerSecMax_deg"];
  }

  LegPath checked_path(const std::vector<pugi::xml_node>& legs, size_t k,
                       const LegSettings& settings, double start_s) try {
    return path_of(legs, k, settings, start_s);
  } catch (const std::invalid_argument& e) {
    xml_.fail(legs[k], e.what());
  }

  void check(const LegSettings& s, const pugi::xml_node& leg) const {
    if (!(s.pulse_hz >= 1 && s.pulse_hz <= 1e8)) xml_.fail(leg, "pulseFreq_hz: must be 1 to 1e8");
    if (!(s.scan_hz >= 0)) xml_.fail(leg, "scanFreq_hz: must not be negative");
  }

  double xml_max(const char* name) const { return scanner_.file->number(scanner_.node, name, 0); }

  LegPath path_of(const std::vector<pugi::xml_node>& legs, size_t k, const LegSettings& settings,
                  double start_s) {
    const pugi::xml_node platform = legs[k].child("platformSettings");
    const double pulse_hz = std::max(1.0, settings.pulse_hz);
    const double warm_s = settings.warmup_pulses() / pulse_hz;
    const HeadTurn head{settings.head_start_rad + settings.head_rad_per_s * warm_s,
                        settings.head_stop_rad, settings.head_rad_per_s, pulse_hz};
    if (platform.attribute("trajectory")) {
      const TrajectoryFile file{
          folders_.path(xml_.path(), xml_.text(platform, "trajectory")),
          trajectory_columns(platform), gives_columns(platform),
          xml_.truth(platform, "toRadians", true),
          std::string(survey_.attribute("rotationSpec").value()) == "CANONICAL"};
      return along_file(file, xml_.number(platform, "tStart", -kEver),
                        xml_.number(platform, "tEnd", kEver), settings.longest_s, mount_, head);
    }
    const std::string type = platform_.node ? platform_.node.attribute("type").value() : "static";
    const Vec3 here = place_of(settings);
    if (type == "static") return standing(here, mount_, head, start_s, settings.longest_s);
    if (type != "linearpath") ++out_.left_out["dynamics of the platform " + printable(type, 40)];
    if (k + 1 == legs.size()) return {};
    return flying(here, place_of(settings_of(legs[k + 1])), settings.speed_m_per_s, mount_, head,
                  start_s, settings.longest_s);
  }

  static bool gives_columns(const pugi::xml_node& n) {
    for (const char* name : kIndices) {
      if (n.attribute(name)) return true;
    }
    return false;
  }

  static constexpr const char* kIndices[] = {"tIndex", "rollIndex", "pitchIndex", "yawIndex",
                                             "xIndex", "yIndex",    "zIndex"};

  std::array<size_t, 7> trajectory_columns(const pugi::xml_node& n) const {
    std::array<size_t, 7> columns{};
    for (size_t c = 0; c < 7; ++c) {
      const double index = xml_.number(n, kIndices[c], double(c));
      if (!(index >= 0 && index < 64) || index != std::floor(index)) {
        xml_.fail(n, std::string(kIndices[c]) + ": must be a whole number from 0 to 63");
      }
      columns[c] = size_t(index);
    }
    return columns;
  }

  Vec3 place_of(const LegSettings& s) {
    if (!s.on_ground) return s.position;
    const auto height = ground_at_ ? ground_at_(s.position.x(), s.position.y()) : std::nullopt;
    if (!height) ++out_.left_out["legs on the ground where there is none"];
    return {s.position.x(), s.position.y(), height.value_or(s.position.z())};
  }

  void add_leg(size_t number, const LegSettings& s, const LegPath& path) {
    SurveyLeg leg;
    leg.number = number;
    try {
      leg.trajectory = Trajectory(path.poses);
      optics_ == "risley" ? write_prisms(s, leg) : write_table(s, leg);
    } catch (const std::invalid_argument& e) {
      xml_.fail(survey_, "leg " + std::to_string(number) + ": " + e.what());
    }
    out_.legs.push_back(std::move(leg));
  }

  Deflector deflector_of(const LegSettings& s) const {
    const XmlFile& file = *scanner_.file;
    Deflector d;
    d.optics = optics_;
    const bool known = d.optics == "oscillating" || d.optics == "conic" || d.optics == "line" ||
                       d.optics == "rotating";
    if (!known) file.fail(scanner_.node, "optics: " + in_quotes(d.optics) + " are not supported");
    d.pulse_hz = s.pulse_hz;
    d.scan_hz = s.scan_hz;
    d.scan_max_rad = xml_max("scanAngleMax_deg") * kDegree;
    d.scan_rad = s.scan_rad > 0 ? std::min(s.scan_rad, d.scan_max_rad) : d.scan_max_rad;
    const double effective = xml_max("scanAngleEffectiveMax_deg") * kDegree;
    const double widest = std::min(effective > 0 ? effective : d.scan_max_rad, d.scan_rad);
    d.low_rad = std::isnan(s.low_rad) ? -widest : s.low_rad;
    d.high_rad = std::isnan(s.high_rad) ? widest : s.high_rad;
    const double fibres = file.number(scanner_.node, "numFibers", 1);
    if (!(fibres >= 1 && fibres <= 65534))
      file.fail(scanner_.node, "numFibers: must be 1 to 65534");
    d.fibres = size_t(fibres);
    return d;
  }

  /// Reads the emitters, of which each fires at every pulse.
  void read_emitters() {
    const pugi::xml_node channels = scanner_.node.child("channels");
    for (const pugi::xml_node& channel : channels.children("channel")) {
      const pugi::xml_attribute own = channel.attribute("optics");
      if (own && optics_ != own.value()) {
        ++out_.left_out["channels with other optics than their scanner"];
        continue;
      }
      const pugi::xml_node origin = channel.child("beamOrigin");
      emitters_.push_back({origin ? scanner_.file->rotation(origin) : emitter_, channel});
    }
    if (emitters_.empty() && channels.child("channel")) {
      scanner_.file->fail(channels, "no channel with the scanner's optics");
    }
    if (emitters_.empty()) emitters_.push_back({emitter_, {}});
  }

  /// Writes the sensor of a leg whose beams pass prisms. These turn as long as the scanner is
  /// active, from leg to leg.
  void write_prisms(const LegSettings& s, SurveyLeg& leg) {
    const auto& poses = leg.trajectory.poses();
    turned_s_ += s.warmup_pulses() / s.pulse_hz;
    leg.sensor = sensor_text(
        leg, risley_pattern(*scanner_.file, scanner_.node, emitters_, s.pulse_hz, turned_s_));
    const double duration_s = poses.back().time_s - poses.front().time_s;
    turned_s_ += std::ceil(duration_s * s.pulse_hz - 1e-6) / s.pulse_hz;
  }

  void write_table(const LegSettings& settings, SurveyLeg& leg) {
    leg.table_name = "leg-" + std::to_string(leg.number) + ".csv";
    const Deflector d = deflector_of(settings);
    std::vector<Vec3> line = line_of(d);
    const auto warm = std::fmod(settings.warmup_pulses(), double(line.size()));
    std::rotate(line.begin(), line.begin() + std::ptrdiff_t(warm), line.end());
    require_data(line.size() * emitters_.size() <= 4000000, "more than 4000000 directions");
    std::ostringstream table;
    table.precision(12);
    table << "azimuth_deg,elevation_deg,time_us,ring\n";
    size_t shots = 0;
    for (size_t k = 0; k < line.size(); ++k) {
      if (line[k].isZero()) continue;
      for (size_t c = 0; c < emitters_.size(); ++c) {
        const Vec3 v = ours(emitters_[c].attitude * line[k]).normalized();
        const double flat = std::hypot(v.x(), v.y());
        const double azimuth = flat < 1e-12 ? 0 : std::atan2(v.y(), v.x());
        const size_t ring = d.optics == "line" ? k : c;
        table << azimuth / kDegree << ',' << std::atan2(v.z(), flat) / kDegree << ','
              << double(k) / d.pulse_hz * 1e6 << ',' << ring << '\n';
        ++shots;
      }
    }
    require_data(shots > 0, "no pulse leaves the scanner");
    leg.directions = table.str();
    const double cycle_s = double(line.size()) / d.pulse_hz;
    std::ostringstream y;
    y.precision(12);
    y << "kind: directions\nrate_hz: " << 1 / cycle_s << "\ncycle_s: " << cycle_s
      << "\ndirections: " << leg.table_name << "\n";
    leg.sensor = sensor_text(leg, y.str());
  }

  std::string sensor_text(const SurveyLeg& leg, const std::string& pattern) const {
    const XmlFile& f = *scanner_.file;
    const pugi::xml_node& n = scanner_.node;
    // HELIOS++ states the divergence where the power is 1/e² of that on the axis.
    const double half_power = std::sqrt(std::log(2) / 2);
    const double farthest = std::min(1e5, f.number(n, "rangeMax_m", 1e5));
    const double nearest = f.number(n, "rangeMin_m", 0);
    const double quality = f.number(n.child("FWFSettings"), "beamSampleQuality", 3);
    const double returns = f.number(n, "maxNOR", 0);
    const pugi::xml_node over = survey_.child("detectorSettings");
    std::ostringstream y;
    y.precision(12);
    y << "name: helios-leg-" << leg.number << "\n# " << emitters_.size()
      << " emitters; the turn of the head is in the trajectory\n"
      << pattern << "min_range_m: " << xml_.number(over, "rangeMin_m", nearest)
      << "\nmax_range_m: " << xml_.number(over, "rangeMax_m", farthest)
      << "\nrange_sigma_m: " << xml_.number(over, "accuracy_m", f.number(n, "accuracy_m", 0));
    const double divergence = f.number(n, "beamDivergence_rad", 0.0003) * half_power * 1e3;
    const int across = int(
        std::clamp(2 * xml_.number(survey_.child("FWFSettings"), "beamSampleQuality", quality) - 1,
                   1.0, 31.0));
    y << "\ndivergence_mrad: [" << divergence << ", " << divergence << "]\nprofile: gaussian"
      << "\nsub_rays: [" << across << ", " << across
      << "]\nwavelength_nm: " << f.number(n, "wavelength_nm", 1064)
      << "\nreceiver:\n  pulse_ns: " << f.number(n, "pulseLength_ns", 4)
      << "\n  returns: all\n  max_echoes: " << (returns >= 1 ? std::min(16, int(returns)) : 16)
      << "\nsources:\n  - \"A scanner of HELIOS++\"\n";
    return y.str();
  }

  XmlFile xml_;
  Assets folders_;
  HeightAt ground_at_;
  pugi::xml_node survey_;
  Named scanner_, platform_;
  bool interpolated_ = false;
  ScannerMount mount_;
  Eigen::Quaterniond emitter_ = Eigen::Quaterniond::Identity();
  std::string optics_;
  std::vector<Emitter> emitters_;
  double turned_s_ = 0;  ///< For how long the prisms have turned.
  Survey out_;
};

}  // namespace

Survey read_helios_survey(const fs::path& path, const HeightAt& ground_at, const fs::path& assets) {
  return SurveyReader(path, ground_at, assets).read();
}

}  // namespace underbrush::worlds
