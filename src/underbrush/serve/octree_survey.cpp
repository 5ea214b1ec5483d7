#include "underbrush/serve/octree_survey.hpp"

#include <algorithm>
#include <bit>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::serve {
namespace {

constexpr uint32_t kLeastRun = 256;

// A column of the log by name as 64-bit numbers; empty if the log does not have it.
std::vector<uint32_t> whole_numbers(const BeamLog& log, const char* name) {
  const auto found = log.extra.find(name);
  if (found == log.extra.end()) return {};
  return std::visit(
      [](const auto& column) {
        std::vector<uint32_t> out(column.size());
        for (size_t i = 0; i < out.size(); ++i) {
          const auto v = column[i];
          out[i] = v > 0 ? uint32_t(std::min<double>(double(v), 65535)) : 0;
        }
        return out;
      },
      found->second);
}

void add_runs(const BeamLog& chunk, size_t first_row, OctreeSurvey& s,
              const std::vector<bool>& begins) {
  for (size_t i = 0; i < chunk.size(); ++i) {
    const bool other = s.runs.empty() || (begins[i] && chunk.scan[i] != s.runs.back().scan &&
                                          s.runs.back().rows >= kLeastRun);
    if (other) s.runs.push_back({first_row + i, s.beams, 0, chunk.scan[i], chunk.time_s[i]});
    ++s.runs.back().rows;
    s.beams += begins[i];
  }
}

}  // namespace

CellCounts::CellCounts(size_t most_cells, uint32_t bits)
    : most_(std::bit_ceil(std::max<size_t>(most_cells, 8))), bits_(bits), table_(2 * most_) {}

CellCounts::Cell& CellCounts::place(const std::array<int64_t, 3>& at) {
  const uint64_t hash =
      mix64(uint64_t(at[0]) * 0x9e3779b97f4a7c15ull ^ uint64_t(at[1]) * 0xbf58476d1ce4e5b9ull ^
            uint64_t(at[2]) * 0x94d049bb133111ebull);
  size_t k = hash & (table_.size() - 1);
  while (table_[k].points != 0 && table_[k].at != at) k = (k + 1) & (table_.size() - 1);
  latest_ = k;
  return table_[k];
}

void CellCounts::add(const std::array<int64_t, 3>& at) {
  const std::array<int64_t, 3> cell{at[0] >> bits_, at[1] >> bits_, at[2] >> bits_};
  Cell& latest = table_[latest_];  // neighbours in a log are often neighbours in space
  Cell& c = latest.points != 0 && latest.at == cell ? latest : place(cell);
  if (c.points == 0) {
    c.at = cell;
    ++used_;
  }
  ++c.points;
  while (used_ > most_) grow();
}

void CellCounts::grow() {
  const std::vector<Cell> old = cells();
  std::fill(table_.begin(), table_.end(), Cell{});
  used_ = 0;
  ++bits_;
  for (const Cell& c : old) {
    const std::array<int64_t, 3> at{c.at[0] >> 1, c.at[1] >> 1, c.at[2] >> 1};
    Cell& to = place(at);
    used_ += to.points == 0;
    to.at = at;
    to.points += c.points;
  }
}

std::vector<CellCounts::Cell> CellCounts::cells() const {
  std::vector<Cell> out;
  out.reserve(used_);
  for (const Cell& c : table_) {
    if (c.points != 0) out.push_back(c);
  }
  return out;
}

OctreeRoot OctreeSurvey::root() const {
  OctreeRoot r;
  r.bits = counts.bits() + 1;
  if (points == 0) return r;
  int64_t most = 1;
  for (size_t c = 0; c < 3; ++c) {
    const int64_t first = low[c] >> counts.bits(), last = high[c] >> counts.bits();
    r.low[c] = first << counts.bits();
    most = std::max(most, last - first + 1);
  }
  r.bits = counts.bits() + std::max(1u, uint32_t(std::bit_width(uint64_t(most - 1))));
  return r;
}

void for_each_return(const BeamLog& chunk, size_t first_row, const OctreeSurvey& survey,
                     const std::function<void(const OctreePoint&)>& use) {
  const std::vector<uint32_t> labels = whole_numbers(chunk, "class"),
                              echoes = whole_numbers(chunk, kEchoColumn);
  OctreePoint p;
  for (size_t i = 0; i < chunk.size(); ++i) {
    if (!chunk.is_hit(i)) continue;
    const Vec3 at = chunk.end_point(i) - survey.origin;
    for (size_t c = 0; c < 3; ++c) p.at[c] = int64_t(std::floor(at[Eigen::Index(c)] / kUnitM));
    p.intensity = chunk.intensity[i];
    p.time_s = float(chunk.time_s[i] - survey.first_s);
    p.row = uint32_t(first_row + i);
    p.ring = chunk.ring[i];
    p.label = labels.empty() ? uint16_t(0) : uint16_t(labels[i]);
    p.echo = echoes.empty() ? uint8_t(1) : uint8_t(std::min<uint32_t>(echoes[i], 255));
    use(p);
  }
}

OctreeSurvey survey_log(BeamSource& log, const std::function<void(size_t)>& progress) {
  OctreeSurvey s;
  const std::optional<Vec3> origin = log_origin(log);
  require_data(origin.has_value(), "an empty log: no beams");
  s.origin = *origin;
  s.first_s = 0;  // times of the points are not used here
  double first_s = std::numeric_limits<double>::infinity();
  for (BeamLog chunk; log.next(chunk);) {
    require_data(s.rows + chunk.size() < (uint64_t(1) << 32), "a log of 2^32 rows or more");
    add_runs(chunk, s.rows, s, begins_beam(chunk));
    for (const double t : chunk.time_s) {
      first_s = std::min(first_s, t);
      s.last_s = std::max(s.last_s, t);
    }
    s.has_labels = s.has_labels || chunk.extra.count("class") != 0;
    for_each_return(chunk, s.rows, s, [&](const OctreePoint& p) {
      if (s.points == 0) {
        s.low = s.high = p.at;
        s.least_intensity = s.most_intensity = p.intensity;
      }
      for (size_t c = 0; c < 3; ++c) {
        s.low[c] = std::min(s.low[c], p.at[c]);
        s.high[c] = std::max(s.high[c], p.at[c]);
      }
      s.least_intensity = std::min(s.least_intensity, p.intensity);
      s.most_intensity = std::max(s.most_intensity, p.intensity);
      s.most_ring = std::max(s.most_ring, p.ring);
      s.most_echo = std::max(s.most_echo, p.echo);
      ++s.labels[p.label];
      s.counts.add(p.at);
      ++s.points;
    });
    s.rows += chunk.size();
    if (progress) progress(s.rows);
  }
  s.first_s = first_s;
  return s;
}

}  // namespace underbrush::serve
