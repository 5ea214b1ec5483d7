#include "underbrush/pipeline/perceive_log.hpp"

#include <chrono>

#include "underbrush/core/check.hpp"
#include "underbrush/core/range_unit.hpp"
#include "underbrush/perception/grid_file.hpp"

namespace underbrush::pipeline {
namespace {

/// The occupancy grid of a log, and its file.
class GridOfLog {
 public:
  GridOfLog(const perception::PerceiveOptions& options, const GridFile& file)
      : path_(file.path), area_(options.area), grid_(options.grid) {
    area_.check();
    if (path_.extension() != ".png") writer_.emplace(path_, file.provenance, area_);
  }

  void step(const perception::MergedCloud& cloud) {
    const auto start = std::chrono::steady_clock::now();
    grid_.step(cloud);
    summary_.seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ++summary_.cycles;
    if (writer_) writer_->write(grid_, cloud.world_from_vehicle, cloud.time_s);
  }

  /// Writes what is left to write.
  GridSummary close() {
    if (writer_) {
      writer_->close();
    } else {
      io::write_png(path_, perception::picture_of_grid(grid_, area_.free_probability));
    }
    for (const auto label : perception::cell_labels(grid_, area_.free_probability)) {
      summary_.area_m2[size_t(label)] += grid_.cell_m() * grid_.cell_m();
    }
    return summary_;
  }

 private:
  std::filesystem::path path_;
  perception::FreeAreaOptions area_;
  perception::OccupancyGrid grid_;
  std::optional<perception::GridWriter> writer_;
  GridSummary summary_;
};

}  // namespace

Perceived perceive_log(BeamSource& log, const perception::LogTruth* truth,
                       const perception::PerceiveOptions& options, const GridFile* grid) {
  const perception::PerceptionSetup setup = perception::setup_of(options);
  require(
      !grid || setup.rig || setup.cycles.sensor_height_m > 0,
      "perceive: --grid needs the sensor's height above the ground (--sensor-height, or --rig)");
  require_metres(log, "perceive");
  std::optional<GridOfLog> cells;
  if (grid) cells.emplace(options, *grid);
  Perceived out;
  out.log = perception::perceived(log, truth, setup, [&](const perception::MergedCloud& cloud) {
    if (cells) cells->step(cloud);
  });
  if (cells) out.grid = cells->close();
  return out;
}

}  // namespace underbrush::pipeline
