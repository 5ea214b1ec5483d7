#include "underbrush/pipeline/fit_model.hpp"

#include <gtest/gtest.h>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "update/update_site.hpp"

namespace underbrush::pipeline {
namespace {

using Paths = std::vector<std::filesystem::path>;

/// A provenance that has names in place of hashes, and the files that were asked for.
struct Names {
  std::vector<Paths> asked;
  Provenance provenance() {
    return [this](const Paths& inputs) {
      asked.push_back(inputs);
      std::string text;
      for (const auto& input : inputs) {
        text += (text.empty() ? "" : ",") + ("\"" + input.string() + "\":\"") +
                input.filename().string() + "\"";
      }
      return "{\"inputs\":{" + text + "}}";
    };
  }
};

/// Two drives past the site of the tests of `update`, in files.
struct Drives {
  io::TemporaryFolder folder;
  std::filesystem::path first = folder / "first.ply", second = folder / "second.ply";
  BeamLog log;
  Drives() {
    io::write_log(first, update::drive(true, 1, 6000), "");
    io::write_log(second, update::drive(false, 2, 6000), "");
    log = io::read_log(first);
  }
};

FittedModel fitted(const std::filesystem::path& file, const fit::FitOptions& options,
                   Names& names) {
  const auto log = open_log(file, false);
  return fit_model({*log, {file}}, options, names.provenance());
}

TEST(FitModel, IsTheFitWithItsOrigin) {
  const Drives drives;
  Names names;
  const fit::FitOptions options = update::small_tiles();
  const FittedModel a = fitted(drives.first, options, names);
  const fit::FitResult b = update::fitted(drives.log, options);
  EXPECT_EQ(a.model.ellipsoids.size(), b.model.ellipsoids.size());
  EXPECT_EQ(a.model.ground.vertices, b.model.ground.vertices);
  ASSERT_EQ(names.asked, std::vector<Paths>{{drives.first}});
  EXPECT_NE(a.model.provenance.find("\"likelihood\""), std::string::npos);
  ASSERT_EQ(a.training.logs.size(), 1u);
  EXPECT_EQ(a.training.logs[0].hash, "first.ply");
  EXPECT_EQ(a.training.logs[0].beams, drives.log.size());
}

TEST(FitModel, ThatStartsFromAModelNamesItAmongItsInputs) {
  const Drives drives;
  Names names;
  fit::FitOptions options = update::small_tiles("hierarchical");
  write_trained(drives.folder / "start", fitted(drives.first, options, names));
  options.fitter = "likelihood";
  options.start = (drives.folder / "start").string();
  fitted(drives.first, options, names);
  EXPECT_EQ(names.asked.back(), (Paths{drives.first, options.start}));
}

TEST(UpdateModel, IsTheUpdateThroughAFolderOrInMemory) {
  const Drives drives;
  Names names;
  const fit::FitOptions options = update::small_tiles();
  const FittedModel first = fitted(drives.first, options, names);
  write_trained(drives.folder / "model", first);
  const BeamLog more = io::read_log(drives.second);
  const update::UpdateResult expected = update::updated(
      {first.model, {}, first.training.record, {}}, {&drives.log}, more, update::UpdateOptions());
  for (const TrainedModel& known : {TrainedModel(first), read_trained(drives.folder / "model")}) {
    const auto log = open_log(drives.second, false);
    const UpdatedModel grown = update_model(known, {*log, {drives.second}}, {}, names.provenance());
    EXPECT_EQ(grown.report.added, expected.report.added);
    EXPECT_EQ(grown.model.ground.vertices, expected.model.ground.vertices);
    ASSERT_EQ(grown.training.logs.size(), 2u);
    EXPECT_EQ(grown.training.logs[1].hash, "second.ply");
    Paths inputs{drives.first, drives.second};
    if (!known.folder.empty()) inputs.push_back(known.folder);
    EXPECT_EQ(names.asked.back(), inputs);
    EXPECT_THROW(update_model(grown, {*log, {drives.second}}, {}, names.provenance()), FormatError);
  }
}

TEST(UpdateModel, RefusesAModelOfALogThatIsInNoFile) {
  const Drives drives;
  Names names;
  MemorySource source(drives.log);
  const auto log = open_log(drives.second, false);
  const fit::FitOptions options = update::small_tiles("hierarchical");
  const FittedModel unnamed = fit_model({source}, options, names.provenance());
  EXPECT_TRUE(unnamed.training.logs.empty());
  EXPECT_THROW(update_model(unnamed, {*log, {drives.second}}, {}, names.provenance()), FormatError);
  write_trained(drives.folder / "model", unnamed);
  EXPECT_FALSE(fit::has_training(drives.folder / "model"));
  // Nor can a model be updated to which such a log was added.
  FittedModel known = fitted(drives.first, options, names);
  const BeamLog more = update::drive(true, 3, 2000);
  MemorySource added(more);
  EXPECT_TRUE(update_model(known, {added}, {}, names.provenance()).training.logs.empty());
}

TEST(FitModel, NamesTheFileOfALogThatItCannotUse) {
  const Drives drives;
  BeamLog misses = drives.log.like();
  misses.resize(4);
  io::write_log(drives.folder / "misses.ply", misses, "");
  Names names;
  EXPECT_THROW(fitted(drives.folder / "misses.ply", {}, names), FormatError);
  MemorySource source(misses);
  EXPECT_THROW(fit_model({source}, {}), DataError);
}

}  // namespace
}  // namespace underbrush::pipeline
