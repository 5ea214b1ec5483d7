#include "underbrush/pipeline/beam_checks.hpp"

#include <algorithm>
#include <utility>

#include "underbrush/core/pose.hpp"
#include "underbrush/pipeline/import_checks.hpp"
#include "underbrush/pipeline/pose_checks.hpp"

namespace underbrush::pipeline {
namespace {

constexpr size_t kScans = 32, kReturns = 20000;

/// Scans in memory.
class KeptScans : public ScanSource {
 public:
  explicit KeptScans(const std::map<uint32_t, PointScan>& scans) {
    for (const auto& [number, scan] : scans) scans_.push_back(&scan);
  }
  size_t size() const override { return scans_.size(); }
  PointScan read(size_t k) override { return *scans_.at(k); }
  const Trajectory& trajectory() const override { return none_; }
  const std::map<std::string, size_t>& skipped() const override { return skipped_; }

 private:
  std::vector<const PointScan*> scans_;
  Trajectory none_;
  std::map<std::string, size_t> skipped_;
};

}  // namespace

void BeamChecks::add(const BeamLog& beams) {
  if (scans_.size() > kScans || beams.empty()) return;
  const bool begins = scans_.empty();
  std::map<uint32_t, size_t> returns, seen;
  for (size_t i = 0; i < beams.size(); ++i) {
    if (beams.is_hit(i)) ++returns[beams.scan[i]];
    has_misses_ = has_misses_ || !beams.is_hit(i);
  }
  for (const auto& [number, count] : returns) {
    if (scans_.size() > kScans || scans_.contains(number)) continue;
    const auto at = std::ranges::find(beams.info.scans, number, &ScanInfo::scan);
    if (at != beams.info.scans.end()) scans_[number].info = *at;
  }
  for (size_t i = 0; i < beams.size(); ++i) {
    const uint32_t scan = beams.scan[i];
    if (!beams.is_hit(i) || seen[scan]++ % (returns[scan] / kReturns + 1) != 0) continue;
    if (begins && scan == returns.begin()->first) {
      first_.point.emplace_back(beams.range_m[i] * beams.direction[i]);
    }
    const auto kept = scans_.find(scan);
    if (kept == scans_.end()) continue;
    const Pose sensor_from_world = kept->second.info.world_from_sensor.inverse();
    kept->second.point.emplace_back((sensor_from_world * beams.end_point(i)).cast<float>());
  }
  max_range_m_ = beams.info.max_range_m;
}

std::vector<std::string> BeamChecks::warnings() const {
  std::vector<ScanInfo> infos;
  for (const auto& [number, scan] : scans_) infos.push_back(scan.info);
  std::vector<std::string> out = warnings_of_poses(infos);
  if (out.empty() && (infos.size() > 1 || are_tilted(infos))) {
    KeptScans scans(scans_);
    out.push_back(warning_of_scans(scans, infos));
  }
  out.push_back(warning_of_ranges(first_));
  if (!has_misses_) out.push_back(warning_of_greatest_range(first_, max_range_m_));
  std::erase(out, "");
  return out;
}

}  // namespace underbrush::pipeline
