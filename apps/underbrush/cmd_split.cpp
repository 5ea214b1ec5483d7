#include <fmt/format.h>

#include "split_log.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace split_verb {

struct Arguments {
  std::string log, train, test;
  HoldOut hold_out;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The log")->required();
  verb.output("--train", a.train, "Where the beams that are kept for fitting go")->required();
  verb.output("--test", a.test, "Where the beams that are held out go")->required();
  verb.begin_group("What is held out (one of)");
  app.add_option("--every", a.hold_out.every, "Every K-th scan")->check(CLI::Range(2, 1 << 30));
  app.add_option(
         "--columns", a.hold_out.columns,
         "Every K-th column of each scan: the beams fired at one time (where the log has no "
         "times of beams: in one packet)")
      ->check(CLI::Range(2, 1 << 30));
  app.add_option("--time", a.hold_out.time,
                 "Scans whose time lies in [FROM, TO), s after the log's start")
      ->expected(2)
      ->type_name("FROM TO");
  app.add_option("--region", a.hold_out.region,
                 "Scans whose sensor stands in this rectangle of the world, m")
      ->expected(4)
      ->type_name("X0 Y0 X1 Y1");
  verb.begin_group("Options");
  app.add_option("--offset", a.hold_out.offset,
                 "With --every and --columns: number (mod K) that is held out")
      ->capture_default_str();
}

void run(const Verb& verb, const Arguments& a) {
  const SplitStep step = split_log(verb, a.log, a.hold_out, a.train, a.test);
  Json j;
  j["train_beams"] = step.train_beams;
  j["test_beams"] = step.test_beams;
  j["skipped"] = step.skipped;
  verb.report(j, fmt::format("{} beams to train in {}, {} held out in {}\n", step.train_beams,
                             a.train, step.test_beams, a.test));
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
  add_options(*verb, *a);
}

}  // namespace underbrush::app
