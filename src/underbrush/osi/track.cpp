#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/strategies.hpp"
#include "underbrush/perception/false_positives.hpp"
#include "underbrush/perception/object_pipeline.hpp"
#include "underbrush/perception/output_delay.hpp"
#include "underbrush/perception/tracking_model.hpp"

namespace underbrush::osi {
namespace {

using perception::ExistenceRule;
using perception::HeadingSource;
using perception::ReferencePoint;

struct TrackingStepOptions {
  bool is_model = true;
  perception::TrackingOptions model;
  perception::PipelineOptions real;
  perception::FalsePositiveOptions ghosts;
  uint64_t seed = 1;
  double axle_height_m = 0.3, min_range_m = 0;
};

/// Turns logical detections into objects: by the tracking model, which assigns points by the
/// ground truth, or by a real pipeline.
class TrackingStep : public Strategy {
 public:
  explicit TrackingStep(const TrackingStepOptions& options)
      : options_(options),
        model_(options.model),
        real_(options.real),
        ghosts_(options.ghosts, options.seed) {}

  void step(SensorData& data) override {
    cloud_of(data, options_.axle_height_m, false, 0, cloud_);
    if (options_.min_range_m > 0) remove_near();
    if (options_.is_model) {
      find_truth(data);
      model_.step(cloud_, truth_, list_);
    } else {
      real_.step(cloud_, list_);
    }
    ghosts_.step(list_);
    delay_.push(list_);
    write(data);
  }
  void reset() override { *this = TrackingStep(options_); }
  std::unique_ptr<Strategy> clone() const override { return std::make_unique<TrackingStep>(*this); }

 private:
  void find_truth(const SensorData& data);
  void remove_near();
  void write(SensorData& data);

  TrackingStepOptions options_;
  perception::TrackingModel model_;
  perception::ObjectPipeline real_;
  perception::FalsePositives ghosts_;
  perception::OutputDelay delay_;
  perception::MergedCloud cloud_;
  perception::TruthFrame truth_;
  perception::ObjectList list_;
  uint64_t cycle_ = 0;
};

void TrackingStep::find_truth(const SensorData& data) {
  for (const auto& view : data.views) {
    if (!view->truth) continue;
    truth_of(*view->truth, view->host_vehicle_id, "SensorView", truth_);
    return;
  }
  throw DataError("tracking: the model needs the ground truth, which the data do not carry");
}

void TrackingStep::remove_near() {
  const auto far = [&](size_t i) {
    const size_t s = std::min<size_t>(cloud_.sensor[i], cloud_.sensor_m.size() - 1);
    return double((cloud_.point_m[i] - cloud_.sensor_m[s]).norm()) >= options_.min_range_m;
  };
  size_t kept = 0;
  for (size_t i = 0; i < cloud_.size(); ++i) {
    if (!far(i)) continue;
    cloud_.point_m[kept] = cloud_.point_m[i];
    cloud_.intensity[kept] = cloud_.intensity[i];
    cloud_.sensor[kept++] = cloud_.sensor[i];
  }
  cloud_.point_m.resize(kept);
  cloud_.stamp_s.resize(kept);
  cloud_.intensity.resize(kept);
  cloud_.ring.resize(kept);
  cloud_.sensor.resize(kept);
}

void TrackingStep::write(SensorData& data) {
  const double now = data.timestamp ? data.timestamp->s() : measured_s(data);
  const perception::ObjectList* list = delay_.at(now);
  data.object_header = ObjectHeader{std::nullopt, cycle_++, DataQualifier::kAvailable};
  data.objects.clear();
  if (list) {
    set_objects(*list, data.logical->sensor_ids, data);
  } else {
    data.object_header->qualifier = DataQualifier::kNotAvailable;  // Nothing is ready yet.
  }
}

void read_existence(Parameters& p, perception::ExistenceOptions& e) {
  const size_t rule = p.choice("existence", {"probability", "in-a-row", "out-of"});
  e.rule =
      std::array{ExistenceRule::kProbability, ExistenceRule::kInARow, ExistenceRule::kOutOf}[rule];
  e.step.gain = p.number("gain", e.step.gain, 1e-6, 1);
  e.step.loss = p.number("loss", e.step.loss, 1e-6, 1);
  e.threshold = p.number("threshold", e.threshold, 1e-6, 1);
  e.step.start_points = uint32_t(p.count("start_points", e.step.start_points, 1000000));
  e.keep_points = uint32_t(p.count("keep_points", e.keep_points, 1000000));
  e.full_extent_m = p.number("full_extent_m", e.full_extent_m, 0, 100);
  e.needed = int(p.count("needed", uint64_t(e.needed), 32));
  e.window = int(p.count("window", uint64_t(e.window), 32));
  e.lost = int(p.count("lost", uint64_t(e.lost), 100000));
}

void read_model(Parameters& p, perception::TrackingOptions& m) {
  read_existence(p, m.track.existence);
  const size_t reference = p.choice("reference", {"corner", "centre", "gravity"});
  m.track.reference = std::array{ReferencePoint::kCorner, ReferencePoint::kGeometricCentre,
                                 ReferencePoint::kCentreOfGravity}[reference];
  m.track.completion.enabled = !p.flag("as_measured", false);
  m.heading = p.choice("heading", {"points", "truth"}) == 0 ? HeadingSource::kPoints
                                                            : HeadingSource::kTruth;
  m.resolution.enabled = p.flag("merge_close", false);
  m.resolution.least_gap_m = p.number("merge_gap_m", m.resolution.least_gap_m, 0, 100);
  m.latency_s = p.number("latency_ms", 0, 0, 1e5) / 1000;
}

}  // namespace

std::unique_ptr<Strategy> make_tracking(Parameters& p) {
  TrackingStepOptions o;
  o.is_model = p.choice("pipeline", {"model", "real"}) == 0;
  read_model(p, o.model);
  o.real.track = o.model.track;
  o.real.latency_s = o.model.latency_s;
  o.real.clusters.ground =
      p.choice("ground", {"cone", "lower_envelope"}) == 0 ? "cone" : "lower_envelope";
  o.ghosts.rate_per_s = p.number("ghosts_per_s", 0, 0, 1000);
  o.ghosts.mean_life_s = p.number("ghost_life_s", o.ghosts.mean_life_s, 1e-3, 1000);
  o.axle_height_m = p.number("axle_height_m", o.axle_height_m, -5, 5);
  o.min_range_m = p.number("min_range_m", 0, 0, 1000);
  o.seed = p.count("seed", 1, uint64_t(1) << 53);
  try {
    return std::make_unique<TrackingStep>(o);
  } catch (const std::invalid_argument& e) {
    p.fail("", e.what());
  }
}

}  // namespace underbrush::osi
