#include "score_protocols.hpp"

#include <fmt/format.h>

#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/metrics/range_image.hpp"
#include "underbrush/metrics/repeats.hpp"
#include "underbrush/pipeline/score_json.inl"

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
    for (const Scores& s : scores) text += fmt::format("{:>14.{}f}", s.*row.field, row.digits);
    text += "\n";
  }
  return text;
}

/// The logs that a protocol compares, and where the results go.
struct Compared {
  const std::filesystem::path &real, &train;
  const std::vector<Candidate>& candidates;
  Json& results;

  /// Calls `compare(real, simulated)` for each candidate and then for each baseline, and
  /// `note(result, entry)` with its entry in the results. Returns what `compare` returned.
  template <class Compare, class Note>
  auto each(const Compare& compare, const Note& note) const {
    std::vector<decltype(compare(std::declval<BeamSource&>(), std::declval<BeamSource&>()))> out;
    for (const Candidate& c : candidates) {
      io::BeamReader real_log(real), simulated(c.log);
      try {
        out.push_back(compare(real_log, simulated));
      } catch (const DataError& e) {
        throw FormatError(c.log.string(), "", e.what());
      }
      note(out.back(), results["models"][c.name]);
    }
    metrics::answer_by_baselines(
        opener(real), opener(train),
        [&](const std::string& name, BeamSource& truth, BeamSource& simulated) {
          out.push_back(compare(truth, simulated));
          note(out.back(), results["baselines"][name]);
        });
    return out;
  }
};

std::string score_images(const Compared& logs) {
  const std::vector<ProtocolScores> scores =
      logs.each([](BeamSource& a, BeamSource& b) { return metrics::range_image_scores(a, b); },
                [](const ProtocolScores& s, Json& entry) {
                  entry["kitti360"] = pipeline::json_of_range_images(s);
                });
  std::vector<ImageScores> means;
  means.reserve(scores.size());
  for (const ProtocolScores& s : scores) means.push_back(s.mean);
  return fmt::format(
             "kitti360: range images of 66 x 1030 pixels, 80 m; means of {} scans\n"
             "    (no beam points into {:.0f} % of the pixels, which count as dropped in both)\n",
             scores.at(0).scans, 100 * scores.at(0).empty_share) +
         text_of(kImageRows, means);
}

std::string score_repeats(const Compared& logs) {
  const std::vector<Repeats> scores = logs.each(
      [](BeamSource& a, BeamSource& b) { return metrics::repeats(a, b); },
      [](const Repeats& s, Json& entry) { entry["repeats"] = pipeline::json_of_repeats(s); });
  std::string text = fmt::format(
      "repeats: {} scans; median difference of a direction's range between successive scans, and\n"
      "    Bhattacharyya distance over ring x bearing x range bins of 0.2 degrees x 5 cm\n",
      scores.at(0).scans);
  if (!scores[0].repeat()) {
    text +=
        "  warning     the scans do not repeat: far ones differ more than twice as much as "
        "successive ones\n";
  }
  return text + text_of(kRepeatRows, scores);
}

}  // namespace

std::string score_protocols(const Protocols& asked, const std::filesystem::path& real,
                            const std::filesystem::path& train,
                            const std::vector<Candidate>& candidates, Json& results) {
  const Compared logs{real, train, candidates, results};
  std::string text;
  if (asked.kitti360) text += score_images(logs);
  if (asked.repeats) text += score_repeats(logs);
  return text;
}

}  // namespace underbrush::app
