#include "underbrush/sensor/pulse_returns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kSameBeam = 1e-3;  // rad; returns of one pulse differ by the file's rounding
constexpr size_t kMostEchoes = 255;

struct Columns {
  std::string number_name, count_name;
  std::vector<double> number, count;
};

std::vector<double> doubles(const ExtraColumn& column) {
  return std::visit([](const auto& c) { return std::vector<double>(c.begin(), c.end()); }, column);
}

std::optional<Columns> columns_of(const PointScan& scan) {
  for (const auto& [number, count] : {std::pair{"target_index", "target_count"},
                                      std::pair{"return_number", "number_of_returns"}}) {
    const auto a = scan.extra.find(number), b = scan.extra.find(count);
    if (a == scan.extra.end() || b == scan.extra.end()) continue;
    return Columns{number, count, doubles(a->second), doubles(b->second)};
  }
  return std::nullopt;
}

/// First returns by the cell of their direction.
class FirstReturns {
 public:
  FirstReturns(const PointScan& scan, const Columns& columns) : scan_(scan), columns_(columns) {}

  void add(uint32_t row) { cells_[cell_of(direction(row), kSameBeam)].push_back(row); }

  /// Finds the row of the first return to which a later one belongs, or −1.
  int64_t of(uint32_t row) const {
    const Vec3 d = direction(row);
    const double range_m = range(row);
    double best = kSameBeam;
    int64_t found = -1;
    const Cell3 at = cell_of(d, kSameBeam);
    for (int k = 0; k < 27; ++k) {
      const auto cell =
          cells_.find(Cell3{at.x + k % 3 - 1, at.y + k / 3 % 3 - 1, at.z + k / 9 - 1});
      if (cell == cells_.end()) continue;
      for (const uint32_t first : cell->second) {
        if (columns_.count[first] != columns_.count[row] || range(first) > range_m) continue;
        if (!scan_.time_s.empty() && scan_.time_s[first] != scan_.time_s[row]) continue;
        const double off = (direction(first) - d).norm();
        if (off < best) best = off, found = first;
      }
    }
    return found;
  }

  double range(uint32_t row) const { return scan_.point[row].cast<double>().norm(); }

 private:
  Vec3 direction(uint32_t row) const { return scan_.point[row].cast<double>().normalized(); }

  const PointScan& scan_;
  const Columns& columns_;
  CellMap<Cell3, std::vector<uint32_t>> cells_;
};

bool is_point(const Vec3f& p) { return p.allFinite() && p.squaredNorm() > 0; }

/// Copies the rows `rows` of a scan.
PointScan rows_of(const PointScan& scan, const std::vector<uint32_t>& rows) {
  const auto gather = [&](const auto& column) {
    std::decay_t<decltype(column)> out;
    if (column.empty()) return out;
    out.reserve(rows.size());
    for (const uint32_t row : rows) out.push_back(column[row]);
    return out;
  };
  PointScan out;
  out.info = scan.info;
  out.point = gather(scan.point);
  out.intensity = gather(scan.intensity);
  out.time_s = gather(scan.time_s);
  out.ring = gather(scan.ring);
  for (const auto& [name, column] : scan.extra) {
    out.extra[name] = std::visit([&](const auto& c) { return ExtraColumn(gather(c)); }, column);
  }
  return out;
}

}  // namespace

std::optional<PulseReturns> pulse_returns(const PointScan& scan) {
  const std::optional<Columns> columns = columns_of(scan);
  if (!columns) return std::nullopt;
  std::vector<uint32_t> first_rows, later_rows;
  FirstReturns firsts(scan, *columns);
  std::vector<uint32_t> index(scan.size());
  for (uint32_t i = 0; i < scan.size(); ++i) {
    const bool point = is_point(scan.point[i]);
    if (point && columns->number[i] > 1) {
      later_rows.push_back(i);
      continue;
    }
    if (point && columns->count[i] > 1) firsts.add(i);
    index[i] = uint32_t(first_rows.size());
    first_rows.push_back(i);
  }
  PulseReturns out;
  for (const uint32_t row : later_rows) {
    const int64_t first = firsts.of(row);
    if (first < 0) {
      ++out.lost;
      continue;
    }
    out.later.push_back({index[size_t(first)], float(firsts.range(row)), scan.intensity[row], 0});
  }
  std::sort(out.later.begin(), out.later.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.range_m < b.range_m;
  });
  out.first = rows_of(scan, first_rows);
  out.first.extra.erase(columns->number_name);
  out.first.extra.erase(columns->count_name);
  std::vector<uint8_t> echo(first_rows.size()), echoes(first_rows.size());
  for (size_t i = 0; i < first_rows.size(); ++i) {
    echo[i] = echoes[i] = is_point(out.first.point[i]);
  }
  for (PulseReturns::Later& l : out.later) {
    if (echoes[l.first] < kMostEchoes) ++echoes[l.first];
    l.echo = echoes[l.first];
  }
  std::vector<uint32_t> pulse(first_rows.size());
  for (uint32_t i = 0; i < pulse.size(); ++i) pulse[i] = i;
  out.first.extra[kEchoColumn] = std::move(echo);
  out.first.extra[kEchoesColumn] = std::move(echoes);
  out.first.extra[kPulseColumn] = std::move(pulse);
  return out;
}

void insert_later_returns(const PulseReturns& pulses, BeamLog& beams) {
  const auto pulse = std::get<std::vector<uint32_t>>(beams.extra.at(kPulseColumn));
  beams.extra.erase(kPulseColumn);
  BeamLog out = beams.like();
  out.reserve(beams.size() + pulses.later.size());
  const auto by_pulse = [](const PulseReturns::Later& l, uint32_t first) {
    return l.first < first;
  };
  for (size_t i = 0; i < beams.size(); ++i) {
    out.append(beams, i);
    if (!beams.is_hit(i)) continue;
    auto later = std::lower_bound(pulses.later.begin(), pulses.later.end(), pulse[i], by_pulse);
    for (; later != pulses.later.end() && later->first == pulse[i]; ++later) {
      out.append(beams, i);
      out.range_m.back() = later->range_m;
      out.intensity.back() = later->intensity;
      std::get<std::vector<uint8_t>>(out.extra.at(kEchoColumn)).back() = later->echo;
    }
  }
  beams = std::move(out);
}

}  // namespace underbrush::sensor
