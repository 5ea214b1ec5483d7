#include "underbrush/primitives/measure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/primitives/box_beams.hpp"

namespace underbrush::primitives {
namespace {

using elements::Class;

constexpr double kLeastSlant = 1e-3;     // Length of the mean direction of beams, seen from above,
                                         // below which it says nothing.
constexpr size_t kMostPoints = 1 << 15;  // Points of an object; beyond that number every other one
                                         // is dropped.

/// Key of an object or a cell: its number and, for a cell, its place.
struct Key {
  uint32_t instance;
  int32_t i = INT32_MIN, j = INT32_MIN;
  auto operator<=>(const Key&) const = default;
};

struct CellCloud {
  std::vector<Vec3> points;
  Vec3 beams = Vec3::Zero();  // Sum of the directions of the beams.
  size_t seen = 0, step = 1;

  void add(const Vec3& p, const Vec3& direction) {
    beams += direction;
    if (seen++ % step) return;
    points.push_back(p);
    if (points.size() < kMostPoints) return;
    for (size_t k = 0; 2 * k < points.size(); ++k) points[k] = points[2 * k];
    points.resize(points.size() / 2);
    step *= 2;
  }
};

double quantile_of(std::vector<double>& values, double q) {
  const auto at = values.begin() + std::lround(q * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Turns the object by multiples of `step_rad` until its beams come from y < 0 as far as they can.
/// Beams from above leave it as it is.
void turn_to_beams(const CellCloud& cloud, double step_rad, PlacedObject& o) {
  const Eigen::Vector2d along = cloud.beams.head<2>() / double(cloud.seen);
  if (along.norm() < kLeastSlant) return;
  const double heading = std::atan2(along.y(), along.x()) - M_PI_2;  // Beams go along y at this.
  o.yaw_rad += step_rad * std::round(std::remainder(heading - o.yaw_rad, 2 * M_PI) / step_rad);
  o.yaw_rad = std::remainder(o.yaw_rad, 2 * M_PI);
}

/// Measures where the points lie in the object's frame, to the millimetre as files keep it.
void measure_layers(const CellCloud& cloud, PlacedObject& o) {
  const Pose object_from_world = o.world_from_object().inverse();
  std::vector<Vec3> points;
  for (const Vec3& p : cloud.points) points.push_back(object_from_world * p);
  o.layers = layers_of(std::move(points));
}

PlacedObject measure_one(const CellCloud& cloud, double quantile) {
  PlacedObject o;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : cloud.points) sum += p;
  o.position = sum / double(cloud.points.size());
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  for (const Vec3& p : cloud.points) {
    const Eigen::Vector2d d = (p - o.position).head<2>();
    square += d * d.transpose();
  }
  const Eigen::Vector2d axis = spectrum(square).vectors.col(1);  // Axis of the larger eigenvalue.
  o.yaw_rad = std::atan2(axis.y(), axis.x());
  if (o.yaw_rad > M_PI_2) o.yaw_rad -= M_PI;  // An axis has no sign.
  if (o.yaw_rad <= -M_PI_2) o.yaw_rad += M_PI;
  turn_to_beams(cloud, M_PI, o);
  const Pose object_from_world = o.world_from_object().inverse();
  std::vector<double> values(cloud.points.size());
  for (int d = 0; d < 3; ++d) {
    for (size_t k = 0; k < values.size(); ++k) values[k] = (object_from_world * cloud.points[k])[d];
    o.box.min[d] = quantile_of(values, quantile);
    o.box.max[d] = quantile_of(values, 1 - quantile);
  }
  return o;
}

PlacedObject measure_cell(const CellCloud& cloud, const Key& key, double cell_m, double quantile) {
  PlacedObject o;
  std::vector<double> z;
  for (const Vec3& p : cloud.points) z.push_back(p.z());
  o.position = Vec3((key.i + 0.5) * cell_m, (key.j + 0.5) * cell_m, 0);
  o.box.min = Vec3(-0.5 * cell_m, -0.5 * cell_m, 0);
  o.box.max = Vec3(0.5 * cell_m, 0.5 * cell_m, quantile_of(z, 1 - quantile));
  turn_to_beams(cloud, M_PI_2, o);
  return o;
}

// Moves the object's foot onto the ground and extends its box down to it.
bool ground_it(const GroundSurface& ground, PlacedObject& o) {
  const std::optional<double> z = ground.at(o.position.x(), o.position.y());
  if (!z) return false;
  o.box.max.z() += o.position.z() - *z;
  o.box.min.z() = 0;
  o.position.z() = *z;
  return true;
}

/// A box has at least this height and width (m), even where the object lies below the ground.
constexpr double kLeastSide = 0.05;

}  // namespace

PointLayers layers_of(std::vector<Vec3> points) {
  constexpr size_t kLayers = PointLayers::kShares.size();
  require(!points.empty(), "layers: there are no points");
  // Points of the same height are in the order of x and y, so that theirs is of no consequence.
  std::ranges::sort(points, {}, [](const Vec3& p) { return std::tuple(p.z(), p.x(), p.y()); });
  PointLayers out;
  std::vector<double> values;
  for (size_t l = 0; l < kLayers; ++l) {
    const size_t begin = std::min(l * points.size() / kLayers, points.size() - 1);
    const size_t end = std::max(begin + 1, (l + 1) * points.size() / kLayers);
    const auto quantile = [&](int axis, double share) {
      values.clear();
      for (size_t k = begin; k < end; ++k) values.push_back(points[k][axis]);
      return as_written(quantile_of(values, share));
    };
    out.z[l] = quantile(2, 0.5);
    for (size_t q = 0; q < kLayers; ++q) {
      out.x[l][q] = quantile(0, PointLayers::kShares[q]);
      out.y[l][q] = quantile(1, PointLayers::kShares[q]);
    }
  }
  return out;
}

void for_each_object_hit(BeamSource& labelled, const std::function<void(const ObjectHit&)>& visit,
                         const MeasureProgress& progress) {
  size_t done = 0;
  labelled.rewind();
  for (BeamLog chunk; labelled.next(chunk);) {
    require(chunk.extra.count("class") && chunk.extra.count("instance") &&
                chunk.info.classes == "underbrush",
            "the log has no objects: it needs the columns class and instance that segment writes");
    const ExtraColumn& label = chunk.extra.at("class");
    const ExtraColumn& instance = chunk.extra.at("instance");
    for (size_t i = 0; i < chunk.size(); ++i) {
      const uint32_t number = whole_number(label, i);
      if (!chunk.is_hit(i) || number >= elements::kClassNames.size() ||
          elements::kind_of(Class(number)) == elements::ClassKind::kOther) {
        continue;
      }
      visit({chunk.end_point(i), chunk.direction[i].cast<double>(), Class(number),
             whole_number(instance, i)});
    }
    if (progress) progress(done += chunk.size(), labelled.size());
  }
}

void require_objects(const std::string& file, BeamSource& log) {
  log.rewind();
  BeamLog chunk;
  log.next(chunk);
  if (!chunk.extra.count("class") || !chunk.extra.count("instance") ||
      log.info().classes != "underbrush") {
    throw FormatError(
        file, "", "has no objects: it needs the columns class and instance that segment writes");
  }
}

MeasuredObjects measure_objects(BeamSource& labelled, const GroundSurface& ground,
                                const MeasureOptions& o, const MeasureProgress& progress) {
  require(o.quantile >= 0 && o.quantile < 0.5, "the quantile must lie in [0, 0.5)");
  require(o.cell_m > 0 && o.min_points > 0, "cells and numbers of points must be positive");
  MeasuredObjects out;
  std::map<Key, CellCloud> clouds;
  std::map<uint32_t, std::map<Class, size_t>> votes;
  const auto gather = [&](const ObjectHit& hit) {
    if (hit.instance == 0) {
      ++out.without_instance;
      return;
    }
    Key key{hit.instance};
    if (elements::kind_of(hit.label) == elements::ClassKind::kPatch) {
      key.i = cell_index(hit.point.x(), o.cell_m);
      key.j = cell_index(hit.point.y(), o.cell_m);
    }
    clouds[key].add(hit.point, hit.direction);
    ++votes[hit.instance][hit.label];
  };
  for_each_object_hit(labelled, gather, progress);
  for (const auto& [key, cloud] : clouds) {
    if (cloud.seen < o.min_points) {
      ++out.few_points;
      continue;
    }
    const bool cell = key.i != INT32_MIN;
    PlacedObject object =
        cell ? measure_cell(cloud, key, o.cell_m, o.quantile) : measure_one(cloud, o.quantile);
    // Most of the points of the right kind decide.
    size_t most = 0;
    for (const auto& [c, n] : votes[key.instance]) {
      if ((elements::kind_of(c) == elements::ClassKind::kPatch) == cell && n > most) {
        most = n;
        object.label = c;
      }
    }
    object.instance = key.instance;
    object.points = cloud.seen;
    if (!ground_it(ground, object)) {
      ++out.off_ground;
      continue;
    }
    measure_layers(cloud, object);
    for (int d = 0; d < 3; ++d) {
      if (object.box.size()[d] < kLeastSide) object.box.max[d] = object.box.min[d] + kLeastSide;
    }
    out.objects.push_back(object);
  }
  measure_beams(labelled, out.objects);
  return out;
}

}  // namespace underbrush::primitives
