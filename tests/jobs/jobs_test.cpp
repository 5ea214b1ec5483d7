#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/jobs/job.hpp"
#include "underbrush/jobs/joined_logs.hpp"
#include "underbrush/jobs/plan.hpp"
#include "underbrush/jobs/scripts.hpp"

namespace underbrush::jobs {
namespace {

namespace fs = std::filesystem;

/// A folder for a test, removed at its end.
class Folder {
 public:
  Folder() : temporary_(fs::temp_directory_path(), "jobs") {
    make_temporary_folders(temporary_.path());
  }
  fs::path operator/(const std::string& name) const { return temporary_.path() / name; }

 private:
  TemporaryPath temporary_;
};

Job job_of(const std::string& text) {
  const Folder folder;
  std::ofstream(folder / "job.yaml") << text;
  return read_job(folder / "job.yaml");
}

TEST(Job, CommandsAreThoseOfAllCombinations) {
  const Job job = job_of(
      "command: [simulate, '{model}', --seed, '{seed}', -o, 'out of {model}-{seed}.ply']\n"
      "over: {seed: [1, 2], model: [a, b, c]}\npieces: 3\n");
  EXPECT_EQ(job.pieces, 3u);
  const auto commands = commands_of(job);
  ASSERT_EQ(commands.size(), 6u);
  std::set<std::string> outputs;
  for (const auto& words : commands) {
    ASSERT_EQ(words.size(), 6u);
    EXPECT_EQ(words[5], "out of " + words[1] + "-" + words[3] + ".ply");
    outputs.insert(words[5]);
  }
  EXPECT_EQ(outputs.size(), 6u);
  EXPECT_EQ(commands_of(job_of("command: info  log.ply\n")),
            (std::vector<std::vector<std::string>>{{"info", "log.ply"}}));
}

/// A log of rows with the echoes of their beams, whose intensity is the row's number.
BeamLog echoes_log(const std::vector<uint8_t>& echoes) {
  BeamLog log;
  log.extra[kEchoColumn] = std::vector<uint8_t>();
  log.resize(echoes.size());
  log.extra[kEchoColumn] = echoes;
  for (size_t i = 0; i < log.size(); ++i) log.range_m[i] = float(i + 1);
  return log;
}

TEST(JoinedLogs, TheFirstChunkHasTheBeamsOfTheWholeCommand) {
  const Folder folder;
  const std::vector<std::vector<uint8_t>> pieces = {{1, 2, 1}, {0, 1, 2, 3}, {1}, {1, 2}};
  std::vector<fs::path> files;
  std::vector<uint8_t> all;
  for (const auto& piece : pieces) {
    files.push_back(folder / (std::to_string(files.size()) + ".ublog"));
    io::write_log(files.back(), echoes_log(piece), "{}");
    all.insert(all.end(), piece.begin(), piece.end());
  }
  // The rows of the first n beams; there are six beams.
  const size_t rows[] = {2, 3, 4, 7, 8, 10, 10};
  for (size_t beams = 1; beams <= 7; ++beams) {
    JoinedLogs joined(files, beams);
    EXPECT_EQ(joined.size(), all.size());
    for (int pass = 0; pass < 2; ++pass) {
      joined.rewind();
      BeamLog chunk;
      ASSERT_TRUE(joined.next(chunk));
      EXPECT_EQ(chunk.size(), rows[beams - 1]) << beams;
      std::vector<uint8_t> read;
      do {
        const auto& part = std::get<std::vector<uint8_t>>(chunk.extra.at(kEchoColumn));
        read.insert(read.end(), part.begin(), part.end());
      } while (joined.next(chunk));
      EXPECT_EQ(read, all) << beams;
    }
  }
}

Plan small_plan() {
  Plan plan;
  plan.program = "underbrush 1.2.3";
  plan.inputs["a.ply"] = {"xxh3:" + std::string(32, '0'), 7};
  for (const size_t stage : {0, 0, 1, 0}) {
    plan.tasks.push_back(
        {stage, {"import", "a.ply"}, {"a.ply"}, {}, {{"-o", "b.ply"}}, 5, 1.5, 1 << 20});
  }
  plan.tasks[2].earlier = {{"--from", 1, 0}};
  plan.results.push_back({"b.ply", {1, 0}, 0, 3});
  return plan;
}

TEST(Plan, ComesBackFromItsFolder) {
  const Folder folder;
  write_plan(folder / "plan", small_plan());
  EXPECT_THROW(write_plan(folder / "plan", small_plan()), IoError);
  write_file(folder / "plan/outputs/made", "by a task");
  write_plan(folder / "plan", small_plan(), true);
  EXPECT_FALSE(std::filesystem::exists(folder / "plan/outputs/made"));
  const Plan read = read_plan(folder / "plan");
  write_plan(folder / "again", read);
  EXPECT_EQ(read_file(folder / "plan/plan.json"), read_file(folder / "again/plan.json"));
  EXPECT_EQ(read.tasks[2].stage, 1u);
  EXPECT_EQ(read.results[0].tasks, (std::vector<size_t>{1, 0}));
}

TEST(Plan, ReplacesNoFolderThatIsNone) {
  const Folder folder;
  std::filesystem::create_directory(folder / "years");
  write_file(folder / "years/thesis.tex", "of work");
  EXPECT_THROW(write_plan(folder / "years", small_plan(), true), IoError);
  EXPECT_TRUE(std::filesystem::exists(folder / "years/thesis.tex"));
}

TEST(Plan, ThatIsDamagedIsRefused) {
  const Folder folder;
  Plan plan = small_plan();
  const auto refused = [&](const std::string& name, const std::string& reason) {
    write_plan(folder / name, plan);
    try {
      read_plan(folder / name);
      ADD_FAILURE() << name;
    } catch (const FormatError& e) {
      EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
    }
    plan = small_plan();
  };
  plan.results[0].tasks = {4};
  refused("task", "no such task");
  plan.results[0].output = 1;
  refused("output", "no such output");
  plan.tasks[0].inputs = {"other.ply"};
  refused("input", "'other.ply'");
  plan.tasks[0].outputs[0].name = "../b.ply";
  refused("name", "not the name of a file");
  plan.tasks[1].earlier = {{"--from", 0, 0}};
  refused("earlier", "no task of an earlier stage");
}

TEST(Scripts, StagesFollowEachOther) {
  const std::string slurm = slurm_script("p", small_plan());
  const size_t first = slurm.find("--array=0-1,3 "), second = slurm.find("--array=2 ");
  EXPECT_LT(first, second);
  EXPECT_LT(second, slurm.find("merge 'p'"));
  const std::string make = makefile("p", small_plan());
  EXPECT_NE(make.find("p/records/2.json: | p/records/1.json\n"), std::string::npos);
  EXPECT_THROW(makefile("a b", small_plan()), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::jobs
