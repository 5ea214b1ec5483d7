#include <fmt/format.h>

#include <cmath>

#include "osi_actions.hpp"
#include "osi_lists.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/lidar_log.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/trace.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush::app {
namespace {

// The scans of a log. One that does not say where they were made has the places of first beams.
std::vector<ScanInfo> scans_of(io::LogReader& log) {
  std::vector<ScanInfo> scans = log.info().scans;
  if (!scans.empty()) return scans;
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!scans.empty() && scans.back().scan == chunk.scan[i]) continue;
      Pose pose;
      pose.translation = chunk.origin[i];
      scans.push_back({chunk.scan[i], chunk.time_s[i], pose});
    }
  }
  log.rewind();
  return scans;
}

// The scans of a log as a trace.
class Recorder {
 public:
  Recorder(const OsiArguments& a, io::LogReader& log, const std::string& origin)
      : scans_(scans_of(log)), writer_(a.output, origin) {
    require_data(!scans_.empty(), "osi: the log has no beams");
    options_.white_intensity = a.white_intensity;
    if (!a.truth.empty()) {
      truth_ = truth_of_log(a.truth, log.info(), {a.truth_elevation_deg * M_PI / 180});
    }
    const double span = scans_.back().time_s - scans_.front().time_s;
    if (scans_.size() > 1) cycle_s_ = span / double(scans_.size() - 1);
  }

  void write(const BeamLog& rows) {
    if (rows.empty()) return;
    size_t k = 0;
    while (k < scans_.size() && scans_[k].scan != rows.scan[0]) ++k;
    require_data(k < scans_.size(), "osi: a beam's scan has no pose");
    const ScanInfo& scan = scans_[k];
    osi::SensorView view = osi::view_of(rows, scan, options_);
    perception::TruthFrame frame;
    if (truth_) truth_->at(scan.scan, scan.time_s, cycle_s_, frame);
    view.truth = osi::ground_truth_of(frame, scan.world_from_sensor, scan.time_s);
    view.host_vehicle_id = osi::kHostId;
    set_motion(k, view.truth->moving[0].base);
    objects_ += frame.objects.size();
    rays_ += view.lidar[0].reflections.size();
    message_.clear();
    osi::write(view, message_);
    writer_.write(message_);
  }
  void close() { writer_.close(); }
  size_t views() const { return writer_.written(); }
  size_t rays() const { return rays_; }
  size_t objects() const { return objects_; }

 private:
  void set_motion(size_t k, osi::BaseMoving& host) const {
    const ScanInfo& a = scans_[k > 0 ? k - 1 : k];
    const ScanInfo& b = scans_[std::min(k + 1, scans_.size() - 1)];
    const double dt = b.time_s - a.time_s;
    if (!(dt > 0)) return;
    const Pose &from = a.world_from_sensor, &to = b.world_from_sensor;
    host.velocity_m_s = (to.translation - from.translation) / dt;
    const double yaw =
        osi::roll_pitch_yaw_of(to.rotation).z() - osi::roll_pitch_yaw_of(from.rotation).z();
    host.turn_rate_rad_s = Vec3(0, 0, perception::wrapped(yaw) / dt);
  }

  std::vector<ScanInfo> scans_;
  osi::TraceWriter writer_;
  osi::LidarLogOptions options_;
  std::optional<perception::LogTruth> truth_;
  double cycle_s_ = 0;
  size_t rays_ = 0, objects_ = 0;
  std::string message_;
};

}  // namespace

void osi_record(const Verb& verb, const OsiArguments& a) {
  io::check_output(a.output);
  io::LogReader log(a.input);
  std::vector<std::filesystem::path> inputs{a.input};
  if (!a.truth.empty()) inputs.emplace_back(a.truth);
  Recorder recorder(a, log, provenance(verb, inputs));
  BeamLog scan;
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t begin = 0; begin < chunk.size();) {
      size_t end = begin;
      while (end < chunk.size() && chunk.scan[end] == chunk.scan[begin]) ++end;
      if (!scan.empty() && scan.scan[0] != chunk.scan[begin]) {
        recorder.write(scan);
        scan = {};
      }
      if (scan.empty()) scan = chunk.like();
      scan.append(chunk, begin, end);
      begin = end;
    }
  }
  recorder.write(scan);
  recorder.close();
  Json j;
  j["views"] = recorder.views();
  j["rays"] = recorder.rays();
  j["true_objects"] = recorder.objects();
  verb.report(j, fmt::format("{} SensorViews: {} rays, {} true objects\n  trace       {}\n",
                             recorder.views(), recorder.rays(), recorder.objects(), a.output));
}

}  // namespace underbrush::app
