/// \file
/// The inner loops of `underbrush.formats.place`: the order of beams in time, and their rays in the
/// world.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <vector>

#include "bind.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/pose.hpp"
#include "underbrush/sensor/scan_grid.hpp"
#include "views.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

template <class T>
using ColumnOf = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <int Width>
using TableOf = nb::ndarray<const double, nb::shape<-1, Width>, nb::c_contig, nb::device::cpu>;

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

/// Returns an array that takes over a vector.
template <class T>
Column<T> owned(std::vector<T> column) {
  auto* const kept = new std::vector<T>(std::move(column));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return Column<T>(kept->data(), {kept->size()}, owner);
}
template <class T>
Rows<T, 3> owned_rows(std::vector<T> column) {
  auto* const kept = new std::vector<T>(std::move(column));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return Rows<T, 3>(kept->data(), {kept->size() / 3, 3}, owner);
}

/// Numbers the distinct times in the order in which they come first, up to a number of them.
class Distinct {
 public:
  explicit Distinct(size_t most) : most_(most), slots_(std::bit_ceil(4 * most), kNone) {}

  /// Returns the number of a time, or `kNone` where it would be one too many, or too many others
  /// have its place.
  uint32_t number_of(double time) {
    if (std::isnan(time)) time = std::numeric_limits<double>::quiet_NaN();
    const uint64_t bits = std::bit_cast<uint64_t>(time);
    const size_t begin = size_t(bits * 0x9e3779b97f4a7c15u >> 32);
    for (size_t at = begin; at < begin + kMostProbes; ++at) {
      uint32_t& slot = slots_[at & (slots_.size() - 1)];
      if (slot == kNone) {
        if (times_.size() == most_) return kNone;
        slot = uint32_t(times_.size());
        times_.push_back(time);
        return slot;
      }
      if (std::bit_cast<uint64_t>(times_[slot]) == bits) return slot;
    }
    return kNone;
  }
  const std::vector<double>& times() const { return times_; }

 private:
  static constexpr size_t kMostProbes = 64;
  size_t most_;
  std::vector<uint32_t> slots_;
  std::vector<double> times_;
};

/// Times that are not a number come last.
bool is_before(double a, double b) { return a < b || (std::isnan(b) && !std::isnan(a)); }

/// The distinct times in their order, the number of each row's time, and the rows in order of time.
struct Groups {
  std::vector<double> times;
  std::vector<uint32_t> group, order;
};

/// The groups of times that are in order; `order` is left out.
Groups groups_in_order(const double* time, size_t n) {
  Groups out;
  out.group.resize(n);
  for (size_t i = 0; i < n; ++i) {
    if (out.times.empty() || time[i] > out.times.back()) out.times.push_back(time[i]);
    out.group[i] = uint32_t(out.times.size() - 1);
  }
  return out;
}

/// The order in time by the numbers of the distinct times, or nothing where there are too many.
std::optional<Groups> groups_by_number(const double* time, size_t n) {
  Distinct distinct(n / 8 + 1);
  Groups out;
  out.group.resize(n);
  for (size_t i = 0; i < n; ++i) {
    out.group[i] = distinct.number_of(time[i] + 0.0);  // −0 is 0.
    if (out.group[i] == kNone) return {};
  }
  const std::vector<double>& times = distinct.times();
  std::vector<uint32_t> sorted(times.size()), rank(times.size());
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::sort(sorted.begin(), sorted.end(),
            [&](uint32_t a, uint32_t b) { return is_before(times[a], times[b]); });
  for (size_t k = 0; k < sorted.size(); ++k) {
    rank[sorted[k]] = uint32_t(k);
    out.times.push_back(times[sorted[k]]);
  }
  std::vector<uint32_t> next(times.size() + 1);
  for (uint32_t& g : out.group) ++next[(g = rank[g]) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  out.order.resize(n);
  for (size_t i = 0; i < n; ++i) out.order[next[out.group[i]]++] = uint32_t(i);
  return out;
}

Groups groups_by_sorting(const double* time, size_t n) {
  Groups out;
  out.group.resize(n);
  out.order.resize(n);
  std::iota(out.order.begin(), out.order.end(), 0u);
  std::stable_sort(out.order.begin(), out.order.end(),
                   [&](uint32_t a, uint32_t b) { return is_before(time[a], time[b]); });
  for (const uint32_t i : out.order) {
    if (out.times.empty() || is_before(out.times.back(), time[i])) out.times.push_back(time[i]);
    out.group[i] = uint32_t(out.times.size() - 1);
  }
  return out;
}

std::tuple<Column<double>, Column<uint32_t>, std::optional<Column<uint32_t>>> group_times(
    const ColumnOf<double>& time_s) {
  const size_t n = time_s.shape(0);
  const double* const time = time_s.data();
  require(n < kNone, "more rows than 2^32");
  const bool in_order =
      std::is_sorted(time, time + n, [](double a, double b) { return !(a >= b); });
  Groups found;
  if (in_order && (n == 0 || !std::isnan(time[0]))) {
    found = groups_in_order(time, n);
  } else if (std::optional<Groups> few = groups_by_number(time, n)) {
    found = std::move(*few);
  } else {
    found = groups_by_sorting(time, n);
  }
  std::optional<Column<uint32_t>> order;
  if (!found.order.empty()) order = owned(std::move(found.order));
  return {owned(std::move(found.times)), owned(std::move(found.group)), std::move(order)};
}

/// What is said of the beams of a scan; a null pointer stands for what is not given.
struct RaysGiven {
  const double *xyz = nullptr, *instead = nullptr, *direction = nullptr, *from = nullptr;
  const float* range_m = nullptr;
};

/// A vector turned by a unit quaternion x y z w.
void turn(const double* q, double v[3]) {
  const double x = q[0], y = q[1], z = q[2], w = q[3], a = v[0], b = v[1], c = v[2];
  const double r = 2 * (y * c - z * b), s = 2 * (z * a - x * c), t = 2 * (x * b - y * a);
  v[0] = a + w * r + y * t - z * s;
  v[1] = b + w * s + z * r - x * t;
  v[2] = c + w * t + x * s - y * r;
}

/// Computes the direction and the range of row i as they are given; `base` is where the beam begins
/// if points are those of the world, else null.
double ray_of(const RaysGiven& rays, size_t i, const double* base, double direction[3]) {
  if (!rays.xyz) {
    std::copy_n(rays.direction + 3 * i, 3, direction);
    return double(rays.range_m[i]);
  }
  for (size_t k = 0; k < 3; ++k) direction[k] = rays.xyz[3 * i + k] - (base ? base[k] : 0);
  const double range_m = std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
                                   direction[2] * direction[2]);
  if (std::isfinite(range_m)) {
    for (size_t k = 0; k < 3; ++k) direction[k] = range_m == 0 ? 0 : direction[k] / range_m;
    return range_m;
  }
  for (size_t k = 0; k < 3; ++k) {
    direction[k] =
        rays.instead ? rays.instead[3 * i + k] : std::numeric_limits<double>::quiet_NaN();
  }
  return std::numeric_limits<double>::infinity();
}

using Placed = std::tuple<Column<uint32_t>, Rows<double, 3>, Rows<float, 3>, Column<float>,
                          std::array<size_t, 4>>;

/// The arguments are those of the bound function.
Placed place_rays(const std::optional<TableOf<3>>& xyz, const std::optional<TableOf<3>>& instead,
                  const std::optional<TableOf<3>>& direction,
                  const std::optional<ColumnOf<float>>& range_m,
                  const std::optional<TableOf<3>>& beam_origin, const ColumnOf<uint32_t>& group,
                  const TableOf<3>& position, const std::optional<TableOf<4>>& rotation,
                  const ColumnOf<bool>& inside, const std::optional<ColumnOf<uint32_t>>& order,
                  double least_range_m) {
  const size_t n = group.shape(0), poses = position.shape(0);
  const auto fits = [n](const auto& rows) { return !rows || rows->shape(0) == n; };
  require(fits(xyz) && fits(instead) && fits(direction) && fits(range_m) && fits(beam_origin) &&
              fits(order) && (xyz || (direction && range_m)) && inside.shape(0) == poses &&
              (!rotation || rotation->shape(0) == poses),
          "place_rays: columns differ in length");
  const auto data = [](const auto& rows) { return rows ? rows->data() : nullptr; };
  const RaysGiven rays{data(xyz), data(instead), data(direction), data(beam_origin), data(range_m)};
  std::vector<uint32_t> rows;
  rows.reserve(n);
  std::vector<double> origin;
  origin.reserve(3 * n);
  std::vector<float> ray, ranges;
  ray.reserve(3 * n);
  ranges.reserve(n);
  std::array<size_t, 4> left{};
  for (size_t k = 0; k < n; ++k) {
    const uint32_t i = order ? order->data()[k] : uint32_t(k);
    require(i < n && group.data()[i] < poses, "place_rays: no such row or pose");
    const uint32_t at = group.data()[i];
    double base[3], d[3];
    std::copy_n(position.data() + 3 * at, 3, base);
    const bool within = inside.data()[at], lost = within && std::isnan(base[0]);
    const double range = ray_of(rays, i, rotation ? nullptr : base, d);
    if (rotation) {
      const double* const q = rotation->data() + 4 * at;
      turn(q, d);
      if (rays.from) {
        double from[3];
        std::copy_n(rays.from + 3 * i, 3, from);
        turn(q, from);
        for (size_t c = 0; c < 3; ++c) base[c] += from[c];
      }
    }
    const bool directed = std::isfinite(d[0]), near = !(range > least_range_m);
    left[0] += !within;
    left[1] += lost;
    left[2] += within && !lost && !directed;
    left[3] += within && directed && near;
    if (!within || !directed || near) continue;
    origin.insert(origin.end(), base, base + 3);
    for (const double c : d) ray.push_back(float(c));
    ranges.push_back(float(range));
    rows.push_back(i);
  }
  return {owned(std::move(rows)), owned_rows(std::move(origin)), owned_rows(std::move(ray)),
          owned(std::move(ranges)), left};
}

/// Returns the directions of all beams, or None where no grid explains the hits.
std::optional<Rows<double, 3>> grid_directions(const TableOf<3>& xyz, size_t rows, size_t columns,
                                               bool by_ring) {
  require(rows * columns == xyz.shape(0), "grid_directions: the points are no such grid");
  double* direction = nullptr;
  Rows<double, 3> out = new_rows<3>(xyz.shape(0), direction);
  if (!sensor::grid_directions(xyz.data(), {rows, columns, by_ring}, direction)) return {};
  return out;
}

}  // namespace

void bind_place(nb::module_& m) {
  m.def(
      "group_times", &group_times, "time_s"_a,
      "Returns the distinct times (m,) in their order, the number of each row's time among them\n"
      "(n,), and the rows in order of time, of equal times in their own order; None for rows that\n"
      "are in order.");
  m.def(
      "place_rays", &place_rays, "xyz"_a.none(), "instead"_a.none(), "direction"_a.none(),
      "range_m"_a.none(), "beam_origin"_a.none(), "group"_a, "position"_a, "rotation"_a.none(),
      "inside"_a, "order"_a.none(), "least_range_m"_a,
      "Returns the beams in the world's frame: their rows, origins (k, 3), directions (k, 3) and\n"
      "ranges, and how many are left out: those with a pose that is not `inside`, with a position\n"
      "that is not a number, without a direction, and nearer than `least_range_m`.\n\n"
      "A row's beam ends at `xyz`, or goes along `instead` without a return; or it has a\n"
      "`direction` and a `range_m`, and begins at `beam_origin`. It has the pose `group`, world\n"
      "from sensor. Without `rotation`, points and directions are those of the world.");
  m.def(
      "grid_directions", &grid_directions, "xyz"_a, "rows"_a, "columns"_a, "by_ring"_a,
      "Returns the directions (n, 3) of all beams of a scan of `rows` times `columns`, found\n"
      "from its hits, or None where no grid explains these to half a degree. The points (n, 3),\n"
      "m in the sensor's frame, are not finite without a return. A row is a ring with `by_ring`,\n"
      "else a firing.");
}

}  // namespace underbrush::python
