#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/page.hpp"
#include "report/pictures.hpp"
#include "report/svg_plot.hpp"
#include "studies/primitives.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/primitives/thumbnail.hpp"

namespace underbrush::studies {
namespace {

constexpr int kThumbnail = 96, kThumbnails = 6, kMapPixels = 420;
constexpr double kMapM = 60, kSliceM = 0.25, kAroundM = 4;
constexpr size_t kMostLines = 4000;

std::string figure(const io::Image& image, const std::string& caption) {
  return fmt::format("<figure><img src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
                     report::data_url(image), report::escaped(caption), report::escaped(caption));
}

/// Shows a few primitives of each class, as Fig. 8 does.
std::string examples(const Composed& c) {
  std::string html =
      fmt::format("<h3>Primitives: {}</h3>\n<div class=\"pictures\">\n", report::escaped(c.name));
  std::map<elements::Class, std::vector<size_t>> by_class;
  for (size_t k = 0; k < c.set->entries.size(); ++k) {
    by_class[c.set->entries[k].label].push_back(k);
  }
  for (const auto& [label, entries] : by_class) {
    const size_t n = std::min<size_t>(kThumbnails, entries.size());
    for (size_t k = 0; k < n; ++k) {
      const size_t e = entries[k * entries.size() / n];
      primitives::Primitive p;
      p.label = label;
      p.box = c.set->entries[e].box;
      p.model = primitives::read_primitive(*c.set, e);
      const double metres = std::max({p.box.max.z(), 2 * p.box.max.x(), -2 * p.box.min.x(), 0.1});
      html += figure(primitives::thumbnail(p, kThumbnail, metres), c.set->entries[e].name);
    }
  }
  return html + "</div>\n";
}

/// Shows from above what was measured or simulated around the middle of the drive, as Fig. 9 does.
std::string map_of(const BeamLog& log, const std::string& name) {
  report::TopView view;
  view.metres_per_pixel = kMapM / kMapPixels;
  view.width = view.height = kMapPixels;
  const Vec3 middle = log.origin[log.size() / 2];
  view.corner = middle + Vec3(-0.5 * kMapM, 0.5 * kMapM, 0);
  report::TopPicture picture(view);
  for (size_t i = 0; i < log.size(); ++i) {
    if (!log.is_hit(i)) continue;
    const Vec3 p = log.end_point(i);
    picture.add(p, report::scale_colour((p.z() - middle.z() + 3) / 8));
  }
  return figure(picture.closed().image(), name);
}

/// The vertical plane through a beam. From the beam's origin, x runs along the beam as seen from
/// above, and y up.
struct Slice {
  Vec3 origin, along, across;
  double from = 0, to = 0, low = 0, high = 0;
  std::pair<double, double> at(const Vec3& p) const {
    return {along.dot(p - origin), p.z() - origin.z()};
  }
  bool shows(const Vec3& p, double reach) const {
    const auto [x, z] = at(p);
    return std::abs(across.dot(p - origin)) <= kSliceM + reach && x > from - reach &&
           x < to + reach && z > low - reach && z < high + reach;
  }
};

void draw(const Slice& slice, const elements::Model& model, const elements::Instance& at,
          size_t& lines, report::SvgPlot& svg) {
  const Mat3 turn = at.world_from_model.rotation.toRotationMatrix();
  const auto world = [&](const Vec3f& p) {
    return Vec3(at.world_from_model.translation + double(at.scale) * (turn * p.cast<double>()));
  };
  for (const elements::Ellipsoid& e : model.ellipsoids) {
    const Vec3 mean = world(e.mean);
    if (!slice.shows(mean, 0.3) || lines++ > kMostLines) continue;
    const Mat3 sigma =
        double(at.scale * at.scale) * turn * e.covariance_matrix() * turn.transpose();
    Eigen::Matrix<double, 2, 3> flat;
    flat << slice.along.transpose(), Vec3::UnitZ().transpose();
    const Spectrum<2> axes = spectrum(Eigen::Matrix2d(flat * sigma * flat.transpose()));
    report::SvgPlot::Points outline;
    const auto [x, z] = slice.at(mean);
    for (int k = 0; k <= 16; ++k) {
      const double a = 2 * M_PI * k / 16;
      const Eigen::Vector2d d =
          axes.vectors * (2 * axes.values.cwiseMax(0).cwiseSqrt().cwiseProduct(
                                  Eigen::Vector2d(std::cos(a), std::sin(a))));
      outline.emplace_back(x + d.x(), z + d.y());
    }
    svg.line(outline, "#5a5");
  }
  for (const auto* mesh : {&model.ground, &model.surface}) {
    for (const auto& t : mesh->triangles) {
      const Vec3 a = world(mesh->vertices[t[0]]);
      const Vec3 b = world(mesh->vertices[t[1]]), c = world(mesh->vertices[t[2]]);
      if (!slice.shows((a + b + c) / 3, 0.1) || lines++ > kMostLines) continue;
      svg.line({slice.at(a), slice.at(b), slice.at(c), slice.at(a)},
               mesh == &model.ground ? "#a86" : "#5a5");
    }
  }
}

/// Shows one beam, its measurement and the result of each simulator, as Fig. 10 does.
std::string ray_figure(const BeamLog& real, size_t beam, const std::string& what,
                       std::span<const Composed> composed) {
  Slice s;
  s.origin = real.origin[beam];
  const Vec3 d = real.direction[beam].cast<double>();
  s.along = Vec3(d.x(), d.y(), 0).normalized();
  s.across = Vec3(-s.along.y(), s.along.x(), 0);
  const Vec3 point = real.end_point(beam);
  const auto [x, z] = s.at(point);
  s.from = x - kAroundM, s.to = x + kAroundM, s.low = z - 0.6 * kAroundM,
  s.high = z + 0.6 * kAroundM;
  std::string html = fmt::format("<h3>{}</h3>\n<div class=\"pictures\">\n", report::escaped(what));
  for (const Composed& c : composed) {
    report::SvgPlot svg(c.name, "along the beam, m", "above the sensor, m");
    svg.x_axis(s.from, s.to);
    svg.y_axis(s.low, s.high);
    size_t lines = 0;
    for (const elements::Instance& instance : c.scene->instances) {
      const elements::Model& model = c.scene->models[instance.model];
      const bool ground = model.ground.size() > 0;
      if (!ground && (instance.world_from_model.translation - point).head<2>().norm() > 15)
        continue;
      draw(s, model, instance, lines, svg);
    }
    const double slope = d.z() / std::max(d.head<2>().norm(), 1e-6);
    svg.line({{s.from, s.from * slope}, {x, z}}, "#27c", true);
    svg.dots({{x, z}}, "#27c", 9);
    std::string caption = fmt::format("measured {:.2f} m (blue), ", real.range_m[beam]);
    if (c.log->is_hit(beam)) {
      const auto [sx, sz] = s.at(c.log->end_point(beam));
      if (sx > s.from && sx < s.to) svg.dots({{sx, sz}}, "#c22", 7);
      caption += fmt::format("simulated {:.2f} m (red)", c.log->range_m[beam]);
    } else {
      caption += "simulated: no return";
    }
    html += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", svg.svg(),
                        report::escaped(caption));
  }
  return html + "</div>\n";
}

}  // namespace

std::string primitive_pictures(const std::string& name, const BeamLog& test,
                               std::span<const Composed> composed) {
  std::string html = fmt::format("<h2>{}</h2>\n", report::escaped(name));
  for (const Composed& c : composed) html += examples(c);
  html += "<h3>From above: measured and simulated returns</h3>\n<div class=\"pictures\">\n" +
          map_of(test, "measured");
  for (const Composed& c : composed) html += map_of(*c.log, c.name);
  html += "</div>\n";
  // The beams resemble the paper's four examples and are searched in an order that a hash of their
  // number gives.
  const BeamLog &own = *composed[0].log, &mesh = *composed[1].log;
  const auto off = [&](const BeamLog& log, size_t i) {
    return double(log.range_m[i]) - double(test.range_m[i]);
  };
  const std::pair<const char*, std::function<bool(size_t)>> kinds[] = {
      {"Primitives near, the mesh scene too far",
       [&](size_t i) { return std::abs(off(own, i)) < 0.2 && off(mesh, i) > 2 && mesh.is_hit(i); }},
      {"Primitives near, the mesh scene too short",
       [&](size_t i) { return std::abs(off(own, i)) < 0.2 && off(mesh, i) < -1; }},
      {"Primitives near, the mesh scene without a return",
       [&](size_t i) { return std::abs(off(own, i)) < 0.2 && !mesh.is_hit(i); }},
      {"Primitives off, the mesh scene near",
       [&](size_t i) { return std::abs(off(own, i)) > 1 && std::abs(off(mesh, i)) < 0.2; }}};
  html +=
      "<p class=\"caption\">Single beams, chosen as the paper's Fig. 10: three where the "
      "primitives do better and one where they do worse. A slice of ±0.25 m about the beam: "
      "ellipsoids at two standard deviations, triangles, the ground in brown.</p>\n";
  for (const auto& [what, wanted] : kinds) {
    for (size_t k = 0; k < 200000; ++k) {
      const size_t i = mix64(k) % test.size();
      if (!test.is_hit(i) || test.range_m[i] < 4 || !wanted(i)) continue;
      html += ray_figure(test, i, what, composed);
      break;
    }
  }
  return html;
}

}  // namespace underbrush::studies
