#include "underbrush/core/beam_log.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "underbrush/core/check.hpp"

namespace underbrush {
namespace {

template <class Log, class F>
void for_columns(Log& log, F f) {
  f(log.origin);
  f(log.direction);
  f(log.range_m);
  f(log.intensity);
  f(log.time_s);
  f(log.ring);
  f(log.scan);
  f(log.packet);
  f(log.flags);
  for (auto& [name, column] : log.extra) std::visit(f, column);
}

}  // namespace

uint32_t whole_number(const ExtraColumn& column, size_t i) {
  return std::visit([&](const auto& c) { return c[i] > 0 ? uint32_t(c[i]) : 0u; }, column);
}

void BeamLog::resize(size_t n) {
  origin.resize(n, Vec3::Zero());
  direction.resize(n, Vec3f::UnitX());
  range_m.resize(n, kMiss);
  for_columns(*this, [n](auto& column) { column.resize(n); });
}

void BeamLog::reserve(size_t n) {
  for_columns(*this, [n](auto& column) { column.reserve(n); });
}

void BeamLog::append(const BeamLog& other, size_t i) { append(other, i, i + 1); }

void BeamLog::append(const BeamLog& other, size_t begin, size_t end) {
  require(begin <= end && end <= other.size(), "append: no such beams");
  const bool was_empty = empty();
  const auto add = [&](auto& mine, const auto& theirs) {
    mine.insert(mine.end(), theirs.begin() + begin, theirs.begin() + end);
  };
  add(origin, other.origin);
  add(direction, other.direction);
  add(range_m, other.range_m);
  add(intensity, other.intensity);
  add(time_s, other.time_s);
  add(ring, other.ring);
  add(scan, other.scan);
  add(packet, other.packet);
  add(flags, other.flags);
  for (const auto& [name, theirs] : other.extra) {
    std::visit(
        [&, key = name](const auto& source) {
          using Column = std::decay_t<decltype(source)>;
          auto it = extra.find(key);
          if (it == extra.end() && was_empty) it = extra.emplace(key, Column{}).first;
          if (it == extra.end()) return;
          if (auto* mine = std::get_if<Column>(&it->second)) add(*mine, source);
        },
        theirs);
  }
  // An extra column that `other` lacks, or holds in another type, is filled with zeros.
  for (auto& [name, column] : extra) {
    std::visit([n = size()](auto& mine) { mine.resize(n); }, column);
  }
}

BeamLog BeamLog::like() const {
  BeamLog out;
  out.info = info;
  for (const auto& [name, column] : extra) {
    std::visit(
        [&, key = name](const auto& c) { out.extra.emplace(key, std::decay_t<decltype(c)>{}); },
        column);
  }
  return out;
}

const char* beam_fault(const BeamLog& log, size_t i) {
  // The comparisons are those that NaN fails.
  constexpr float kLengthError = 2e-3f;  // of the squared length
  const auto is_near = [](double x) { return std::abs(x) < kMaxCoordinate; };
  const Vec3& origin = log.origin[i];
  if (!(std::abs(log.direction[i].squaredNorm() - 1) < kLengthError)) {
    return "direction is not a unit vector";
  }
  if (!is_near(origin.x()) || !is_near(origin.y()) || !is_near(origin.z())) {
    return "origin is not finite or too far away";
  }
  if (!(log.range_m[i] >= 0)) return "range is not a number or negative";
  if (!std::isfinite(log.time_s[i])) return "time is not finite";
  return nullptr;
}

void BeamLog::check() const {
  const size_t n = size();
  for_columns(*this, [n](const auto& c) {
    require(c.size() == n, "beam log: columns of different lengths");
  });
  for (size_t i = 0; i < n; ++i) {
    if (const char* wrong = beam_fault(*this, i)) {
      throw std::invalid_argument("beam log: the " + std::string(wrong) + " (row " +
                                  std::to_string(i) + ")");
    }
  }
}

bool MemorySource::next(BeamLog& chunk) {
  chunk = log_.like();
  const size_t end = std::min(log_.size(), at_ + chunk_size_);
  chunk.append(log_, at_, end);
  at_ = end;
  return !chunk.empty();
}

std::vector<bool> begins_beam(const BeamLog& log) {
  std::vector<bool> begins(log.size(), true);
  const auto found = log.extra.find(kEchoColumn);
  if (found == log.extra.end()) return begins;
  std::visit(
      [&](const auto& echo) {
        for (size_t i = 0; i < echo.size(); ++i) begins[i] = echo[i] <= 1;
      },
      found->second);
  return begins;
}

void keep_first_echoes(BeamLog& log) {
  const std::vector<bool> begins = begins_beam(log);
  if (std::find(begins.begin(), begins.end(), false) == begins.end()) return;
  BeamLog kept = log.like();
  for (size_t begin = 0; begin < begins.size();) {
    size_t end = begin;
    while (end < begins.size() && begins[end]) ++end;
    if (end > begin) kept.append(log, begin, end);
    begin = end + 1;
  }
  log = std::move(kept);
}

std::optional<Vec3> log_origin(BeamSource& source) {
  std::optional<Vec3> origin;
  source.rewind();
  for (BeamLog chunk; !origin && source.next(chunk);) {
    if (!chunk.empty()) origin = chunk.origin[0].array().round();
  }
  source.rewind();
  return origin;
}

}  // namespace underbrush
