#include <algorithm>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/strategies.hpp"
#include "underbrush/perception/classification.hpp"

namespace underbrush::osi {
namespace {

using perception::ClassEvidence;
using perception::TrackedObject;

/// Estimates the class of each object from its size, speed and points, or keeps those of tracking.
class ClassificationStep : public Strategy {
 public:
  ClassificationStep(bool from_points, const perception::ClassificationOptions& options)
      : from_points_(from_points), classification_(options, {}) {}

  void step(SensorData& data) override {
    require_data(data.object_header.has_value(),
                 "classification: there are no objects; run tracking before");
    if (!from_points_) return;
    const perception::ObjectList list = list_of(data);
    const Pose world = world_from_virtual(data);
    std::map<uint64_t, ClassEvidence> next;
    for (DetectedObject& d : data.objects) {
      const auto o = std::find_if(list.objects.begin(), list.objects.end(),
                                  [&](const TrackedObject& t) { return t.id == d.tracking_id; });
      const auto before = evidence_.find(d.tracking_id);
      ClassEvidence& evidence = next[d.tracking_id];
      if (before != evidence_.end()) evidence = before->second;
      perception::SegmentShape shape;
      shape.box = o->box;
      shape.viewpoint_m = o->box.to_box(world.translation);
      shape.points = points_in(data, world, o->box);
      if (shape.points > 0) {
        classification_.observe(shape, o->velocity_m_s.norm(), evidence);
      }
      d.candidates.clear();
      const auto probability = classification_.probabilities(evidence);
      for (size_t c = 1; c < probability.size(); ++c) {
        d.candidates.push_back(candidate_of(perception::ObjectClass(c), double(probability[c])));
      }
      std::stable_sort(d.candidates.begin(), d.candidates.end(),
                       [](const auto& a, const auto& b) { return a.probability > b.probability; });
    }
    evidence_ = std::move(next);
  }
  void reset() override { evidence_.clear(); }
  std::unique_ptr<Strategy> clone() const override {
    return std::make_unique<ClassificationStep>(*this);
  }

 private:
  static uint32_t points_in(const SensorData& data, const Pose& world,
                            const perception::OrientedBox& box) {
    if (!data.logical) return 0;
    uint32_t count = 0;
    for (const LogicalDetection& l : data.logical->detections) {
      const Vec3 p = box.to_box(world * l.position_m).cwiseAbs();
      count +=
          p.x() <= box.size_m.x() / 2 && p.y() <= box.size_m.y() / 2 && p.z() <= box.size_m.z() / 2;
    }
    return count;
  }

  bool from_points_;
  perception::Classification classification_;
  std::map<uint64_t, ClassEvidence> evidence_;
};

}  // namespace

std::unique_ptr<Strategy> make_classification(Parameters& p) {
  const bool from_points = p.choice("from", {"tracking", "points"}) == 1;
  perception::ClassificationOptions o;
  o.memory = p.number("memory", o.memory, 0, 1);
  o.half_points = p.number("half_points", o.half_points, 1e-3, 1e6);
  return std::make_unique<ClassificationStep>(from_points, o);
}

}  // namespace underbrush::osi
