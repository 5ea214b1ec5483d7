#include <algorithm>
#include <cmath>

#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace segment_verb {

struct Arguments {
  std::string log, output;
  pipeline::SegmentOptions options;
};

std::string text_of(const pipeline::LabelledCounts& o, size_t objects) {
  std::string text =
      fmt::format("{} of {} hits are ground ({:.1f} %), {} objects\n", o.ground, o.hits,
                  100.0 * double(o.ground) / double(std::max<size_t>(1, o.hits)), objects);
  for (const auto& [c, n] : o.points) {
    text += wide_line(18, elements::name(c), "{:>12} points", n);
  }
  if (o.labelled && o.hits == o.unlabelled) {
    text += "  note: its column class has no label of a known set (see import --label-set)\n";
  } else if (o.labelled) {
    const metrics::Agreement& g = o.ground_score;
    text += fmt::format(
        "  ground against labels      IoU {:.4f}  precision {:.4f}  recall {:.4f}  ({} labelled, "
        "{} not)\n",
        g.iou(), g.precision(), g.recall(), o.hits - o.unlabelled, o.unlabelled);
    if (std::isfinite(o.vegetation.recall())) {
      text += fmt::format("  vegetation against labels  precision {:.4f}  recall {:.4f}\n",
                          o.vegetation.precision(), o.vegetation.recall());
    }
  }
  if (o.has_truth) {
    const metrics::InstanceScore s = o.tree_score();
    if (s.truth) {
      text += fmt::format(
          "  trees against {:<12} {} found, {} true, {} matched  precision {:.3f}  recall {:.3f}  "
          "mean IoU {:.3f}\n",
          o.truth, s.found, s.truth, s.matched, s.precision(), s.recall(), s.mean_iou);
    }
  }
  return text;
}

std::string text_of(const pipeline::Segmentation& s, const pipeline::SegmentOptions& options) {
  std::string text = text_of(s.counts, s.objects);
  if (s.given) {
    text += line("labels", "{} ({}), {} hits without", options.labels,
                 s.given->by_place ? "by place" : "by order", s.given->unmatched);
  }
  const size_t lost = s.found ? s.found->off_ground : 0;
  return text + left_out(lost, "hits with no ground within 30 m: in no object");
}

void run(const Verb& verb, const Arguments& a) {
  io::LogReader log(a.log);
  if (!a.output.empty()) io::check_output(a.output);
  std::function<void(BeamSource&)> write;
  if (!a.output.empty()) {
    write = [&](BeamSource& labelled) {
      io::export_log(a.output, labelled, "ply", provenance(verb, {a.log, a.options.labels}));
    };
  }
  const pipeline::Segmentation s =
      pipeline::segment_log(log, a.options, write, shown<StageProgress>());
  std::string text = text_of(s, a.options);
  if (!a.output.empty()) text += line("log", "{}", a.output);
  verb.report(json_of(s, a.options, log.skipped()), text);
}

}  // namespace segment_verb
}  // namespace

void add_segment(Program& program) {
  using namespace segment_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Scenes", "segment",
               "Label a log as ground, trees, shrubs and patches, or take labels from a file",
               "underbrush segment log.ply -o labelled.ply\n"
               "  underbrush segment log.ply --labels edited.ply -o labelled.ply\n"
               "  underbrush segment log.ply --ground-method spherical_variance --json -",
               [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("LOG", a->log, "The log (.ply or .ublog, as import writes it)")->required();
  verb->output("-o,--output", a->output,
               "The log with the columns class and instance; columns of these names that it has "
               "already are kept as given_class and given_instance, for comparison")
      ->type_name("LABELLED.ply");
  add_options(*verb, pipeline::segment_options(), a->options);
}

}  // namespace underbrush::app
