// A strategy in a shared library: it reports one object, at the mean of all detections. A real one
// would track; what it shows is the way in and out.
#include <cstdio>
#include <exception>
#include <string>

#include "underbrush/osi/read.hpp"
#include "underbrush/osi/strategy_library.h"
#include "underbrush/osi/write.hpp"

namespace {

using namespace underbrush;

struct MeanTracker {
  uint64_t cycles = 0;
  std::string out;

  void step(osi::SensorData& data) {
    ++cycles;
    data.objects.clear();
    data.object_header = {data.last_measurement_time, cycles, osi::DataQualifier::kAvailable};
    if (!data.logical || data.logical->detections.empty()) return;
    Vec3 sum = Vec3::Zero();
    for (const auto& d : data.logical->detections) sum += d.position_m;
    osi::DetectedObject object;
    object.tracking_id = 1;
    object.existence = 1;
    object.base.position_m = sum / double(data.logical->detections.size());
    data.objects.push_back(object);
  }
};

}  // namespace

int underbrush_strategy_version(void) { return UNDERBRUSH_STRATEGY_VERSION; }

void* underbrush_strategy_new(const char* parameters, char* error, size_t size) {
  if (std::string(parameters).find("fail") == std::string::npos) return new MeanTracker;
  std::snprintf(error, size, "it was asked to fail");
  return nullptr;
}

void underbrush_strategy_free(void* strategy) { delete static_cast<MeanTracker*>(strategy); }

int underbrush_strategy_step(void* strategy, const void* data, size_t bytes, const void** out,
                             size_t* out_bytes, char* error, size_t size) {
  try {
    auto* tracker = static_cast<MeanTracker*>(strategy);
    osi::SensorData d =
        osi::read_sensor_data({static_cast<const char*>(data), bytes}, "mean_tracker");
    tracker->step(d);
    tracker->out.clear();
    osi::write(d, tracker->out);
    *out = tracker->out.data();
    *out_bytes = tracker->out.size();
    return 0;
  } catch (const std::exception& e) {
    std::snprintf(error, size, "%s", e.what());
    return 1;
  }
}

void underbrush_strategy_reset(void* strategy) {
  *static_cast<MeanTracker*>(strategy) = MeanTracker();
}

void* underbrush_strategy_clone(const void* strategy) {
  return new MeanTracker(*static_cast<const MeanTracker*>(strategy));
}
