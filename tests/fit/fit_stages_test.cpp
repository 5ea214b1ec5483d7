// Tests of fits in stages: whatever the parts of the log, the model is that of one fit, to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "fit/two_bushes.hpp"
#include "underbrush/core/beam_window.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/fit/stage_files.hpp"
#include "underbrush/io/hash.hpp"

namespace underbrush::fit {
namespace {

namespace fs = std::filesystem;

std::string hash_of_model(const fs::path& folder, const elements::Model& model) {
  elements::write_model(folder, model);
  return io::hash_of(folder);
}

/// Fits in stages, each of which knows the others by their files alone, with the sums of so many
/// parts of the log, in another order each time.
FitResult fit_in_stages(BeamSource& log, const FitOptions& options, size_t parts,
                        const fs::path& folder) {
  const FitStart made = begin_fit(log, options);
  write_start(folder / "start", made, begin_refinement(made, log.info(), options), options);
  fs::path latest = folder / "start";
  for (int round = 0; round < options.likelihood.rounds; ++round) {
    std::vector<fs::path> files;
    for (size_t k = 0; k < parts; ++k) {
      BeamWindow rows(log, log.size() * k / parts, log.size() * (k + 1) / parts);
      files.push_back(folder / (std::to_string(round) + "-" + std::to_string(k)));
      write_sums(files.back(), sum_of_rows(rows, read_refinement(latest), options));
    }
    std::rotate(files.begin(), files.begin() + round % int(parts), files.end());
    likelihood::Refinement r = read_refinement(latest);
    likelihood::PassSums sums{likelihood::ElementSums(r.best->model), {}, 0};
    for (const fs::path& file : files) add_sums(file, sums);
    take_step(r, std::move(sums), read_start(folder / "start"), log.info(), options);
    latest = folder / ("step" + std::to_string(round));
    write_refinement(latest, r);
  }
  return end_fit(log, read_start(folder / "start"), read_refinement(latest), options);
}

TEST(FitStages, GiveTheModelOfOneFit) {
  const TemporaryPath temporary(fs::temp_directory_path(), "fit_stages");
  const BeamLog beams = test::drive_past_two_bushes(21, Vec3(100, 20, 3), 20000);
  MemorySource log(beams, 3000);
  FitOptions options;
  options.likelihood.rounds = 3;
  const FitResult whole = fit(log, options);
  make_temporary_folders(temporary.path());
  const std::string expected = hash_of_model(temporary.path() / "whole", whole.model);
  EXPECT_NE(whole.model.ellipsoids.size(), 0u);
  for (const size_t parts : {1, 4}) {
    const fs::path folder = temporary.path() / std::to_string(parts);
    make_temporary_folders(folder);
    const FitResult cut = fit_in_stages(log, options, parts, folder);
    EXPECT_EQ(hash_of_model(folder / "model", cut.model), expected);
    EXPECT_EQ(cut.report.hits, whole.report.hits);
    EXPECT_EQ(cut.report.ground_points, whole.report.ground_points);
    EXPECT_EQ(cut.report.likelihood.steps.size(), whole.report.likelihood.steps.size());
    EXPECT_EQ(cut.report.warnings, whole.report.warnings);
    ASSERT_EQ(cut.record.tiles.size(), whole.record.tiles.size());
    EXPECT_EQ(cut.record.residuals, whole.record.residuals);
  }
}

// The start finds the noise of a sensor that stands, and the space between its beams; the later
// stages know both from its files.
TEST(FitStages, KnowWhatTheStartFound) {
  const TemporaryPath temporary(fs::temp_directory_path(), "fit_stages");
  make_temporary_folders(temporary.path());
  Stream random(37);
  BeamLog beams;
  beams.info.has_misses = true;
  for (uint32_t scan = 0; scan < 4; ++scan) {
    beams.info.scans.push_back({scan, 0.1 * scan, {}});
    for (int k = 0; k < 4000; ++k) {
      const Vec3 to = 10 * Vec3(0.001 * (k % 400) - 0.2, 1, 0.02 * (1 + k / 400));
      const size_t i = beams.size();
      beams.resize(i + 1);
      beams.direction[i] = to.normalized().cast<float>();
      beams.range_m[i] = float(to.norm() + 0.005 * random.normal());
      beams.ring[i] = uint16_t(k / 400);
      beams.scan[i] = scan;
      beams.time_s[i] = 0.1 * scan;
    }
  }
  MemorySource log(beams, 3000);
  FitOptions options;
  options.likelihood.rounds = 2;
  options.segment.method = "none";
  const FitResult whole = fit(log, options), cut = fit_in_stages(log, options, 2, temporary.path());
  EXPECT_LT(whole.report.range_noise_m, 0.006);
  EXPECT_EQ(cut.report.range_noise_m, whole.report.range_noise_m);
  EXPECT_EQ(hash_of_model(temporary.path() / "cut", cut.model),
            hash_of_model(temporary.path() / "whole", whole.model));
  const FitStart start = read_start(temporary.path() / "start");
  ASSERT_EQ(start.fitted.open.size(), start.fitted.model.ellipsoids.size());
  EXPECT_GT(start.fitted.open.at(0)(2, 2), std::pow(0.05, 2));  // 20 cm between the rings
  const fs::path open = temporary.path() / "start" / "open.bin";
  fs::resize_file(open, fs::file_size(open) - sizeof(Eigen::Matrix3f));
  EXPECT_THROW(read_start(temporary.path() / "start"), FormatError);
}

TEST(FitStages, NumbersThatMakeNoSenseAreRefused) {
  const TemporaryPath temporary(fs::temp_directory_path(), "fit_stages");
  const fs::path folder = temporary.path() / "start";
  make_temporary_folders(temporary.path());
  const BeamLog beams = test::drive_past_two_bushes(24, Vec3::Zero(), 3000);
  MemorySource log(beams);
  FitOptions options;
  FitStart made = begin_fit(log, options);
  const likelihood::Refinement r = begin_refinement(made, log.info(), options);
  made.fitted.open.resize(made.fitted.model.ellipsoids.size());
  const auto is_read = [&] {
    fs::remove_all(folder);
    write_start(folder, made, r, options);
    try {
      read_start(folder);
    } catch (const FormatError&) {
      return false;
    }
    return true;
  };
  EXPECT_TRUE(is_read());
  likelihood::ListedBeam& beam = made.held_out.at(0);
  for (float* value : {&beam.origin[0], &beam.range_m, &beam.direction[2], &beam.reach_m}) {
    const float good = std::exchange(*value, NAN);
    EXPECT_FALSE(is_read());
    *value = good;
  }
  for (const float lie : {NAN, 1e30f}) {
    made.fitted.open.at(0)(1, 2) = lie;
    EXPECT_FALSE(is_read());
    made.fitted.open.at(0)(1, 2) = 0;
  }
  made.fitted.report.range_noise_m = -1;
  EXPECT_FALSE(is_read());
}

TEST(FitStages, DamagedSumsAreNamed) {
  const TemporaryPath temporary(fs::temp_directory_path(), "fit_stages");
  make_temporary_folders(temporary.path());
  const BeamLog beams = test::drive_past_two_bushes(22, Vec3::Zero(), 3000);
  MemorySource log(beams);
  FitOptions options;
  const FitStart start = begin_fit(log, options);
  const likelihood::Refinement r = begin_refinement(start, log.info(), options);
  const fs::path file = temporary.path() / "sums";
  write_sums(file, sum_of_rows(log, r, options));
  const auto read = [&](const elements::Model& model) {
    likelihood::PassSums sums{likelihood::ElementSums(model), {}, 0};
    add_sums(file, sums);
    return sums.beams;
  };
  EXPECT_EQ(read(r.best->model), start.training_beams);
  elements::Model fewer = r.best->model;
  fewer.ellipsoids.pop_back();
  EXPECT_THROW(read(fewer), FormatError);
  for (const double share : {0.0, 0.01, 0.5, 0.99}) {
    const std::string bytes = read_file(file);
    fs::remove(file);
    write_file(file, bytes.substr(0, size_t(share * double(bytes.size()))));
    EXPECT_THROW(read(r.best->model), FormatError);
    fs::remove(file);
    write_file(file, bytes);
  }
}

TEST(FitStages, AreOfFitsByLikelihoodAlone) {
  const BeamLog beams = test::drive_past_two_bushes(23, Vec3::Zero(), 1000);
  MemorySource log(beams);
  FitOptions options;
  options.fitter = "surface";
  EXPECT_THROW(begin_fit(log, options), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::fit
