#include "underbrush/perception/truth.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/perception/object_csv.hpp"

namespace underbrush::perception {
namespace {

constexpr double kSameTimeS = 1e-9;

OrientedBox between(const OrientedBox& a, const OrientedBox& b, double s) {
  return {a.centre_m + s * (b.centre_m - a.centre_m),
          wrapped(a.yaw_rad + s * wrapped(b.yaw_rad - a.yaw_rad)),
          a.size_m + s * (b.size_m - a.size_m)};
}

const TruthObject* find(const TruthFrame& frame, uint64_t id) {
  const auto at = std::find_if(frame.objects.begin(), frame.objects.end(),
                               [id](const TruthObject& o) { return o.id == id; });
  return at == frame.objects.end() ? nullptr : &*at;
}

std::vector<TruthFrame> frames_of(std::span<const ObjectList> lists) {
  std::vector<TruthFrame> frames;
  for (const ObjectList& list : lists) {
    TruthFrame frame{list.time_s, {}};
    for (const TrackedObject& o : list.objects) frame.objects.push_back({o.id, o.label, o.box});
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// Refuses boxes whose yaws are in degrees, whose sizes are no metres, or whose cars are wider than
/// they are long.
void check_boxes(const std::filesystem::path& path, const std::vector<LabelledBox>& boxes) {
  constexpr double kMostTurn = 4 * M_PI, kLongest = 200;  // rad, m
  constexpr size_t kFewest = 3;
  size_t cars = 0, wide = 0;
  for (const LabelledBox& box : boxes) {
    const OrientedBox& b = box.object.box;
    if (std::abs(b.yaw_rad) > kMostTurn) {
      throw FormatError(path.string(), "yaw",
                        "is in radians, and none is beyond two turns: are they degrees?");
    }
    if (b.size_m.maxCoeff() > kLongest) {
      throw FormatError(path.string(), "length", "a box longer than 200 m: are sizes in m?");
    }
    if (box.object.label != ObjectClass::kCar) continue;
    ++cars;
    wide += b.size_m.x() < b.size_m.y();
  }
  if (cars < kFewest || 2 * wide < cars) return;
  throw FormatError(path.string(), "length",
                    std::to_string(wide) + " of " + std::to_string(cars) +
                        " cars are wider than long: are length and width swapped?");
}

}  // namespace

bool is_labelled_box_file(const std::filesystem::path& path) {
  if (path.extension() != ".csv") return false;
  const CsvWords csv(path);
  return csv.find("frame") && csv.find("track_id");
}

std::vector<LabelledBox> read_labelled_boxes(const std::filesystem::path& path) {
  const CsvWords csv(path);
  const size_t frame = csv.at("frame"), id = csv.at("track_id"), label = csv.at("class");
  const std::array<size_t, 7> value{csv.at("cx"),    csv.at("cy"),     csv.at("cz"),
                                    csv.at("yaw"),   csv.at("length"), csv.at("width"),
                                    csv.at("height")};
  std::vector<LabelledBox> boxes;
  for (size_t row = 0; row < csv.rows(); ++row) {
    LabelledBox box;
    const uint64_t number = csv.count(row, frame);
    if (number > UINT32_MAX) csv.fail(row, "the number of the frame is too large");
    box.frame = uint32_t(number);
    box.object.id = csv.count(row, id) + 1;
    box.object.label = class_of_name(csv.word(row, label)).value_or(ObjectClass::kOther);
    std::array<double, 7> v{};
    for (size_t k = 0; k < v.size(); ++k) v[k] = csv.number(row, value[k]);
    box.object.box = {{v[0], v[1], v[2]}, v[3], {v[4], v[5], v[6]}};
    if (!(box.object.box.size_m.minCoeff() > 0)) csv.fail(row, "a box without extent");
    boxes.push_back(box);
  }
  check_boxes(path, boxes);
  return boxes;
}

TruthSequence::TruthSequence(std::vector<TruthFrame> frames) : frames_(std::move(frames)) {
  std::sort(frames_.begin(), frames_.end(),
            [](const TruthFrame& a, const TruthFrame& b) { return a.time_s < b.time_s; });
  for (size_t k = 1; k < frames_.size(); ++k) {
    require(frames_[k].time_s > frames_[k - 1].time_s, "two frames of the truth have one time");
  }
}

TruthSequence::TruthSequence(std::span<const ObjectList> lists) : TruthSequence(frames_of(lists)) {}

void TruthSequence::at(double time_s, double tolerance_s, TruthFrame& frame) const {
  frame.time_s = time_s;
  frame.objects.clear();
  const auto after = std::lower_bound(frames_.begin(), frames_.end(), time_s - kSameTimeS,
                                      [](const TruthFrame& f, double t) { return f.time_s < t; });
  const TruthFrame* late = after == frames_.end() ? nullptr : &*after;
  if (late && late->time_s <= time_s + kSameTimeS) {
    frame.objects = late->objects;
    return;
  }
  const TruthFrame* early = after == frames_.begin() ? nullptr : &*(after - 1);
  if (early) {
    for (const TruthObject& o : early->objects) {
      const TruthObject* next = late ? find(*late, o.id) : nullptr;
      if (next) {
        const double s = (time_s - early->time_s) / (late->time_s - early->time_s);
        frame.objects.push_back({o.id, o.label, between(o.box, next->box, s)});
      } else if (time_s - early->time_s <= tolerance_s) {
        frame.objects.push_back(o);
      }
    }
  }
  if (!late || late->time_s - time_s > tolerance_s) return;
  for (const TruthObject& o : late->objects) {
    if (!early || !find(*early, o.id)) frame.objects.push_back(o);
  }
}

ObjectList list_of_truth(const TruthFrame& frame, const Pose& world_from_vehicle) {
  ObjectList list;
  list.time_s = list.available_s = frame.time_s;
  list.world_from_vehicle = world_from_vehicle;
  for (const TruthObject& t : frame.objects) {
    TrackedObject o;
    o.id = o.truth_id = t.id;
    o.label = t.label;
    o.probability[size_t(t.label)] = 1;
    o.existence = 1;
    o.is_measured = true;
    o.box = t.box;
    o.measured_size_m = t.box.size_m;
    o.reference_m = t.box.centre_m;
    list.objects.push_back(o);
  }
  std::sort(list.objects.begin(), list.objects.end(),
            [](const TrackedObject& a, const TrackedObject& b) { return a.id < b.id; });
  return list;
}

}  // namespace underbrush::perception
