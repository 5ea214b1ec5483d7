#include "underbrush/io/csv_beams.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/point_times.hpp"

namespace underbrush::io {
namespace {

std::vector<double> take(Table& table, const std::string& name, size_t n, double otherwise) {
  for (auto at = table.columns.begin(); at != table.columns.end(); ++at) {
    if (at->first != name) continue;
    std::vector<double> out = doubles_of(at->second);
    table.columns.erase(at);
    return out;
  }
  return std::vector<double>(n, otherwise);
}

/// The times of the rows, s: those of "time" as they are, those of other names in their unit.
std::vector<double> times_of(const std::string& file, Table& table, size_t n) {
  const std::string name = table.find({"time"}) ? "time" : table.name_of(time_names());
  if (name.empty() || name == "time") return take(table, "time", n, 0);
  PointTimes times;
  return times.seconds(file, name, take(table, name, n, 0), 0);
}

template <class T>
void fill(std::vector<T>& to, const std::vector<double>& from, const std::string& file,
          const char* name) {
  for (size_t i = 0; i < from.size(); ++i) {
    if (!(from[i] >= 0 && from[i] <= double(std::numeric_limits<T>::max()))) {
      throw FormatError(file, "row " + std::to_string(i + 1), std::string("bad ") + name);
    }
    to[i] = T(from[i]);
  }
}

}  // namespace

bool has_origins(const Table& table) {
  return table.find({"ox"}) && table.find({"oy"}) && table.find({"oz"});
}

BeamLog beams_from_table(const std::string& file, Table table,
                         std::map<std::string, size_t>& skipped) {
  const size_t n = table.size();
  for (const char* name : {"x", "y", "z"}) {
    if (!table.find({name})) throw FormatError(file, "header", std::string("no column ") + name);
  }
  std::array<std::vector<double>, 6> v;
  constexpr const char* kNames[] = {"x", "y", "z", "ox", "oy", "oz"};
  for (size_t c = 0; c < 6; ++c) v[c] = take(table, kNames[c], n, 0);
  const auto hit = take(table, "hit", n, 1), time = times_of(file, table, n),
             intensity = take(table, "intensity", n, 0);
  BeamLog all;
  all.resize(n);
  fill(all.ring, take(table, "ring", n, 0), file, "ring");
  fill(all.scan, take(table, "scan", n, 0), file, "scan");
  fill(all.packet, take(table, "packet", n, 0), file, "packet");
  fill(all.flags, take(table, "flags", n, 0), file, "flags");
  for (auto& [name, column] : table.columns) all.extra[name] = std::move(column);
  double longest = 0;
  std::vector<uint8_t> keep(n, 0);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 end(v[0][i], v[1][i], v[2][i]), origin(v[3][i], v[4][i], v[5][i]);
    const double length = (end - origin).norm();
    const bool finite = std::isfinite(length) && std::isfinite(time[i]) &&
                        std::isfinite(float(intensity[i])) && std::isfinite(hit[i]) &&
                        length < 1e6 && is_within(origin, 6e7);
    if (!finite || length < 1e-6) {
      ++skipped[finite ? "zero-length ray" : "not finite"];
      continue;
    }
    keep[i] = 1;
    longest = std::max(longest, length);
    all.origin[i] = origin;
    all.direction[i] = ((end - origin) / length).cast<float>();
    all.range_m[i] = hit[i] != 0 ? float(length) : kMiss;
    all.info.has_misses = all.info.has_misses || hit[i] == 0;
    all.time_s[i] = time[i];
    all.intensity[i] = hit[i] != 0 ? float(intensity[i]) : 0;
  }
  BeamLog log = all.like();
  for (size_t i = 0; i < n; ++i) {
    if (keep[i]) log.append(all, i);
  }
  if (log.empty()) throw FormatError(file, "", "an empty log: no usable beams");
  log.info.max_range_m = longest;
  log.info.deskewed = true;  // every beam has its own origin
  return log;
}

}  // namespace underbrush::io
