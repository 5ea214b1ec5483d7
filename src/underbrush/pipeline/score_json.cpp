#include "underbrush/pipeline/score_json.inl"

#include <nlohmann/json.hpp>

#include "underbrush/io/json_text.inl"

namespace underbrush::pipeline {
namespace {

using Json = nlohmann::ordered_json;

// Scores that were not asked for have no key.
Json json_of(const metrics::Summary& s, const metrics::Score& all) {
  Json j = {{"beams", s.beams},
            {"true_hits", s.true_hits},
            {"false_hits", s.false_hits},
            {"false_misses", s.false_misses},
            {"true_misses", s.true_misses},
            {"recall_of_misses", io::finite_or_null(s.recall_of_misses)},
            {"precision_of_misses", io::finite_or_null(s.precision_of_misses)},
            {"f1_of_misses", io::finite_or_null(s.f1_of_misses)},
            {"informedness", io::finite_or_null(s.informedness)},
            {"capped_error_m", io::finite_or_null(s.capped_error_m)},
            {"packet_error_m", io::finite_or_null(s.packet_error_m)},
            {"precision", io::finite_or_null(s.precision)},
            {"recall", io::finite_or_null(s.recall)},
            {"f1", io::finite_or_null(s.f1)},
            {"median_range_error_m", io::finite_or_null(s.median_range_error_m)}};
  if (all.cloud) {
    j["cloud_error_m"] = io::finite_or_null(s.cloud_error_m);
    j["density_aware_chamfer"] = io::finite_or_null(s.density_aware_chamfer);
  }
  if (all.likelihood) {
    j["nll_per_beam"] = io::finite_or_null(s.nll_per_beam);
    j["crps_m"] = io::finite_or_null(s.crps_m);
  }
  return j;
}

Json json_of(const metrics::Reliability& r) {
  Json bins = Json::array();
  for (size_t k = 0; k < r.bins().size(); ++k) {
    const metrics::Reliability::Bin& b = r.bins()[k];
    if (b.beams == 0) continue;
    const double n = double(b.beams);
    bins.push_back({{"from", double(k) / double(r.kBins)},
                    {"to", double(k + 1) / double(r.kBins)},
                    {"beams", b.beams},
                    {"predicted", b.predicted / n},
                    {"returned", double(b.returns) / n}});
  }
  return {{"error", io::finite_or_null(r.error())},
          {"bias", io::finite_or_null(r.bias())},
          {"bins", std::move(bins)}};
}

Json json_of(const metrics::IntensityErrors& e) {
  return {{"beams", e.beams},
          {"rmse", io::finite_or_null(e.rmse)},
          {"mae", io::finite_or_null(e.mae)},
          {"correlation", io::finite_or_null(e.correlation)}};
}

Json json_of(const metrics::IntensityScore& s) {
  Json j = json_of(s.simulated);
  j["constant"] = json_of(s.constant);
  if (!s.groups.empty()) {
    j["constant_of_" + s.groups] = json_of(s.group_constant);
  }
  j["real_mean"] = s.real_mean;
  j["real_sd"] = s.real_sd;
  j["simulated_mean"] = s.simulated_mean;
  j["simulated_sd"] = s.simulated_sd;
  j["wasserstein"] = s.wasserstein;
  j["per_range"] = Json::object();
  for (const auto& [name, errors] : s.per_range) j["per_range"][name] = json_of(errors);
  if (!s.per_incidence.empty()) {
    for (const auto& [name, errors] : s.per_incidence) j["per_incidence"][name] = json_of(errors);
  }
  return j;
}

Json json_of(const metrics::Score& s) {
  Json j = json_of(s.all, s);
  if (s.likelihood) j["reliability"] = json_of(s.reliability);
  j["roughness_m"] = io::finite_or_null(s.roughness_m);
  j["roughness_real_m"] = io::finite_or_null(s.real_roughness_m);
  if (s.intensity) j["intensity"] = json_of(*s.intensity);
  if (s.mover_beams > 0) j["mover_beams"] = s.mover_beams;
  j["per_class"] = Json::object();
  for (const auto& [name, part] : s.per_class) j["per_class"][name] = json_of(part, s);
  j["per_range"] = Json::object();
  for (const auto& [name, part] : s.per_range) j["per_range"][name] = json_of(part, s);
  if (!s.per_support.empty()) {
    for (const auto& [name, part] : s.per_support) j["per_support"][name] = json_of(part, s);
  }
  j["range_error_histogram"] = {{"from_m", -metrics::RangeErrorHistogram::kHalfWidth},
                                {"to_m", metrics::RangeErrorHistogram::kHalfWidth},
                                {"bin_m", metrics::RangeErrorHistogram::kBin},
                                {"below_bins_above", s.range_error.count}};
  return j;
}

Json json_of(const metrics::LengthDistribution& d) {
  return {{"distance_m", io::finite_or_null(d.distance_m)},
          {"first_m", d.first_m},
          {"bin_m", d.bin_m},
          {"real_share", d.share[0]},
          {"share", d.share[1]}};
}

Json json_of_range_images(const metrics::ProtocolScores& scores) {
  const metrics::ImageScores& s = scores.mean;
  return {{"scans", scores.scans},
          {"empty_share", scores.empty_share},
          {"chamfer_m2", io::finite_or_null(s.chamfer_m2)},
          {"f_score", io::finite_or_null(s.f_score)},
          {"depth_rmse_m", io::finite_or_null(s.depth_rmse_m)},
          {"depth_median_m", io::finite_or_null(s.depth_median_m)},
          {"depth_ssim", io::finite_or_null(s.depth_ssim)},
          {"depth_psnr", io::finite_or_null(s.depth_psnr)},
          {"intensity_rmse", io::finite_or_null(s.intensity_rmse)},
          {"drop_rmse", io::finite_or_null(s.drop_rmse)},
          {"drop_accuracy", io::finite_or_null(s.drop_accuracy)},
          {"drop_f1", io::finite_or_null(s.drop_f1)}};
}

Json json_of_repeats(const metrics::Repeats& s) {
  return {{"scans", s.scans},
          {"directions", s.directions},
          {"repeat", s.repeat()},
          {"real_difference_m", io::finite_or_null(s.real_difference_m)},
          {"difference_m", io::finite_or_null(s.difference_m)},
          {"real_far_difference_m", io::finite_or_null(s.real_far_difference_m)},
          {"far_difference_m", io::finite_or_null(s.far_difference_m)},
          {"distance", io::finite_or_null(s.distance)},
          {"floor", io::finite_or_null(s.floor)},
          {"same_scans", io::finite_or_null(s.same_scans)}};
}

}  // namespace

Json json_of_cloud_scores(const metrics::CloudScores& s) {
  Json j = {{"real_beams", s.beams[0]},
            {"beams", s.beams[1]},
            {"real_points", s.points[0]},
            {"points", s.points[1]},
            {"real_returns", s.returns[0]},
            {"returns", s.returns[1]},
            {"cloud_error_m", io::finite_or_null(s.cloud_error_m)},
            {"real_to_simulated_m", io::finite_or_null(s.nearest_m[0])},
            {"simulated_to_real_m", io::finite_or_null(s.nearest_m[1])},
            {"density_aware_chamfer", io::finite_or_null(s.density_aware_chamfer)},
            {"occupied", io::finite_or_null(s.occupied)},
            {"range", json_of(s.range)},
            {"height", json_of(s.height)}};
  j["regions"] = Json::array();
  for (const metrics::CloudRegion& r : s.regions) {
    j["regions"].push_back({{"x_m", metrics::CloudScores::kRegionM * r.at.x},
                            {"y_m", metrics::CloudScores::kRegionM * r.at.y},
                            {"real_points", r.points[0]},
                            {"points", r.points[1]},
                            {"cloud_error_m", r.cloud_error_m},
                            {"error_share", r.error_share},
                            {"height_distance_m", io::finite_or_null(r.height_distance_m)}});
  }
  return j;
}

Json json_of_clouds(const std::vector<metrics::NamedCloudScores>& clouds,
                    const std::string& provenance) {
  Json j = json_of_cloud_scores(clouds.at(0).scores);
  j["models"] = Json::object();
  for (const metrics::NamedCloudScores& c : clouds) {
    j["models"][c.name] = json_of_cloud_scores(c.scores);
  }
  j["provenance"] = io::json_of_text(provenance);
  return j;
}

Json json_of_log_score(const LogScore& s) {
  Json j = json_of(s.score);
  if (s.kitti360) j["kitti360"] = json_of_range_images(*s.kitti360);
  if (s.repeats) j["repeats"] = json_of_repeats(*s.repeats);
  return j;
}

Json json_of_scores(const Scores& scores, const std::string& provenance) {
  Json j = json_of(scores.simulated.at(0).score);
  j["models"] = Json::object();
  for (const LogScore& s : scores.simulated) j["models"][s.name] = json_of_log_score(s);
  if (!scores.baselines.empty()) j["baselines"] = Json::object();
  for (const LogScore& s : scores.baselines) j["baselines"][s.name] = json_of_log_score(s);
  j["provenance"] = io::json_of_text(provenance);
  return j;
}

}  // namespace underbrush::pipeline
