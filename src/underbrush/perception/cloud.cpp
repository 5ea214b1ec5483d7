#include "underbrush/perception/cloud.hpp"

#include "underbrush/core/check.hpp"

namespace underbrush::perception {

void SensorCloud::clear() {
  point_m.clear();
  time_s.clear();
  intensity.clear();
  ring.clear();
  miss_m.clear();
  miss_time_s.clear();
}

void SensorCloud::check() const {
  const size_t n = point_m.size();
  require(time_s.size() == n && intensity.size() == n && ring.size() == n &&
              miss_time_s.size() == miss_m.size(),
          "the columns of a sensor's cloud differ in length");
}

void MergedCloud::clear() {
  point_m.clear();
  stamp_s.clear();
  intensity.clear();
  ring.clear();
  sensor.clear();
  miss_m.clear();
  miss_sensor.clear();
}

}  // namespace underbrush::perception
