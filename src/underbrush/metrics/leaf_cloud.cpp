#include "underbrush/metrics/leaf_cloud.hpp"

#include <algorithm>
#include <optional>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/ground/ground_flags.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::metrics {
namespace {

constexpr double kNearM = 3, kFarM = 25;

LeafCloud of_log(BeamSource& log, bool all) {
  const bool labelled = !all && !log.info().classes.empty();
  std::vector<uint8_t> ground;
  if (!all && !labelled) ground = ground::ground_flags(log, {});
  LeafCloud out{{}, all ? "all points" : labelled ? "labels" : "not ground", 0};
  std::optional<Vec3> origin;
  std::optional<uint32_t> first;
  size_t hit = 0;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    std::vector<double> label;
    if (labelled) label = io::doubles_of(chunk.extra.at("class"));
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i)) continue;
      if (!origin) origin = chunk.origin[i], first = chunk.scan[i];
      const size_t k = hit++;
      const double range = double(chunk.range_m[i]);
      if (!all && (range < kNearM || range > kFarM)) continue;
      if (labelled && !elements::is_vegetation(log.info().classes, uint32_t(label[i]))) continue;
      if (!ground.empty() && ground[k]) continue;
      out.points.push_back((chunk.end_point(i) - *origin).cast<float>());
      out.first_scan += chunk.scan[i] == *first;
    }
  }
  return out;
}

}  // namespace

std::vector<Vec3> points_of(const std::filesystem::path& file) {
  const io::Table table = io::read_table(file);
  std::vector<Vec3> out(table.size());
  for (int axis = 0; axis < 3; ++axis) {
    const ExtraColumn* column = table.find({std::string(1, char('x' + axis))});
    if (!column) throw FormatError(file.string(), "", "no column x, y or z");
    const std::vector<double> values = io::doubles_of(*column);
    for (size_t i = 0; i < out.size(); ++i) out[i][axis] = values[i];
  }
  std::erase_if(out, [](const Vec3& p) { return !p.allFinite(); });
  return out;
}

LeafCloud leaf_cloud(const std::filesystem::path& file, bool all) {
  const io::Input input = io::open_input(file.string());
  if (input.beams) return of_log(*input.beams, all);
  LeafCloud out{{}, "all points", 0};
  const std::vector<Vec3> points = points_of(file);
  out.points.reserve(points.size());
  for (const Vec3& p : points) {
    if (!p.isZero(0)) out.points.push_back((p - points[0]).cast<float>());
  }
  return out;
}

}  // namespace underbrush::metrics
