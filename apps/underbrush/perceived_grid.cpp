#include "perceived_grid.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>

namespace underbrush::app {
namespace {

// Areas of the cells of each label, m².
std::array<double, 4> areas(const perception::OccupancyGrid& grid, double probability) {
  std::array<double, 4> area{};
  for (const auto label : perception::cell_labels(grid, probability)) {
    area[size_t(label)] += grid.cell_m() * grid.cell_m();
  }
  return area;
}

}  // namespace

void add_grid_options(Verb& verb, GridSetup& setup) {
  CLI::App& app = verb.app;
  verb.begin_rare_group("Grid");
  app.add_option("--cell", setup.grid.cell_m, "Side of a cell, m")->capture_default_str();
  app.add_option("--half-side", setup.grid.half_side_m,
                 "Distance that the grid reaches from the vehicle along x and y, m")
      ->capture_default_str();
  app.add_option("--low", setup.grid.low_m, "Matter counts from this height above the ground on, m")
      ->capture_default_str();
  app.add_option("--high", setup.grid.high_m, "Matter counts up to this height, m")
      ->capture_default_str();
  app.add_option("--memory", setup.grid.memory,
                 "Share of the evidence that stays from cycle to cycle")
      ->capture_default_str();
  app.add_option("--label-probability", setup.area.free_probability,
                 "A cell that no state fills with this probability is unknown")
      ->capture_default_str();
}

PerceivedGrid::PerceivedGrid(const GridSetup& setup, const std::string& provenance)
    : setup_(setup), grid_(setup.grid) {
  setup.area.check();
  if (std::filesystem::path(setup.output).extension() != ".png") {
    writer_.emplace(setup.output, provenance, setup.area);
  }
}

void PerceivedGrid::step(const perception::MergedCloud& cloud) {
  const auto start = std::chrono::steady_clock::now();
  grid_.step(cloud);
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ++cycles_;
  if (writer_) writer_->write(grid_, cloud.world_from_vehicle, cloud.time_s);
}

void PerceivedGrid::close() {
  if (writer_) return writer_->close();
  io::write_png(setup_.output, perception::picture_of_grid(grid_, setup_.area.free_probability));
}

Json PerceivedGrid::summary() const {
  const auto [unknown, free, permeable, solid] = areas(grid_, setup_.area.free_probability);
  return {{"cycles", cycles_}, {"free_m2", free},       {"permeable_m2", permeable},
          {"solid_m2", solid}, {"unknown_m2", unknown}, {"seconds", seconds_}};
}

std::string PerceivedGrid::text() const {
  const auto [unknown, free, permeable, solid] = areas(grid_, setup_.area.free_probability);
  return fmt::format(
      "{}: at the end {:.0f} m² free, {:.0f} permeable, {:.0f} solid; {:.1f} ms a cycle",
      setup_.output, free, permeable, solid,
      1000 * seconds_ / double(std::max<size_t>(1, cycles_)));
}

}  // namespace underbrush::app
