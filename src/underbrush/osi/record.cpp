#include "underbrush/osi/record.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush::osi {
namespace {

// The scans of a log. One that does not say where they were made has the places of first beams.
std::vector<ScanInfo> scans_of(BeamSource& log) {
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
  Recorder(BeamSource& log, const perception::LogTruth* truth, const LidarLogOptions& options,
           TraceWriter& writer, std::span<const std::string> models)
      : scans_(scans_of(log)), writer_(writer), options_(options), truth_(truth), models_(models) {
    require_data(!scans_.empty(), "osi: the log has no beams");
    const double span = scans_.back().time_s - scans_.front().time_s;
    if (scans_.size() > 1) cycle_s_ = span / double(scans_.size() - 1);
  }

  void write(const BeamLog& rows) {
    if (rows.empty()) return;
    size_t k = 0;
    while (k < scans_.size() && scans_[k].scan != rows.scan[0]) ++k;
    require_data(k < scans_.size(), "osi: a beam's scan has no pose");
    const ScanInfo& scan = scans_[k];
    SensorView view = view_of(rows, scan, options_);
    perception::TruthFrame frame;
    if (truth_) truth_->at(scan.scan, scan.time_s, cycle_s_, frame);
    view.truth = ground_truth_of(frame, scan.world_from_sensor, scan.time_s);
    for (MovingObject& m : view.truth->moving) {
      if (m.id < models_.size()) m.model_reference = models_[m.id];
    }
    view.host_vehicle_id = kHostId;
    set_motion(k, view.truth->moving[0].base);
    counts_.objects += frame.objects.size();
    counts_.rays += view.lidar[0].reflections.size();
    ++counts_.views;
    message_.clear();
    osi::write(view, message_);
    writer_.write(message_);
  }
  const RecordCounts& counts() const { return counts_; }

 private:
  void set_motion(size_t k, BaseMoving& host) const {
    const ScanInfo& a = scans_[k > 0 ? k - 1 : k];
    const ScanInfo& b = scans_[std::min(k + 1, scans_.size() - 1)];
    const double dt = b.time_s - a.time_s;
    if (!(dt > 0)) return;
    const Pose &from = a.world_from_sensor, &to = b.world_from_sensor;
    host.velocity_m_s = (to.translation - from.translation) / dt;
    const double yaw = roll_pitch_yaw_of(to.rotation).z() - roll_pitch_yaw_of(from.rotation).z();
    host.turn_rate_rad_s = Vec3(0, 0, perception::wrapped(yaw) / dt);
  }

  std::vector<ScanInfo> scans_;
  TraceWriter& writer_;
  const LidarLogOptions& options_;
  const perception::LogTruth* truth_;
  std::span<const std::string> models_;
  double cycle_s_ = 0;
  RecordCounts counts_;
  std::string message_;
};

}  // namespace

RecordCounts record_log(BeamSource& log, const perception::LogTruth* truth,
                        const LidarLogOptions& options, TraceWriter& writer,
                        std::span<const std::string> models) {
  Recorder recorder(log, truth, options, writer, models);
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
  return recorder.counts();
}

}  // namespace underbrush::osi
