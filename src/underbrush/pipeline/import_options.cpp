#include "underbrush/pipeline/import_options.hpp"

#include "underbrush/elements/label_sets.hpp"
#include "underbrush/io/input.hpp"

namespace underbrush::pipeline {
namespace {

std::vector<std::string_view> views_of(const std::vector<std::string>& words) {
  return {words.begin(), words.end()};
}

}  // namespace

// long: the table of the options.
std::span<const Option<ImportOptions>> import_options() {
  using O = ImportOptions;
  static const std::vector<std::string> formats = io::input_formats(),
                                        sets = elements::label_set_names();
  // clang-format off
  static const Option<O> kOptions[] = {
    {"format", "", "", "Format of the source (default: detected)",
     [](O& o) -> auto& { return o.format; }, -kNoLimit, kNoLimit, views_of(formats)},
    {"poses", "", "", "File of the sensor's poses, in TUM or KITTI format",
     [](O& o) -> auto& { return o.poses; }, -kNoLimit, kNoLimit, {}, "FILE"},

    {"times", "More options", "", "File of the scans' times, one on each line, s",
     [](O& o) -> auto& { return o.times; }, -kNoLimit, kNoLimit, {}, "FILE"},
    {"labels", "More options", "", "Labels of a single scan, a SemanticKITTI .label file",
     [](O& o) -> auto& { return o.labels; }, -kNoLimit, kNoLimit, {}, "FILE"},
    {"label-set", "More options", "",
     "Label set of the column class (default: semantickitti for .label files)",
     [](O& o) -> auto& { return o.label_set; }, -kNoLimit, kNoLimit, views_of(sets)},
    {"keep", "More options", "",
     "Read only the points with this value of a column, such as first returns: target_index=1",
     [](O& o) -> auto& { return o.keep; }, -kNoLimit, kNoLimit, {}, "COLUMN=VALUE"},
    {"columns", "More options", "",
     "Names of the columns, for .bin and text files without a header: x,y,z,intensity,ring",
     [](O& o) -> auto& { return o.columns; }, -kNoLimit, kNoLimit, {}, "X,Y,Z,..."},
    {"unit", "More options", "", "Unit of the coordinates",
     [](O& o) -> auto& { return o.unit; }, -kNoLimit, kNoLimit, {"m", "cm", "mm", "ft"}},
    {"assets", "More options", "",
     "Folder with the files of a survey of HELIOS++, besides the folder of the survey",
     [](O& o) -> auto& { return o.assets; }, -kNoLimit, kNoLimit, {}, "FOLDER"},
    {"frames", "More options", "",
     "Scans to read, by number, half-open: A:B or A:B:STEP",
     [](O& o) -> auto& { return o.frames; }, -kNoLimit, kNoLimit, {}, "A:B[:STEP]"},
    {"deskew", "More options", "",
     "Compute a pose for every beam from the timing of this sensor, for raw scans",
     [](O& o) -> auto& { return o.deskew; }, -kNoLimit, kNoLimit, {}, "SENSOR"},
    {"point-times", "More options", "",
     "How times of points count: after the scan's time; before it, back from its last point; or "
     "until it, the time of the last point",
     [](O& o) -> auto& { return o.point_times; }, -kNoLimit, kNoLimit, {"after", "before", "until"}},
    {"times-as-given", "More options", "",
     "With --deskew: use the times of scans unchanged instead of fitting a clock to rounded ones",
     [](O& o) -> auto& { return o.times_as_given; }},
    {"unknown-below-deg", "More options", "",
     "Leave out misses below this elevation, where beams may end at the own vehicle; by default, "
     "inferred misses below -13 are left out, and all recorded misses are kept",
     [](O& o) -> auto& { return o.unknown_below_deg; }, -90, 90},
    {"elevation-offset-deg", "More options", "",
     "Turn every beam up by this angle, for a known fault of the recording (KITTI: 0.205)",
     [](O& o) -> auto& { return o.elevation_offset_deg; }, -90, 90},
    {"infer-misses", "More options", "",
     "Infer misses from this sensor's scan pattern, for formats that drop them",
     [](O& o) -> auto& { return o.infer_misses; }, -kNoLimit, kNoLimit, {}, "SENSOR"},
    {"max-range", "More options", "m",
     "Range of a miss; 0 = the maximum range of the sensor or of the log. Points of scans at this "
     "range are misses",
     [](O& o) -> auto& { return o.max_range_m; }, 0, 1e6},
    {"points-in-world", "More options", "",
     "The points are in the world frame already, and the poses only give the place of the sensor",
     [](O& o) -> auto& { return o.points_in_world; }},
    {"float", "More options", "", "Write coordinates as float instead of double",
     [](O& o) -> auto& { return o.float_coordinates; }},
  };
// clang-format on
return kOptions;
}

std::vector<std::filesystem::path> ImportOptions::files() const {
  std::vector<std::filesystem::path> out;
  for (const std::string& file : {poses, times, labels}) {
    if (!file.empty()) out.emplace_back(file);
  }
  for (const std::string& sensor : {deskew, infer_misses}) {
    if (std::filesystem::is_regular_file(sensor)) out.emplace_back(sensor);
  }
  return out;
}

}  // namespace underbrush::pipeline
