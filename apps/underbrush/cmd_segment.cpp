#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/fit/ground_flags.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/metrics/agreement.hpp"
#include "verb.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {

struct Arguments {
  std::string log, output;
  double tile_m = 32;
  ground::SegmentOptions ground;
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("LOG", a.log, "The log (ray cloud PLY, as import writes it)")->required();
  app.add_option("-o,--output", a.output,
                 "The log with the column class: ground, or unknown. A column class that it had is "
                 "scored against and kept as given_class")
      ->type_name("LABELLED.ply");
  app.add_option("--ground-method", a.ground.method, "Ground segmentation")
      ->check(CLI::IsMember({"lower_envelope", "spherical_variance"}))
      ->capture_default_str();
  app.add_option("--tile", a.tile_m, "Side of a tile, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

/// What a pass over the log with its flags gives.
struct Outcome {
  size_t beams = 0, hits = 0, ground = 0, unlabelled = 0;
  bool labelled = false;
  metrics::Agreement score;
};

/// Puts the found classes into the chunk and counts; `next` goes on through `flags`.
void label(const std::vector<uint8_t>& flags, size_t& next, BeamLog& chunk, Outcome& out) {
  std::vector<uint8_t> found(chunk.size());
  const auto given = chunk.extra.find("class");
  out.labelled = given != chunk.extra.end();
  for (size_t i = 0; i < chunk.size(); ++i) {
    ++out.beams;
    if (!chunk.is_hit(i)) continue;
    const bool ground = flags[next++];
    found[i] = uint8_t(ground ? elements::Class::kGround : elements::Class::kUnknown);
    ++out.hits;
    out.ground += ground;
    if (!out.labelled) continue;
    const auto number = std::visit([&](const auto& c) { return uint32_t(c[i]); }, given->second);
    const elements::GroundLabel truth = elements::ground_label(chunk.info.classes, number);
    if (truth == elements::GroundLabel::kUnknown) {
      ++out.unlabelled;
    } else {
      out.score.add(ground, truth == elements::GroundLabel::kYes);
    }
  }
  if (out.labelled) chunk.extra["given_class"] = std::move(given->second);
  chunk.extra["class"] = std::move(found);
}

Json json_of(const Arguments& a, const Outcome& o, const std::map<std::string, size_t>& skipped) {
  Json j;
  j["ground_method"] = a.ground.method;
  j["beams"] = o.beams;
  j["hits"] = o.hits;
  j["ground"] = o.ground;
  j["skipped"] = skipped;
  if (!o.labelled) return j;
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  j["ground_score"] = {{"labelled", o.hits - o.unlabelled},
                       {"unlabelled", o.unlabelled},
                       {"true_positive", o.score.true_positive},
                       {"false_positive", o.score.false_positive},
                       {"false_negative", o.score.false_negative},
                       {"true_negative", o.score.true_negative},
                       {"iou", number(o.score.iou())},
                       {"precision", number(o.score.precision())},
                       {"recall", number(o.score.recall())}};
  return j;
}

void run(const Verb& verb, const Arguments& a) {
  io::LogReader log(a.log);
  Progress progress("segment");
  const std::vector<uint8_t> flags = fit::ground_flags(log, a.ground, a.tile_m, std::ref(progress));
  LogInfo info = log.info();
  info.classes = "underbrush";
  std::optional<io::LogWriter> writer;
  if (!a.output.empty()) writer.emplace(a.output, info, provenance(verb, {a.log}));
  Outcome out;
  size_t next = 0;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    label(flags, next, chunk, out);
    if (writer) writer->write(chunk);
  }
  if (writer) writer->close();
  std::string text =
      fmt::format("{}: {} of {} hits are ground ({:.1f} %)\n", a.ground.method, out.ground,
                  out.hits, 100.0 * double(out.ground) / double(std::max<size_t>(1, out.hits)));
  if (out.labelled && out.hits == out.unlabelled) {
    text += "  note: its column class has no label of a known set (see import --label-set)\n";
  } else if (out.labelled) {
    text += fmt::format(
        "  against labels  IoU {:.4f}  precision {:.4f}  recall {:.4f}  ({} labelled, {} not)\n",
        out.score.iou(), out.score.precision(), out.score.recall(), out.hits - out.unlabelled,
        out.unlabelled);
  }
  if (writer) text += "  log             " + a.output + "\n";
  verb.report(json_of(a, out, log.skipped()), text);
}

}  // namespace

void add_segment(CLI::App& root) {
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(root, "segment", "Label a log: ground; scored against labels that it has",
               "underbrush segment log.ply -o labelled.ply\n"
               "  underbrush segment log.ply --ground-method spherical_variance --json -",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb->app, *a);
}

}  // namespace underbrush::app
