#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <optional>
#include <set>

#include "cli/progress.hpp"
#include "import_report.hpp"
#include "import_survey.hpp"
#include "row_filter.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/sensor/beams_from_scan.hpp"
#include "underbrush/sensor/pulse_returns.hpp"
#include "underbrush/worlds/helios_scene.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace import_verb {

struct Arguments {
  std::string source, output, assets, frames, deskew, infer_misses, label_set, keep;
  io::InputOptions input;
  io::LogWriterOptions writer;
  bool float_coordinates = false, times_as_given = false;
  double elevation_offset_deg = 0, max_range_m = 0;
  std::optional<double> unknown_below_deg;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("SOURCE", a.source, "The log: a file or folder; or a survey of HELIOS++ (.xml)")
      ->required();
  verb.output("-o,--output", a.output, "The log as a ray cloud PLY; of a survey, a folder")
      ->required()
      ->type_name("LOG.ply");
  app.add_option("--format", a.input.format, "Format of the source (default: detected)")
      ->check(CLI::IsMember(io::input_formats()));
  app.add_option("--poses", a.input.poses, "File of the sensor's poses, in TUM or KITTI format")
      ->type_name("FILE");
  verb.begin_rare_group();
  app.add_option("--times", a.input.times, "File of the scans' times, one on each line, s")
      ->type_name("FILE");
  app.add_option("--labels", a.input.labels, "Labels of a single scan, a SemanticKITTI .label file")
      ->type_name("FILE");
  app.add_option("--label-set", a.label_set,
                 "Label set of the column class (default: semantickitti for .label files)")
      ->check(CLI::IsMember(elements::label_set_names()));
  app.add_option(
         "--keep", a.keep,
         "Read only the points with this value of a column, such as first returns: target_index=1")
      ->type_name("COLUMN=VALUE");
  app.add_option("--assets", a.assets,
                 "Folder in which a survey of HELIOS++ has its files, besides its own")
      ->type_name("FOLDER");
  app.add_option("--frames", a.frames, "Scans to read, by number, half-open: A:B or A:B:STEP")
      ->type_name("A:B[:STEP]");
  app.add_option("--deskew", a.deskew,
                 "Give every beam its own pose by this sensor's timing, for raw scans")
      ->type_name("SENSOR");
  app.add_flag("--times-as-given", a.times_as_given,
               "With --deskew: fit no clock to scan times that were rounded");
  app.add_option("--unknown-below-deg", a.unknown_below_deg,
                 "Leave out beams without a return that point lower than this elevation, as at the "
                 "own vehicle; by default inferred ones below -13 and no recorded ones");
  app.add_option(
         "--elevation-offset-deg", a.elevation_offset_deg,
         "Turn every beam up by this angle, for a known fault of the recording (KITTI: 0.205)")
      ->capture_default_str();
  app.add_option("--infer-misses", a.infer_misses,
                 "Infer misses from this sensor's scan pattern, for formats that drop them")
      ->type_name("SENSOR");
  app.add_option("--max-range", a.max_range_m,
                 "Range of a miss, m; 0 = the sensor's or the log's own")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_flag(
      "--points-in-world", a.input.points_in_world,
      "The points are in the world frame already, and the poses only give the place of the sensor");
  app.add_flag("--float", a.float_coordinates, "Write coordinates as float instead of double");
}

// The sensor of an option, which must be a spinning one.
sensor::Sensor spinning_sensor(const std::string& option, const std::string& name) {
  sensor::Sensor s = sensor::load(name);
  if (s.kind == sensor::Kind::kSpinning) return s;
  const std::string reason = option + " needs a spinning sensor";
  if (std::filesystem::is_regular_file(name)) throw FormatError(name, "kind", reason);
  throw std::invalid_argument("import: " + in_quotes(name) + ": " + reason);
}

sensor::BeamOptions beam_options(const Arguments& a, const io::Input& input) {
  sensor::BeamOptions options;
  options.elevation_offset_rad = a.elevation_offset_deg * M_PI / 180;
  if (a.unknown_below_deg) {
    options.unknown_below_rad = options.recorded_unknown_below_rad =
        *a.unknown_below_deg * M_PI / 180;
  }
  if (!a.deskew.empty()) {
    require(!input.compensated, "import: --deskew: these scans are motion-compensated already");
    options.deskew = spinning_sensor("--deskew", a.deskew);
  }
  if (!a.infer_misses.empty()) {
    options.infer_misses = spinning_sensor("--infer-misses", a.infer_misses);
  }
  return options;
}

// Returns the description of the log that is written. Whether it has misses is found while writing.
LogInfo log_info(const Arguments& a, const io::Input& input, const sensor::BeamOptions& options) {
  LogInfo info;
  const auto& known = options.deskew ? options.deskew : options.infer_misses;
  if (known) {
    info.sensor = known->name;
    info.sensor_file = known->file;
    info.min_range_m = known->min_range_m;
    info.max_range_m = known->max_range_m;
  }
  if (a.max_range_m > 0) info.max_range_m = a.max_range_m;
  info.deskewed = options.deskew.has_value();
  info.classes = a.label_set.empty() ? input.classes : a.label_set;
  info.has_misses = options.infer_misses.has_value();
  info.scans = input.scan_infos;
  return info;
}

// Returns that are not known to be of one pulse count as several beams.
void note_echoes(const RowFilter& keep, const std::map<std::string, ExtraColumn>& extra,
                 std::vector<std::string>& notes) {
  for (const char* name : {"target_index", "return_number"}) {
    if (!keep.all() || !extra.count(name)) continue;
    const std::string note = fmt::format(
        "every return is taken for a beam of its own; --keep {}=1 takes the first of each", name);
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
}

/// Makes the beams of a scan, with all returns of each pulse.
BeamLog beams_with_echoes(const PointScan& scan, const Trajectory& path,
                          const sensor::BeamOptions& options, ImportCounts& counts) {
  const std::optional<sensor::PulseReturns> pulses = sensor::pulse_returns(scan);
  if (!pulses) return sensor::beams_from_scan(scan, path, options, counts.beam);
  BeamLog beams = sensor::beams_from_scan(pulses->first, path, options, counts.beam);
  const size_t fired = beams.size();
  sensor::insert_later_returns(*pulses, beams);
  counts.later_returns += beams.size() - fired;
  if (pulses->lost > 0) counts.beam.skipped[sensor::kNoPulse] += pulses->lost;
  return beams;
}

ImportCounts import_scans(const RowFilter& keep, io::Input& input, io::LogWriter& writer,
                          const sensor::BeamOptions& options) {
  ImportCounts counts;
  Progress progress("import");
  for (size_t k = 0; k < input.scans->size(); ++k) {
    PointScan scan = input.scans->read(k);
    keep.apply(scan, counts.beam.skipped);
    const Trajectory& path = input.scans->trajectory();
    const size_t later = counts.later_returns;
    // Who keeps some rows only has chosen what a beam is.
    const BeamLog beams = keep.all() ? beams_with_echoes(scan, path, options, counts)
                                     : sensor::beams_from_scan(scan, path, options, counts.beam);
    if (!beams.extra.count(kEchoColumn)) note_echoes(keep, scan.extra, input.notes);
    writer.write(beams);
    counts.beams += beams.size() - (counts.later_returns - later);
    ++counts.scans;
    progress(k + 1, input.scans->size());
  }
  return counts;
}

ImportCounts import_beams(const Arguments& a, const RowFilter& keep, io::Input& input,
                          io::LogWriter& writer) {
  ImportCounts counts;
  Progress progress("import");
  size_t done = 0;
  std::set<uint32_t> scans;
  for (BeamLog chunk; input.beams->next(chunk);) {
    done += chunk.size();
    if (!keep.all()) {
      BeamLog part = chunk.like();
      for (const size_t i : keep.rows(chunk.extra)) part.append(chunk, i);
      if (part.size() < chunk.size()) {
        counts.beam.skipped[keep.reason()] += chunk.size() - part.size();
      }
      chunk = std::move(part);
    }
    note_echoes(keep, chunk.extra, input.notes);
    BeamLog part;
    if (!a.frames.empty()) {
      part = chunk.like();
      for (size_t i = 0; i < chunk.size(); ++i) {
        if (a.input.frames.has(chunk.scan[i])) part.append(chunk, i);
      }
    }
    const BeamLog& kept = a.frames.empty() ? chunk : part;
    for (size_t i = 0; i < kept.size(); ++i) {
      if (i == 0 || kept.scan[i] != kept.scan[i - 1]) scans.insert(kept.scan[i]);
      ++(kept.is_hit(i)              ? counts.beam.hits
         : kept.flags[i] & kInferred ? counts.beam.misses_inferred
                                     : counts.beam.misses_recorded);
    }
    writer.write(kept);
    counts.beams += kept.size();
    progress(done, input.beams->size());
  }
  counts.scans = scans.size();
  return counts;
}

LogInfo beams_info(const Arguments& a, const io::Input& input) {
  require(a.deskew.empty() && a.infer_misses.empty() && a.elevation_offset_deg == 0,
          "import: this log holds beams with their origins: --deskew, --infer-misses and "
          "--elevation-offset-deg are for scans");
  LogInfo info = input.beams->info();
  std::erase_if(info.scans, [&](const auto& s) { return !a.input.frames.has(s.scan); });
  if (a.max_range_m > 0) info.max_range_m = a.max_range_m;
  if (!a.label_set.empty()) info.classes = a.label_set;
  return info;
}

void run(const Verb& verb, Arguments& a) {
  if (worlds::is_helios(a.source)) return import_survey(verb, a.source, a.output, a.assets);
  if (!a.frames.empty()) a.input.frames = io::frames_from_text(a.frames);
  a.writer.double_coordinates = !a.float_coordinates;
  a.input.fit_clock = !a.deskew.empty() && !a.times_as_given;
  const RowFilter keep(a.source, a.keep);
  io::Input input = io::open_input(a.source, a.input);
  std::vector<std::filesystem::path> sources{a.source};
  for (const auto& file : {a.input.poses, a.input.times, a.input.labels}) {
    if (!file.empty()) sources.push_back(file);
  }
  // The sensors are names in the catalogue, or files, which are inputs.
  for (const auto& name : {a.deskew, a.infer_misses}) {
    if (std::filesystem::is_regular_file(name)) sources.emplace_back(name);
  }
  const bool beams = input.beams != nullptr;
  const sensor::BeamOptions options = beams ? sensor::BeamOptions{} : beam_options(a, input);
  const LogInfo info = beams ? beams_info(a, input) : log_info(a, input, options);
  io::LogWriter writer(a.output, info, provenance(verb, sources), a.writer);
  ImportCounts counts =
      beams ? import_beams(a, keep, input, writer) : import_scans(keep, input, writer, options);
  counts.skipped = input.skipped();
  for (const auto& [reason, n] : counts.beam.skipped) counts.skipped[reason] += n;
  if (counts.beams == 0)
    throw FormatError(a.source, "", nothing_usable(counts, a.input.points_in_world));
  if (!beams && counts.beam.misses_recorded + counts.beam.misses_inferred == 0) {
    input.notes.push_back(
        "the log has no misses: hit probabilities cannot be learnt from it (see --infer-misses)");
  }
  writer.close();
  const std::vector<std::string> warnings = warnings_of(counts);
  for (const std::string& w : warnings) std::cerr << "underbrush: warning: " << w << "\n";
  verb.report(json_of(input, counts, warnings),
              table_of(input, counts, a.output) + text_of_warnings(warnings));
}

}  // namespace import_verb
}  // namespace

void add_import(Program& program) {
  using namespace import_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Logs", "import",
               "Convert any supported log to a ray cloud PLY, with misses kept or inferred",
               "underbrush import drive/ --poses drive/poses_velo.txt --deskew velodyne-hdl64e \\\n"
               "    --elevation-offset-deg 0.205 --infer-misses velodyne-hdl64e -o log.ply",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
