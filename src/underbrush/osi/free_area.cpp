#include "underbrush/perception/free_area.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/osi/strategies.hpp"
#include "underbrush/perception/perceive_options.hpp"

namespace underbrush::osi {
namespace {

/// Maps the free space around the vehicle. OSI has no occupancy grid; the outline of the free area
/// goes to the polygon of `virtual_detection_area`.
class GridStep : public Strategy {
 public:
  GridStep(const perception::GridOptions& options, const perception::FreeAreaOptions& area,
           double axle_height_m)
      : half_side_m_(options.half_side_m),
        area_(area),
        axle_height_m_(axle_height_m),
        grid_(options) {}

  void step(SensorData& data) override {
    cloud_of(data, axle_height_m_, true, half_side_m_, cloud_);
    grid_.step(cloud_);
    data.free_area.resize(1);
    std::vector<Vec3>& outline = data.free_area.front();
    perception::find_free_area(grid_, cloud_.world_from_vehicle, area_, outline);
    const Pose virtual_from_world = world_from_virtual(data).inverse();
    for (Vec3& corner : outline) corner = virtual_from_world * corner;
  }
  void reset() override { grid_.reset(); }
  std::unique_ptr<Strategy> clone() const override { return std::make_unique<GridStep>(*this); }

 private:
  double half_side_m_;
  perception::FreeAreaOptions area_;
  double axle_height_m_;
  perception::OccupancyGrid grid_;
  perception::MergedCloud cloud_;
};

}  // namespace

std::unique_ptr<Strategy> make_grid(Parameters& p) {
  perception::PerceiveOptions options;
  for (const auto& row : perception::perceive_options()) {
    if (row.group == "Grid" && row.name != "label-probability") p.set(row, options);
  }
  const double axle = p.number("axle_height_m", 0.3, -5, 5);
  perception::FreeAreaOptions area;
  area.bearings = uint32_t(p.count("bearings", area.bearings, 3600));
  area.free_probability = p.number("free_probability", area.free_probability, 0, 1);
  if (area.bearings < 3) p.fail("bearings", "must be at least 3");
  try {
    return std::make_unique<GridStep>(options.grid, area, axle);
  } catch (const std::invalid_argument& e) {
    p.fail("", e.what());
  }
}

}  // namespace underbrush::osi
