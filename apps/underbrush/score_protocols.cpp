#include "score_protocols.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <vector>

namespace underbrush::app {
namespace {

using metrics::ImageScores;
using metrics::ProtocolScores;
using metrics::Repeats;

/// A score of a protocol: its name and its digits in the text.
template <class Scores>
struct Row {
  const char* name;
  double Scores::*field;
  int digits;
};

constexpr Row<ImageScores> kImageRows[] = {{"Chamfer distance, m²", &ImageScores::chamfer_m2, 4},
                                           {"F score", &ImageScores::f_score, 4},
                                           {"depth RMSE, m", &ImageScores::depth_rmse_m, 3},
                                           {"depth MedAE, m", &ImageScores::depth_median_m, 4},
                                           {"depth SSIM", &ImageScores::depth_ssim, 4},
                                           {"depth PSNR, dB", &ImageScores::depth_psnr, 2},
                                           {"intensity RMSE", &ImageScores::intensity_rmse, 4},
                                           {"ray-drop RMSE", &ImageScores::drop_rmse, 4},
                                           {"ray-drop accuracy", &ImageScores::drop_accuracy, 4},
                                           {"ray-drop F1", &ImageScores::drop_f1, 4}};

constexpr Row<Repeats> kRepeatRows[] = {
    {"real difference, m", &Repeats::real_difference_m, 4},
    {"simulated difference, m", &Repeats::difference_m, 4},
    {"real, half a log apart", &Repeats::real_far_difference_m, 4},
    {"simulated, the same", &Repeats::far_difference_m, 4},
    {"distance", &Repeats::distance, 4},
    {"scan against scan", &Repeats::floor, 4},
    {"distance, same scans", &Repeats::same_scans, 4}};

template <class Scores, size_t n>
std::string text_of(const Row<Scores> (&rows)[n], const std::vector<Scores>& scores) {
  std::string text;
  for (const Row<Scores>& row : rows) {
    text += fmt::format("  {:<24}", row.name);
    for (const Scores& s : scores) {
      const double x = s.*row.field;
      text += std::isfinite(x) ? fmt::format("{:>14.{}f}", x, row.digits)
                               : fmt::format("{:>14}", "n/a");
    }
    text += "\n";
  }
  return text;
}

/// The scores that each log and baseline has of one protocol.
template <class Scores>
std::vector<Scores> each(const pipeline::Scores& scores,
                         std::optional<Scores> pipeline::LogScore::*protocol) {
  std::vector<Scores> out;
  for (const auto* part : {&scores.simulated, &scores.baselines}) {
    for (const pipeline::LogScore& s : *part) {
      if (s.*protocol) out.push_back(*(s.*protocol));
    }
  }
  return out;
}

std::string text_of_images(const std::vector<ProtocolScores>& scores) {
  std::vector<ImageScores> means;
  means.reserve(scores.size());
  for (const ProtocolScores& s : scores) means.push_back(s.mean);
  return fmt::format(
             "kitti360: range images of 66 x 1030 pixels, 80 m; means of {} scans\n"
             "    (no beam points into {:.0f} % of the pixels, which count as dropped in both)\n",
             scores.at(0).scans, 100 * scores.at(0).empty_share) +
         text_of(kImageRows, means);
}

std::string text_of_repeats(const std::vector<Repeats>& scores) {
  std::string text = fmt::format(
      "repeats: {} scans; median difference of a direction's range between successive scans, and\n"
      "    Bhattacharyya distance over ring x bearing x range bins of 0.2 degrees x 5 cm\n",
      scores.at(0).scans);
  if (scores[0].scans < 2) {
    text += "  warning     the log has one scan, and this needs several\n";
  } else if (!scores[0].repeat()) {
    text +=
        "  warning     the scans do not repeat: far ones differ more than twice as much as "
        "successive ones\n";
  }
  return text + text_of(kRepeatRows, scores);
}

}  // namespace

std::string text_of_protocols(const pipeline::Scores& scores) {
  std::string text;
  const auto images = each(scores, &pipeline::LogScore::kitti360);
  if (!images.empty()) text += text_of_images(images);
  const auto repeats = each(scores, &pipeline::LogScore::repeats);
  if (!repeats.empty()) text += text_of_repeats(repeats);
  return text;
}

}  // namespace underbrush::app
