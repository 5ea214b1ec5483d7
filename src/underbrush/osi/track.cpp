#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/strategies.hpp"
#include "underbrush/perception/false_positives.hpp"
#include "underbrush/perception/object_pipeline.hpp"
#include "underbrush/perception/output_delay.hpp"
#include "underbrush/perception/perceive_options.hpp"
#include "underbrush/perception/tracking_model.hpp"

namespace underbrush::osi {
namespace {

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

}  // namespace

std::unique_ptr<Strategy> make_tracking(Parameters& p) {
  perception::PerceiveOptions options;
  for (const auto& row : perception::perceive_options()) {
    if (row.group == "Existence" || row.group == "State" || row.name == "pipeline" ||
        row.name == "min-range") {
      p.set(row, options);
    }
  }
  TrackingStepOptions o;
  o.axle_height_m = p.number("axle_height_m", o.axle_height_m, -5, 5);
  o.seed = p.count("seed", 1, uint64_t(1) << 53);
  try {
    const perception::PerceptionSetup setup = perception::setup_of(options);
    o.is_model = setup.is_model;
    o.model = setup.model;
    o.real = setup.real;
    o.ghosts = setup.ghosts;
    o.min_range_m = setup.cycles.min_range_m;
    return std::make_unique<TrackingStep>(o);
  } catch (const std::invalid_argument& e) {
    p.fail("", e.what());
  }
}

}  // namespace underbrush::osi
