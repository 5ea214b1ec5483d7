#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/strategies.hpp"
#include "underbrush/perception/occupancy_grid.hpp"

namespace underbrush::osi {
namespace {

/// Maps the free space around the vehicle. OSI has no occupancy grid; the outline of the free area
/// goes to the polygon of `virtual_detection_area`.
class GridStep : public Strategy {
 public:
  GridStep(const perception::GridOptions& options, double axle_height_m, int bearings,
           double threshold)
      : options_(options),
        axle_height_m_(axle_height_m),
        threshold_(threshold),
        bearings_(bearings),
        grid_(options) {}

  void step(SensorData& data) override {
    cloud_of(data, axle_height_m_, true, options_.half_side_m, cloud_);
    grid_.step(cloud_);
    const Pose virtual_from_world = world_from_virtual(data).inverse();
    std::vector<Vec3> outline;
    const Pose& vehicle = cloud_.world_from_vehicle;
    for (int k = 0; k < bearings_; ++k) {
      const double angle = 2 * M_PI * k / bearings_;
      const Vec3 d = vehicle.rotation * Vec3(std::cos(angle), std::sin(angle), 0);
      outline.push_back(virtual_from_world * (vehicle.translation + reach(d) * d));
    }
    data.free_area = {outline};
  }
  void reset() override { grid_.reset(); }
  std::unique_ptr<Strategy> clone() const override { return std::make_unique<GridStep>(*this); }

 private:
  // How far the cells along a direction are free.
  double reach(const Vec3& direction) const {
    const Vec3& from = cloud_.world_from_vehicle.translation;
    const double step = options_.cell_m / 2;
    double free = 0;
    for (double r = step; r < options_.half_side_m; r += step) {
      const Vec3 p = from + r * direction;
      const auto cell = grid_.cell_at(p.x(), p.y());
      if (!cell) break;
      const bool is_own = r < kOwnVehicleM;  // No beam passes below the vehicle.
      if (!is_own && grid_.probability(*cell)[0] < threshold_) break;
      free = r;
    }
    return free;
  }

  static constexpr double kOwnVehicleM = 3;
  perception::GridOptions options_;
  double axle_height_m_, threshold_;
  int bearings_;
  perception::OccupancyGrid grid_;
  perception::MergedCloud cloud_;
};

}  // namespace

std::unique_ptr<Strategy> make_grid(Parameters& p) {
  perception::GridOptions o;
  o.cell_m = p.number("cell_m", o.cell_m, 0.01, 10);
  o.half_side_m = p.number("half_side_m", o.half_side_m, 1, 500);
  o.low_m = p.number("low_m", o.low_m, -10, 100);
  o.high_m = p.number("high_m", o.high_m, -10, 100);
  o.memory = p.number("memory", o.memory, 0, 1);
  const double axle = p.number("axle_height_m", 0.3, -5, 5);
  const auto bearings = int(p.count("bearings", 180, 3600));
  const double threshold = p.number("free_probability", 0.6, 0, 1);
  if (bearings < 3) p.fail("bearings", "must be at least 3");
  try {
    return std::make_unique<GridStep>(o, axle, bearings, threshold);
  } catch (const std::invalid_argument& e) {
    p.fail("", e.what());
  }
}

}  // namespace underbrush::osi
