#include <algorithm>
#include <cmath>

#include "underbrush/core/linear.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/ply.hpp"

namespace underbrush::elements {

void write_splat(const std::filesystem::path& path, const Model& model) {
  // Column names and encodings are those of the original 3-D Gaussian splatting (Kerbl et al.
  // 2023).
  static constexpr const char* kNames[] = {
      "x",       "y",       "z",       "nx",      "ny",    "nz",    "f_dc_0", "f_dc_1", "f_dc_2",
      "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2",  "rot_3"};
  std::vector<std::vector<float>> column(std::size(kNames));
  for (const Ellipsoid& e : model.ellipsoids) {
    auto [variances, axes] = quick_spectrum(e.covariance_matrix());
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    const Eigen::Quaterniond q(axes);
    const float p = std::clamp(e.hit.p, 0.01f, 0.99f);
    // The divisor is the constant spherical harmonic.
    const float colour = (p - 0.5f) / 0.28209479f;
    const float values[] = {e.mean.x(),
                            e.mean.y(),
                            e.mean.z(),
                            0,
                            0,
                            0,
                            -colour,
                            colour,
                            -colour,
                            std::log(p / (1 - p)),
                            float(0.5 * std::log(variances[0])),
                            float(0.5 * std::log(variances[1])),
                            float(0.5 * std::log(variances[2])),
                            float(q.w()),
                            float(q.x()),
                            float(q.y()),
                            float(q.z())};
    for (size_t k = 0; k < column.size(); ++k) column[k].push_back(values[k]);
  }
  io::PlyElement element;
  element.name = "vertex";
  element.count = model.ellipsoids.size();
  for (size_t k = 0; k < column.size(); ++k) {
    element.columns.emplace_back(kNames[k], std::move(column[k]));
  }
  io::PlyData data;
  data.elements = {std::move(element)};
  data.comments = {"Underbrush"};
  io::write_ply(path, data);
}

}  // namespace underbrush::elements
