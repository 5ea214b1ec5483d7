#include "underbrush/sensor/organised_scan.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/rays.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kMaxSpread = 0.15 * M_PI / 180;
constexpr double kFineSpread = 0.5 * kMaxSpread;
constexpr double kMostReturns = 0.95;  // more than a majority, which may be one of two mixed rows
constexpr size_t kMinReturns = 3;

constexpr double kMaxBend = 3 * M_PI / 180;  // by motion, before it is known
constexpr double kMostBent = 0.8;
constexpr int kMostSteps = 12;  // of least squares
constexpr size_t kMostSamples = 20000;

/// The angles of all points, NaN for points that are no return.
struct PointAngles {
  std::vector<double> azimuth, elevation;
};

/// The columns and angles of the returns of one row.
struct Row {
  std::vector<double> column, azimuth, elevation;
};

std::vector<Row> rows_of(const OrganisedScan& grid, const PointAngles& angles) {
  std::vector<Row> rows(grid.rows);
  for (size_t c = 0; c < grid.columns; ++c) {
    for (size_t r = 0; r < grid.rows; ++r) {
      const size_t i = grid.column_major ? c * grid.rows + r : r * grid.columns + c;
      if (std::isnan(angles.azimuth[i])) continue;
      rows[r].column.push_back(double(c));
      rows[r].azimuth.push_back(angles.azimuth[i]);
      rows[r].elevation.push_back(angles.elevation[i]);
    }
  }
  return rows;
}

bool fit_elevation(OrganisedScan& grid, const std::vector<Row>& rows, double spread) {
  grid.elevation_rad.assign(grid.rows, NAN);
  size_t near = 0, all = 0;
  for (size_t r = 0; r < grid.rows; ++r) {
    std::vector<double> values = rows[r].elevation;
    if (values.size() < kMinReturns) continue;
    grid.elevation_rad[r] = median(values);
    all += values.size();
    for (double v : values) near += std::abs(v - grid.elevation_rad[r]) < spread;
  }
  return all > 0 && double(near) >= kMostReturns * double(all);
}

// Computes the azimuth of a row, the median of azimuth − column · step. Differences are taken from
// the circular mean.
double row_azimuth(const Row& row, double step) {
  double c = 0, s = 0;
  for (size_t k = 0; k < row.column.size(); ++k) {
    c += std::cos(row.azimuth[k] - row.column[k] * step);
    s += std::sin(row.azimuth[k] - row.column[k] * step);
  }
  const double mean = std::atan2(s, c);
  std::vector<double> rest(row.column.size());
  for (size_t k = 0; k < rest.size(); ++k) {
    rest[k] = signed_angle(row.azimuth[k] - row.column[k] * step - mean);
  }
  return mean + median(rest);
}

bool fit_azimuth(OrganisedScan& grid, const std::vector<Row>& rows) {
  std::vector<double> steps;
  for (const Row& row : rows) {
    for (size_t k = 1; k < row.column.size(); ++k) {
      if (row.column[k] != row.column[k - 1] + 1) continue;
      steps.push_back(signed_angle(row.azimuth[k] - row.azimuth[k - 1]));
    }
  }
  grid.step_rad = median(steps);
  const double turns = std::abs(grid.step_rad) * double(grid.columns) / (2 * M_PI);
  if (!(turns > 0.05 && turns < 1.2)) return false;
  grid.azimuth_rad.assign(grid.rows, NAN);
  size_t near = 0, all = 0;
  for (int pass = 0; pass < 4; ++pass) {
    std::vector<double> rests, columns, sizes;
    for (size_t r = 0; r < grid.rows; ++r) {
      if (rows[r].column.size() < kMinReturns) continue;
      grid.azimuth_rad[r] = row_azimuth(rows[r], grid.step_rad);
      for (size_t k = 0; k < rows[r].column.size(); ++k) {
        columns.push_back(rows[r].column[k] - 0.5 * double(grid.columns));
        rests.push_back(signed_angle(rows[r].azimuth[k] - grid.azimuth_rad[r] -
                                     rows[r].column[k] * grid.step_rad));
      }
    }
    for (double v : rests) sizes.push_back(std::abs(v));
    const double spread = median(sizes);
    all = rests.size();
    near = size_t(std::count_if(rests.begin(), rests.end(),
                                [&](double v) { return std::abs(v) < std::abs(grid.step_rad); }));
    double xy = 0, xx = 0;
    for (size_t k = 0; k < rests.size(); ++k) {
      if (std::abs(rests[k]) > 4 * spread) continue;
      xy += columns[k] * rests[k];
      xx += columns[k] * columns[k];
    }
    if (xx > 0 && pass < 3) grid.step_rad += xy / xx;
  }
  return double(near) >= kMostReturns * double(all);
}

// Extrapolates the elevation of row r by a line through up to 8 filled rows nearest to it.
double line_at(size_t r, std::vector<size_t> filled, const std::vector<double>& elevation) {
  const auto distance = [r](size_t q) { return q > r ? q - r : r - q; };
  std::stable_sort(filled.begin(), filled.end(),
                   [&](size_t a, size_t b) { return distance(a) < distance(b); });
  filled.resize(std::min<size_t>(filled.size(), 8));
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = double(filled.size());
  for (size_t q : filled) {
    x += double(q) / n;
    y += elevation[q] / n;
  }
  for (size_t q : filled) {
    xx += (double(q) - x) * (double(q) - x);
    xy += (double(q) - x) * (elevation[q] - y);
  }
  return y + (xx > 0 ? xy / xx * (double(r) - x) : 0);
}

void fill_empty_rows(OrganisedScan& grid, const Sensor* sensor) {
  std::vector<size_t> filled;
  std::vector<double> shifts;
  const bool known = sensor && sensor->channels.size() == grid.rows;
  for (size_t r = 0; r < grid.rows; ++r) {
    if (std::isnan(grid.elevation_rad[r])) continue;
    filled.push_back(r);
    if (known) shifts.push_back(grid.elevation_rad[r] - sensor->channels[r].elevation_rad);
  }
  const double shift = median(shifts);
  const std::vector<double> elevation = grid.elevation_rad, azimuth = grid.azimuth_rad;
  for (size_t r = 0; r < grid.rows; ++r) {
    if (!std::isnan(elevation[r])) continue;
    grid.elevation_rad[r] = std::clamp(
        known ? sensor->channels[r].elevation_rad + shift : line_at(r, filled, elevation),
        -M_PI / 2, M_PI / 2);
    size_t best = filled.front();
    const auto cost = [r](size_t q) {
      const size_t d = q > r ? q - r : r - q;
      return d + (d % 4 ? 1000000 : 0);
    };
    for (size_t q : filled) {
      if (cost(q) < cost(best)) best = q;
    }
    grid.azimuth_rad[r] = azimuth[best];
  }
}

// Fits the layout; true if it holds within `spread` of elevation.
bool fit(OrganisedScan& grid, const PointAngles& angles, double spread = kMaxSpread) {
  const std::vector<Row> rows = rows_of(grid, angles);
  const bool elevation = fit_elevation(grid, rows, spread);
  return fit_azimuth(grid, rows) && elevation;
}

PointAngles angles_of(const PointScan& scan, const OrganisedScan* grid) {
  const size_t n = scan.size();
  PointAngles angles{std::vector<double>(n, NAN), std::vector<double>(n, NAN)};
  for (size_t i = 0; i < n; ++i) {
    if (kind_of(scan.point[i], 0) != PointKind::kReturn) continue;
    const Vec3f p =
        grid ? grid->motion
                   ->point_of_beams(grid->share(grid->column(i)), scan.point[i].cast<double>())
                   .cast<float>()
             : scan.point[i];
    angles.azimuth[i] = azimuth_of(p);
    angles.elevation[i] = elevation_of(p);
  }
  return angles;
}

// Whether the layout may hold but for a motion: most returns lie near their row and line.
bool is_near(const OrganisedScan& grid, const PointAngles& angles) {
  if (grid.azimuth_rad.empty()) return false;
  size_t near = 0, all = 0;
  for (size_t i = 0; i < angles.azimuth.size(); ++i) {
    const size_t row = grid.row(i);
    if (std::isnan(angles.azimuth[i]) || std::isnan(grid.azimuth_rad[row])) continue;
    const double line = grid.azimuth_rad[row] + double(grid.column(i)) * grid.step_rad;
    ++all;
    near += std::abs(angles.elevation[i] - grid.elevation_rad[row]) < kMaxBend &&
            std::abs(signed_angle(angles.azimuth[i] - line)) < kMaxBend;
  }
  return all > 0 && double(near) >= kMostBent * double(all);
}

// Fits the layout and the motion in turns; true if the layout then holds.
bool fit_with_motion(OrganisedScan& grid, const PointScan& scan, PointAngles angles) {
  if (!is_near(grid, angles)) return false;
  grid.motion.emplace();
  const size_t stride = scan.size() / kMostSamples + 1;
  bool holds = false;
  for (int step = 0, more = 2; step < kMostSteps && more > 0; ++step) {
    std::vector<ScanMotion::Sample> samples;
    for (size_t i = 0; i < scan.size(); i += stride) {
      const size_t row = grid.row(i), column = grid.column(i);
      if (std::isnan(angles.azimuth[i]) || std::isnan(grid.azimuth_rad[row])) continue;
      samples.push_back({grid.share(column), scan.point[i].cast<double>(),
                         unit_vector(grid.azimuth_rad[row] + double(column) * grid.step_rad,
                                     grid.elevation_rad[row])});
    }
    grid.motion->improve(samples);
    angles = angles_of(scan, &grid);
    holds = fit(grid, angles);
    if (holds) --more;  // two more steps make it precise
  }
  return holds;
}

// Whether the scan's own ring numbers, if any, are constant in each row.
bool rings_agree(const OrganisedScan& grid, const std::vector<uint16_t>& ring) {
  for (size_t i = 0; i < ring.size(); ++i) {
    const size_t first = grid.column_major ? grid.row(i) : grid.row(i) * grid.columns;
    if (ring[i] != ring[first]) return false;
  }
  return true;
}

}  // namespace

Angles OrganisedScan::direction(size_t i) const {
  const size_t r = row(i), c = column(i);
  const Angles fired{azimuth_rad[r] + step_rad * double(c), elevation_rad[r]};
  if (!motion) return fired;
  const Vec3 d =
      motion->direction_of_points(share(c), unit_vector(fired.azimuth_rad, fired.elevation_rad));
  return {std::atan2(d.y(), d.x()), std::atan2(d.z(), std::hypot(d.x(), d.y()))};
}

std::optional<OrganisedScan> find_organised_scan(const PointScan& scan, const Sensor* sensor) {
  const size_t n = scan.size();
  const PointAngles angles = angles_of(scan, nullptr);
  std::set<size_t> candidates{16, 20, 32, 40, 64, 80, 96, 128};
  if (sensor) candidates.insert(sensor->channels.size());
  std::vector<OrganisedScan> layouts;
  std::optional<OrganisedScan> rough;  // holds without a motion, but may hold better with one
  for (size_t rows : candidates) {
    if (n == 0 || n % rows != 0 || n / rows < 2) continue;
    for (bool column_major : {true, false}) {
      OrganisedScan grid{rows, n / rows, column_major, 0, {}, {}, {}};
      if (!rings_agree(grid, scan.ring)) continue;
      if (fit(grid, angles, kFineSpread)) {
        fill_empty_rows(grid, sensor);
        return grid;
      }
      if (!rough && fit(grid, angles)) rough = grid;
      layouts.push_back(std::move(grid));
    }
  }
  for (OrganisedScan& grid : layouts) {
    if (!fit_with_motion(grid, scan, angles)) continue;
    fill_empty_rows(grid, sensor);
    return grid;
  }
  if (rough) fill_empty_rows(*rough, sensor);
  return rough;
}

}  // namespace underbrush::sensor
