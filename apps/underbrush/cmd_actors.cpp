#include <fmt/format.h>

#include <optional>

#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/learn_actors.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace actors_verb {

struct Arguments {
  std::string log, output, marked, met, boxes;
  actors::ActorOptions options;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The log (.ply or .ublog)")->required();
  verb.output("-o,--output", a.output,
              "The folder of the actors; it is a scene in which every object moves")
      ->type_name("ACTORS");
  verb.output("--marked", a.marked,
              "The log with the returns of the actors marked, which fit leaves out")
      ->type_name("MARKED.ply");
  verb.output("--met", a.met, "The beams that meet the box of an actor, as a log")
      ->type_name("MET.ply");
  app.add_option("--boxes", a.boxes,
                 "Labelled boxes (CSV with frame and track_id) or lists of objects; without this "
                 "option, moving objects are found by the methods of movers and perceive")
      ->type_name("FILE");
  app::add_options(verb, actors::actor_options(), a.options);
}

/// Writes the logs that are asked for.
void write_logs(const Arguments& a, const std::vector<actors::Track>& tracks,
                const std::string& origin) {
  if (a.marked.empty() && a.met.empty()) return;
  io::LogReader log(a.log);
  std::optional<io::LogWriter> marked, met;
  if (!a.marked.empty()) marked.emplace(a.marked, log.info(), origin);
  if (!a.met.empty()) met.emplace(a.met, log.info(), origin);
  actors::BoxesOfBeams boxes(tracks, a.options.boxes);
  for (BeamLog chunk; log.next(chunk);) {
    if (met) met->write(actors::beams_on(boxes, chunk));
    actors::mark_returns(boxes, chunk);
    if (marked) marked->write(chunk);
  }
  if (marked) marked->close();
  if (met) met->close();
}

std::string text_of(const std::vector<actors::ActorReport>& tracks) {
  std::string text;
  for (const actors::ActorReport& r : tracks) {
    text += fmt::format("{:<16} {:>7} returns in {:>3} scans", r.name, r.returns, r.scans);
    text += r.models == 0 ? ", left out: too few\n"
                          : fmt::format(", {:.1f} cm apart ({:.1f} as given), models: {}\n",
                                        100 * r.views.after_m, 100 * r.views.before_m, r.models);
  }
  return text;
}

void run(const Verb& verb, const Arguments& a) {
  require(!a.output.empty() || !a.marked.empty() || !a.met.empty(),
          "actors: nothing to do: give -o, --marked or --met");
  if (!a.output.empty()) elements::check_scene_output(a.output);
  for (const std::string& path : {a.marked, a.met}) {
    if (!path.empty()) io::check_output(path);
  }
  io::BeamReader log(a.log);
  const std::string origin = provenance(verb, {a.log, a.boxes});
  const auto tracks = actors::tracks_of_log(log, a.log, a.boxes, a.options);
  actors::LearntActors learnt;
  if (!a.output.empty()) {
    learnt =
        pipeline::learn_actors(log, a.log, tracks, a.options, verb.seed, shown<Progress>("actors"));
  }
  write_logs(a, tracks, origin);
  if (!a.output.empty()) {
    actors::write_actors(a.output, learnt.actors, pipeline::with_report(origin, learnt));
  }
  verb.report(pipeline::json_of(learnt), text_of(learnt.report));
}

}  // namespace actors_verb
}  // namespace

void add_actors(Program& program) {
  using namespace actors_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Models", "actors", "Learn moving objects as models with trajectories",
               "underbrush actors log.ply --boxes objects.csv -o actors/ --marked marked.ply\n"
               "  underbrush fit marked.ply -o model/\n"
               "  underbrush simulate model/ --actors actors/ --like log.ply -o sim.ply",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
