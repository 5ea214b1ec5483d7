#include <fmt/format.h>

#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/split_log.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace split_verb {

struct Arguments {
  std::string log, train, test;
  pipeline::SplitOptions options;
};

void run(const Verb& verb, const Arguments& a) {
  a.options.check();
  io::LogReader log(a.log);
  const std::string origin = provenance(verb, {a.log});
  io::LogWriter train(a.train, log.info(), origin), test(a.test, log.info(), origin);
  const pipeline::SplitCounts n = pipeline::split_log(
      log, a.options,
      [&](const BeamLog& to_train, const BeamLog& to_test) {
        train.write(to_train);
        test.write(to_test);
      },
      shown<Progress>("split"));
  train.close();
  test.close();
  const Json j{
      {"train_beams", n.train_beams}, {"test_beams", n.test_beams}, {"skipped", log.skipped()}};
  verb.report(j, fmt::format("{} beams to train in {}, {} held out in {}\n", n.train_beams, a.train,
                             n.test_beams, a.test));
}

}  // namespace split_verb
}  // namespace

void add_split(Program& program) {
  using namespace split_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(program, "Logs", "split",
                             "Split a log into training and test parts that never share a beam",
                             "underbrush split log.ply --every 2 --train train.ply --test test.ply",
                             [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("LOG", a->log, "The log")->required();
  verb->output("--train", a->train, "The log of the beams that are kept for fitting")->required();
  verb->output("--test", a->test, "The log of the beams that are held out")->required();
  add_options(*verb, pipeline::split_options(), a->options, "What is held out (one of)");
}

}  // namespace underbrush::app
