#include "underbrush/sensor/shots.hpp"

#include <charconv>
#include <cmath>
#include <string>

#include "underbrush/core/check.hpp"

namespace underbrush::sensor {
namespace {

double place(double from, double to, uint32_t k, uint32_t n) {
  return n < 2 ? from : from + (to - from) * k / (n - 1);
}

/// Reads the numbers of a line; gives none where the line has something else.
std::vector<double> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  const char *at = line.data(), *end = at + line.size();
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == ','; };
  while (true) {
    while (at < end && blank(*at)) ++at;
    if (at == end) return numbers;
    double v = 0;
    const auto [rest, error] = std::from_chars(at, end, v);
    if (error != std::errc() || !std::isfinite(v) || (rest < end && !blank(*rest))) return {};
    numbers.push_back(v);
    at = rest;
  }
}

}  // namespace

Shot Raster::shot(uint64_t k) const {
  const uint32_t length = by_columns ? rows : columns;
  const auto line = uint32_t(k / length);
  auto along = uint32_t(k % length);
  if (serpentine && line % 2 == 1) along = length - 1 - along;
  const uint32_t column = by_columns ? line : along, row = by_columns ? along : line;
  return {place(azimuth_from_rad, azimuth_to_rad, column, columns),
          place(elevation_from_rad, elevation_to_rad, row, rows), 0, uint16_t(row)};
}

std::vector<Shot> shots_from_csv(std::string_view file, std::string_view text, double cycle_s) {
  std::vector<Shot> shots;
  size_t width = 0, number = 0;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos || line.front() == '#') continue;
    const std::vector<double> v = numbers_of(line);
    if (v.empty() && shots.empty() && width == 0) {
      width = 1;  // the header
      continue;
    }
    const auto fail = [&](const char* reason) {
      throw FormatError(file, "line " + std::to_string(number), reason);
    };
    if (shots.empty()) width = v.size();
    if (v.size() != width || width < 2 || width > 4) fail("needs 2 to 4 numbers, as the first row");
    if (std::abs(v[1]) > 90) fail("elevation beyond 90 degrees");
    Shot s{v[0] * kDegree, v[1] * kDegree, 0, 0};
    if (width > 2) {
      s.time_s = v[2] * 1e-6;
      if (s.time_s < (shots.empty() ? 0 : shots.back().time_s) || s.time_s >= cycle_s) {
        fail("times must rise and lie within the cycle");
      }
    }
    if (width > 3) {
      if (!(v[3] >= 0 && v[3] < 65535)) fail("ring must be 0 to 65534");
      s.ring = uint16_t(v[3]);
    }
    shots.push_back(s);
  }
  if (shots.empty()) throw FormatError(file, "", "no directions");
  if (width == 2) {
    for (size_t k = 0; k < shots.size(); ++k) {
      shots[k].time_s = cycle_s * double(k) / double(shots.size());
    }
  }
  return shots;
}

}  // namespace underbrush::sensor
