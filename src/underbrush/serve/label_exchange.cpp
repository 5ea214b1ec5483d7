// Labels from other files and into them, and from one scan to another.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/kd_tree.inl"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/perception/object_list_file.hpp"
#include "underbrush/perception/truth.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/given_labels.hpp"
#include "underbrush/serve/label_sets.hpp"
#include "underbrush/serve/labels_of_file.hpp"

namespace underbrush::serve {
namespace {

constexpr size_t kMostSource = 5'000'000;

// Calls `visit(row, log, i)` for each row of a log, which has so many as there are labels.
template <class Visit>
void for_each_row(const std::filesystem::path& path, size_t rows, const Visit& visit) {
  const io::Input input = io::open_input(path);
  uint32_t row = 0;
  for (BeamLog chunk; input.beams->next(chunk);) {
    require_data(chunk.size() <= rows - row, "the log has changed since it was opened");
    for (size_t i = 0; i < chunk.size(); ++i) visit(row++, chunk, i);
  }
}

Vec3 vector_of(const nlohmann::json& list) {
  return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

// The mean of times, s.
struct Times {
  double sum = 0;
  uint64_t count = 0;

  void add(double time_s) {
    sum += time_s;
    ++count;
  }
  double mean() const { return sum / double(count); }
};

// A box of a track, and the times of its returns.
struct TrackBox {
  uint64_t track;
  perception::ObjectClass label;
  perception::OrientedBox box;
  Times times = {};
};

TrackBox track_box_of(const nlohmann::json& j) {
  const Vec3 low = vector_of(j["min_m"]), high = vector_of(j["max_m"]);
  const double yaw = j["yaw_rad"].get<double>();
  const perception::OrientedBox foot{vector_of(j["position_m"]), yaw, {}};
  return {j["track"].get<uint64_t>(),
          perception::class_of_name(j["class"].get<std::string>()).value(),
          {foot.from_box((low + high) / 2), yaw, high - low}};
}

}  // namespace

EditResult LabelsOfFile::import(uint64_t revision, const std::filesystem::path& from,
                                const std::string& set, bool only_unlabelled,
                                const Selection& selection) {
  const std::lock_guard lock(mutex_);
  know(revision);
  require(octree_ != nullptr, "this file has no points");
  const io::Input input = io::open_input(file_.path);
  primitives::GivenLabelOptions options;
  options.set = set;
  const primitives::GivenLabels given = primitives::read_given_labels(from, *input.beams, options);
  const std::vector<uint32_t>& values = document_->values();
  const std::string& own = document_->facts().set;
  LabelChange change;
  change.everywhere = true;
  change.name = "labels of " + printable(from.filename().string(), 80);
  size_t hit = 0;
  for_each_row(file_.path, values.size(), [&](uint32_t row, const BeamLog& log, size_t i) {
    if (!log.is_hit(i)) return;
    const size_t k = hit++;
    LabelValue value = LabelValue::of(values[row]);
    if (!selection.admits(value) || (only_unlabelled && value.label != 0)) return;
    if (!given.label.empty()) {
      const auto number = label_in_set(given.set, given.label[k], own);
      value.label = number ? place_in_set(own, *number).value_or(0) : 0;
    }
    if (!given.instance.empty()) {
      value.instance = given.instance[k] <= kMostInstance ? given.instance[k] : 0;
    }
    change.add(row, values[row], value.bits());
  });
  return apply(change);
}

LabelSource LabelsOfFile::source(std::optional<uint32_t> scan) {
  const std::lock_guard lock(mutex_);
  const std::vector<uint32_t>& values = document().values();
  require(octree_ != nullptr, "this file has no points");
  LabelSource out;
  for_each_row(file_.path, values.size(), [&](uint32_t row, const BeamLog& log, size_t i) {
    if (!log.is_hit(i) || (scan && log.scan[i] != *scan)) return;
    if (LabelValue::of(values[row]).label == 0) return;
    require(out.points.size() < kMostSource, "more than 5 000 000 labelled points: choose a scan");
    out.points.push_back(log.end_point(i));
    out.values.push_back(values[row] & ~128u);
  });
  return out;
}

EditResult LabelsOfFile::carry(uint64_t revision, const LabelSource& source,
                               std::optional<uint32_t> scan, double radius_m) {
  const std::lock_guard lock(mutex_);
  know(revision);
  require(octree_ != nullptr, "this file has no points");
  require(radius_m > 0 && radius_m <= 100, "a radius of up to 100 m");
  require(!source.points.empty(), "the source has no labels");
  const auto coordinate = [&](size_t i, size_t axis) {
    return source.points[i][Eigen::Index(axis)];
  };
  const KdTree tree(source.points.size(), coordinate, 16);
  const std::vector<uint32_t>& values = document_->values();
  LabelChange change;
  change.everywhere = true;
  change.name = "labels carried over";
  for_each_row(file_.path, values.size(), [&](uint32_t row, const BeamLog& log, size_t i) {
    if (!log.is_hit(i) || (scan && log.scan[i] != *scan)) return;
    LabelValue value = LabelValue::of(values[row]);
    if (value.label != 0) return;
    const Vec3 at = log.end_point(i);
    uint32_t nearest = 0;
    double distance2 = 0;
    if (tree.nearest(at.data(), 1, &nearest, &distance2) == 0 || distance2 > radius_m * radius_m) {
      return;
    }
    const LabelValue found = LabelValue::of(source.values[nearest]);
    value.label = found.label;
    value.instance = found.instance;
    change.add(row, values[row], value.bits());
  });
  return apply(change);
}

void LabelsOfFile::write_log(const std::filesystem::path& path) {
  const std::lock_guard lock(mutex_);
  const std::vector<uint32_t>& values = document().values();
  require(octree_ != nullptr, "this file has no points");
  const auto labels = elements::labels_of(document_->facts().set);
  const bool bytes = std::all_of(labels.begin(), labels.end(),
                                 [](const elements::Label& l) { return l.number < 256; });
  const io::Input input = io::open_input(file_.path);
  LogInfo info = input.beams->info();
  info.classes = document_->facts().set;
  io::LogWriter writer(path, info, input.provenance);
  size_t row = 0;
  for (BeamLog chunk; input.beams->next(chunk);) {
    require_data(chunk.size() <= values.size() - row, "the log has changed since it was opened");
    std::vector<uint16_t> label(chunk.size());
    std::vector<uint32_t> instance(chunk.size());
    for (size_t i = 0; i < chunk.size(); ++i, ++row) {
      const LabelValue value = LabelValue::of(values[row]);
      label[i] = uint16_t(labels[value.label].number);
      instance[i] = value.instance;
    }
    chunk.info.classes = info.classes;
    if (bytes) {
      chunk.extra["class"] = std::vector<uint8_t>(label.begin(), label.end());
    } else {
      chunk.extra["class"] = std::move(label);
    }
    chunk.extra["instance"] = std::move(instance);
    writer.write(chunk);
  }
  writer.close();
}

uint64_t LabelsOfFile::write_label_file(const std::filesystem::path& path, const std::string& set) {
  const std::lock_guard lock(mutex_);
  const std::vector<uint32_t>& values = document().values();
  require(octree_ != nullptr, "this file has no points");
  const std::string& own = document_->facts().set;
  const auto labels = elements::labels_of(own);
  std::vector<std::optional<uint32_t>> number;
  for (const elements::Label& label : labels) {
    number.push_back(label_in_set(own, label.number, set));
  }
  uint64_t without = 0;
  std::vector<uint32_t> out(values.size());
  for (size_t row = 0; row < values.size(); ++row) {
    const LabelValue value = LabelValue::of(values[row]);
    require(value.instance <= 65535, "the format holds instances up to 65 535 only");
    without += !number[value.label];
    out[row] = number[value.label].value_or(0) | value.instance << 16;
  }
  io::write_atomically(path,
                       std::string_view(reinterpret_cast<const char*>(out.data()), 4 * out.size()));
  return without;
}

size_t LabelsOfFile::write_tracks(const std::filesystem::path& path) {
  const std::lock_guard lock(mutex_);
  std::map<uint32_t, std::vector<TrackBox>> boxes;
  for (const auto& [number, text] : document().boxes()) {
    const auto j = nlohmann::json::parse(text);
    if (j.contains("track")) boxes[j["scan"].get<uint32_t>()].push_back(track_box_of(j));
  }
  require(octree_ != nullptr, "this file has no points");
  require(!boxes.empty(), "no box is of a track");
  std::map<uint32_t, Times> scans;
  std::vector<TrackBox>* here = nullptr;
  Times* scan = nullptr;
  std::optional<uint32_t> last;
  for_each_row(file_.path, document_->values().size(), [&](uint32_t, const BeamLog& log, size_t i) {
    if (last != log.scan[i]) {
      last = log.scan[i];
      const auto found = boxes.find(*last);
      here = found == boxes.end() ? nullptr : &found->second;
      if (here) scan = &scans[*last];
    }
    if (!here) return;
    scan->add(log.time_s[i]);
    if (!log.is_hit(i)) return;
    const Vec3 end = log.end_point(i);
    for (TrackBox& b : *here) {
      const Vec3 inside = b.box.to_box(end).cwiseAbs() - b.box.size_m / 2;
      if (inside.maxCoeff() <= 0) b.times.add(log.time_s[i]);
    }
  });
  std::map<double, perception::TruthFrame> frames;
  size_t count = 0;
  for (const auto& [number, of_scan] : boxes) {
    require(scans.contains(number), "a box is of a scan that the log does not have");
    for (const TrackBox& b : of_scan) {
      const double time_s = (b.times.count > 0 ? b.times : scans[number]).mean();
      frames[time_s].time_s = time_s;
      frames[time_s].objects.push_back({b.track, b.label, b.box});
      ++count;
    }
  }
  std::vector<perception::ObjectList> lists;
  lists.reserve(frames.size());
  for (const auto& [time_s, frame] : frames) {
    lists.push_back(perception::list_of_truth(frame, Pose()));
  }
  perception::write_object_lists(path, lists, "{}");
  return count;
}

size_t LabelsOfFile::write_boxes(const std::filesystem::path& path,
                                 const std::filesystem::path& ground) {
  const std::lock_guard lock(mutex_);
  primitives::Annotation annotation;
  annotation.ground = ground;
  annotation.provenance = nlohmann::json{{"program", "underbrush serve"}}.dump();
  for (const auto& [number, text] : document().boxes()) {
    const auto j = nlohmann::json::parse(text);
    if (j.contains("track")) continue;
    primitives::PlacedObject object;
    object.label = elements::class_from_name(j["class"].get<std::string>()).value();
    object.position = vector_of(j["position_m"]);
    object.yaw_rad = j["yaw_rad"].get<double>();
    object.box = {vector_of(j["min_m"]), vector_of(j["max_m"])};
    object.instance = number;
    annotation.objects.push_back(object);
  }
  require(!annotation.objects.empty(), "there is no box");
  primitives::write_annotation(path, annotation);
  return annotation.objects.size();
}

}  // namespace underbrush::serve
