#include "underbrush/pipeline/import_log.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/pipeline/beam_checks.hpp"
#include "underbrush/pipeline/copies.hpp"
#include "underbrush/pipeline/import_checks.hpp"
#include "underbrush/pipeline/pose_checks.hpp"
#include "underbrush/pipeline/row_filter.hpp"
#include "underbrush/pipeline/sensor_checks.hpp"
#include "underbrush/sensor/pulse_returns.hpp"

namespace underbrush::pipeline {
namespace {

constexpr double kFewMisses = 0.03;  // of all recorded
constexpr double kFewCopies = 0.2;   // of the returns

// The sensor of an option, which must be a spinning one.
sensor::Sensor spinning_sensor(const std::string& option, const std::string& name) {
  sensor::Sensor s = sensor::load(name);
  if (s.kind == sensor::Kind::kSpinning) return s;
  const std::string reason = option + " needs a spinning sensor";
  if (std::filesystem::is_regular_file(name)) throw FormatError(name, "kind", reason);
  throw std::invalid_argument("import: " + in_quotes(name) + ": " + reason);
}

double unit_of(const std::string& name) {
  return name == "mm" ? 1e-3 : name == "cm" ? 1e-2 : name == "ft" ? 0.3048 : 1;
}

std::vector<std::string> names_of(std::string text) {
  std::vector<std::string> names;
  std::replace(text.begin(), text.end(), ',', ' ');
  for (const std::string_view word : io::words_of(text))
    names.push_back(io::lower(std::string(word)));
  return names;
}

io::InputOptions input_options(const ImportOptions& o) {
  io::InputOptions out;
  out.format = o.format;
  out.poses = o.poses;
  out.times = o.times;
  out.labels = o.labels;
  out.points_in_world = o.points_in_world;
  if (!o.frames.empty()) out.frames = io::frames_from_text(o.frames);
  out.fit_clock = !o.deskew.empty() && !o.times_as_given;
  out.columns = names_of(o.columns);
  out.unit_m = unit_of(o.unit);
  out.count = o.point_times == "before"  ? io::TimesCount::kBefore
              : o.point_times == "until" ? io::TimesCount::kUntil
                                         : io::TimesCount::kAfter;
  if (!o.deskew.empty()) out.scan_period_s = 1 / spinning_sensor("--deskew", o.deskew).rate_hz;
  return out;
}

sensor::BeamOptions beam_options(const ImportOptions& o, const io::Input& input) {
  sensor::BeamOptions out;
  out.elevation_offset_rad = o.elevation_offset_deg * M_PI / 180;
  out.no_return_at_m = o.max_range_m;
  if (!std::isnan(o.unknown_below_deg)) {
    out.unknown_below_rad = out.recorded_unknown_below_rad = o.unknown_below_deg * M_PI / 180;
  }
  if (!o.deskew.empty()) {
    require(!input.compensated, "import: --deskew: these scans are motion-compensated already");
    out.deskew = spinning_sensor("--deskew", o.deskew);
  }
  if (!o.infer_misses.empty()) {
    out.infer_misses = spinning_sensor("--infer-misses", o.infer_misses);
  }
  return out;
}

// Returns the description of the log. Whether it has misses is found while it is read.
LogInfo info_of_scans(const ImportOptions& o, const io::Input& input,
                      const sensor::BeamOptions& options) {
  LogInfo info;
  const auto& known = options.deskew ? options.deskew : options.infer_misses;
  if (known) {
    info.sensor = known->name;
    info.sensor_file = known->file;
    info.min_range_m = known->min_range_m;
    info.max_range_m = known->max_range_m;
  }
  if (o.max_range_m > 0) info.max_range_m = o.max_range_m;
  info.deskewed = options.deskew.has_value();
  info.classes = o.label_set.empty() ? input.classes : o.label_set;
  info.has_misses = options.infer_misses.has_value();
  info.scans = input.scan_infos;
  return info;
}

LogInfo info_of_beams(const ImportOptions& o, const io::Input& input,
                      const io::FrameRange& frames) {
  require(o.deskew.empty() && o.infer_misses.empty() && o.elevation_offset_deg == 0,
          "import: this log holds beams with their origins: --deskew, --infer-misses and "
          "--elevation-offset-deg are for scans");
  LogInfo info = input.beams->info();
  std::erase_if(info.scans, [&](const auto& s) { return !frames.has(s.scan); });
  const double unit_m = unit_of(o.unit);
  info.min_range_m *= unit_m;
  info.max_range_m = o.max_range_m > 0 ? o.max_range_m : info.max_range_m * unit_m;
  for (ScanInfo& scan : info.scans) scan.world_from_sensor.translation *= unit_m;
  if (!o.label_set.empty()) info.classes = o.label_set;
  return info;
}

/// Scales lengths to m.
void apply_unit(BeamLog& log, double unit_m) {
  if (unit_m == 1) return;
  for (Vec3& origin : log.origin) origin *= unit_m;
  for (float& range : log.range_m) range = float(double(range) * unit_m);
}

// Returns that are not known to be of one pulse count as several beams.
void note_echoes(const RowFilter& keep, const std::map<std::string, ExtraColumn>& extra,
                 std::vector<std::string>& notes) {
  for (const std::string name : {"target_index", "return_number"}) {
    if (!keep.all() || !extra.count(name)) continue;
    const std::string note = "every return is taken for a beam of its own; --keep " + name +
                             "=1 takes the first of each";
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
}

/// Makes the beams of a scan, with all returns of each pulse.
BeamLog beams_with_echoes(const PointScan& scan, const Trajectory& path,
                          const sensor::BeamOptions& options, ImportReport& report) {
  const std::optional<sensor::PulseReturns> pulses = sensor::pulse_returns(scan);
  if (!pulses) return sensor::beams_from_scan(scan, path, options, report.beam);
  BeamLog beams = sensor::beams_from_scan(pulses->first, path, options, report.beam);
  const size_t fired = beams.size();
  sensor::insert_later_returns(*pulses, beams);
  report.later_returns += beams.size() - fired;
  if (pulses->lost > 0) report.beam.skipped[sensor::kNoPulse] += pulses->lost;
  return beams;
}

using Write = std::function<void(const BeamLog&)>;
using Progress = std::function<void(size_t, size_t)>;

/// Holds the first scan against the sensors that options name.
void check_first(const std::string& source, const PointScan& scan,
                 const sensor::BeamOptions& options, ImportReport& report) {
  if (options.deskew) check_sensor_of(source, "--deskew", scan, *options.deskew);
  if (options.infer_misses) {
    check_sensor_of(source, "--infer-misses", scan, *options.infer_misses);
    check_channels_of(source, "--infer-misses", scan, *options.infer_misses,
                      options.elevation_offset_rad);
  }
  for (std::string warning :
       {warning_of_ranges(scan), warning_of_greatest_range(scan, options.no_return_at_m),
        options.deskew ? warning_of_turn(scan, options.deskew->turn()) : ""}) {
    if (!warning.empty()) report.warnings.push_back(std::move(warning));
  }
}

/// What --deskew assumes about points without times, and the columns that are none.
std::string note_of_times(const PointScan& scan) {
  std::string text = "the points have no times";
  const char* separator = " (not known as times: ";
  for (const auto& [name, column] : scan.extra) {
    text += separator + name;
    separator = ", ";
  }
  return text + (scan.extra.empty() ? "" : ")") +
         ": --deskew takes the scan's time for that at which the sensor faces forward";
}

/// Says that the points of a moving sensor are all placed by the poses of their scans.
void note_no_deskew(const PointScan& scan, io::Input& input) {
  constexpr double kMoves = 0.1;  // m from scan to scan
  const std::vector<ScanInfo>& infos = input.scan_infos;
  if (input.compensated || infos.size() < 2) return;
  const Vec3 way =
      infos.back().world_from_sensor.translation - infos[0].world_from_sensor.translation;
  if (way.norm() < kMoves * double(infos.size() - 1)) return;
  input.notes.push_back(std::string("the points of a scan are placed by one pose") +
                        (scan.time_s.empty() ? "" : ", although they have times") +
                        ": --deskew SENSOR gives raw scans of a moving sensor one for each beam");
}

/// Leaves out times of points that are too coarse to give the motion within a scan.
void leave_out_times(PointScan& scan, bool deskew, ImportReport& report) {
  const size_t times = deskew ? coarse_times(scan) : 0;
  if (times == 0) return;
  scan.time_s.clear();
  const std::string warning =
      "the times of a scan's points have " + std::to_string(times) +
      (times == 1 ? " value: " : " values: ") +
      "--deskew does without them, and takes the scan's time for that at which the sensor faces "
      "forward";
  if (std::ranges::find(report.warnings, warning) == report.warnings.end()) {
    report.warnings.push_back(warning);
  }
}

void import_scans(const std::string& source, const RowFilter& keep, io::Input& input,
                  const sensor::BeamOptions& options, const Write& write, const Progress& progress,
                  ImportReport& report) {
  bool doubled = false;
  for (size_t k = 0; k < input.scans->size(); ++k) {
    PointScan scan = input.scans->read(k);
    if (scan.size() == 0) continue;
    if (report.scans == 0) {
      check_first(source, scan, options, report);
      if (options.deskew && scan.time_s.empty()) input.notes.push_back(note_of_times(scan));
      if (!options.deskew) note_no_deskew(scan, input);
      doubled = keep.all() && share_of_copies(scan) > kFewCopies;
    }
    if (doubled) report.beam.skipped["copies of a return of the same time"] += remove_copies(scan);
    leave_out_times(scan, options.deskew.has_value(), report);
    keep.apply(scan, report.beam.skipped);
    const Trajectory& path = input.scans->trajectory();
    const size_t later = report.later_returns;
    // Who keeps some rows only has chosen what a beam is.
    const BeamLog beams = keep.all() ? beams_with_echoes(scan, path, options, report)
                                     : sensor::beams_from_scan(scan, path, options, report.beam);
    if (!beams.extra.count(kEchoColumn)) note_echoes(keep, scan.extra, input.notes);
    write(beams);
    report.beams += beams.size() - (report.later_returns - later);
    ++report.scans;
    if (progress) progress(k + 1, input.scans->size());
  }
}

/// Returns the rows of a chunk that are kept, of these frames.
BeamLog kept_of(BeamLog chunk, const RowFilter& keep, const io::FrameRange* frames,
                ImportReport& report) {
  if (!keep.all()) {
    BeamLog part = chunk.like();
    for (const size_t i : keep.rows(chunk.extra)) part.append(chunk, i);
    if (part.size() < chunk.size()) {
      report.beam.skipped[keep.reason()] += chunk.size() - part.size();
    }
    chunk = std::move(part);
  }
  if (!frames) return chunk;
  BeamLog part = chunk.like();
  for (size_t i = 0; i < chunk.size(); ++i) {
    if (frames->has(chunk.scan[i])) part.append(chunk, i);
  }
  return part;
}

void import_beams(const RowFilter& keep, io::Input& input, const LogInfo& info, double unit_m,
                  const io::FrameRange* frames, const Write& write, const Progress& progress,
                  ImportReport& report) {
  size_t done = 0;
  BeamChecks checks;
  std::set<uint32_t> scans;
  for (BeamLog chunk; input.beams->next(chunk);) {
    done += chunk.size();
    apply_unit(chunk, unit_m);
    chunk.info = info;
    checks.add(chunk);
    const BeamLog kept = kept_of(std::move(chunk), keep, frames, report);
    note_echoes(keep, kept.extra, input.notes);
    for (size_t i = 0; i < kept.size(); ++i) {
      if (i == 0 || kept.scan[i] != kept.scan[i - 1]) scans.insert(kept.scan[i]);
      ++(kept.is_hit(i)              ? report.beam.hits
         : kept.flags[i] & kInferred ? report.beam.misses_inferred
                                     : report.beam.misses_recorded);
    }
    write(kept);
    report.beams += kept.size();
    if (progress) progress(done, input.beams->size());
  }
  report.scans = scans.size();
  report.warnings = checks.warnings();
}

/// Says what became of all records where no beam is left, and what to do where the points seem to
/// be those of a world.
std::string nothing_usable(const ImportReport& report, bool points_in_world) {
  std::string text = "no usable beams in it";
  const char* separator = ": ";
  for (const auto& [reason, n] : report.skipped) {
    text += separator + std::to_string(n) + " " + reason;
    separator = ", ";
  }
  if (report.skipped.count(io::kFarFromSensor) && !points_in_world) {
    text += std::string("; ") + io::kWorldCoordinates;
  }
  return text;
}

void warn_of_misses(ImportReport& report) {
  if (2 * report.beam.scans_thinned > report.scans) {
    report.warnings.push_back(
        "neighbours in rings of " + std::to_string(report.beam.scans_thinned) +
        " scans are mostly farther apart than the sensor's firings: if points were left out of "
        "them, the inferred misses are none; import the whole scans");
  }
  const auto lost = report.skipped.find(sensor::kNoGrid);
  if (lost == report.skipped.end()) return;
  const size_t recorded = report.beam.misses_recorded + lost->second;
  if (double(lost->second) <= kFewMisses * double(recorded)) return;
  report.warnings.push_back(std::to_string(lost->second) + " of " + std::to_string(recorded) +
                            " recorded misses are lost (" + sensor::kNoGrid +
                            "): a model fitted to this log takes plants for denser than they are");
}

}  // namespace

ImportReport import_log(const std::filesystem::path& source, const ImportOptions& options,
                        const std::function<void(const LogInfo&)>& begin, const Write& write,
                        const Progress& progress) {
  check_options("import", import_options(), options);
  const io::InputOptions reading = input_options(options);
  const RowFilter keep(source.string(), options.keep);
  io::Input input = io::open_input(source, reading);
  ImportReport report;
  if (input.beams) {
    const LogInfo info = info_of_beams(options, input, reading.frames);
    begin(info);
    import_beams(keep, input, info, reading.unit_m,
                 options.frames.empty() ? nullptr : &reading.frames, write, progress, report);
  } else {
    const sensor::BeamOptions beams = beam_options(options, input);
    begin(info_of_scans(options, input, beams));
    report.warnings = warnings_of_poses(input.scan_infos);
    if (report.warnings.empty() && (input.scan_infos.size() > 1 || are_tilted(input.scan_infos))) {
      const io::Input again = io::open_input(source, reading);  // What it skips is counted once.
      const std::string warning = warning_of_scans(*again.scans, input.scan_infos);
      if (!warning.empty()) report.warnings.push_back(warning);
    }
    import_scans(source.string(), keep, input, beams, write, progress, report);
    if (report.beams > 0 && report.beam.misses_recorded + report.beam.misses_inferred == 0) {
      input.notes.emplace_back(
          options.infer_misses.empty()
              ? "the log has no misses: hit probabilities cannot be learnt from it (see "
                "--infer-misses)"
              : "the log has no misses: no ring of it has a gap where one could be");
    }
  }
  report.skipped = input.skipped();
  for (const auto& [reason, n] : report.beam.skipped) report.skipped[reason] += n;
  if (report.beams == 0) {
    throw FormatError(source.string(), "", nothing_usable(report, options.points_in_world));
  }
  report.format = input.format;
  report.clock = input.clock;
  report.notes = input.notes;
  if (input.read_notes) {
    for (std::string& note : input.read_notes()) report.notes.push_back(std::move(note));
  }
  if (input.read_warnings) {
    for (std::string& text : input.read_warnings()) report.warnings.push_back(std::move(text));
  }
  warn_of_misses(report);
  return report;
}

}  // namespace underbrush::pipeline
