#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "osi_actions.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/trace.hpp"

namespace underbrush::app {
namespace {

// What a trace holds, summed over its messages.
struct TraceContents {
  size_t messages = 0, bytes = 0, most_moving = 0, stationary = 0, lanes = 0, lidars = 0;
  size_t reflections = 0, returns = 0, detections = 0, logical = 0, objects = 0, listed = 0;
  size_t stands = 0;  // Messages whose time is not later than that of the one before.
  std::optional<double> first_s, last_s;
  std::set<std::string> versions;
  std::optional<uint64_t> host;
  std::set<uint64_t> moving, tracks;

  void add(const std::optional<osi::Version>& v, const std::optional<osi::Timestamp>& t) {
    ++messages;
    versions.insert(v ? fmt::format("{}.{}.{}", v->major, v->minor, v->patch) : "none");
    if (!t) return;
    if (!first_s) first_s = t->s();
    if (last_s && t->s() <= *last_s) ++stands;
    last_s = t->s();
  }
  void add(const osi::GroundTruth& t) {
    if (t.host_vehicle_id) host = t.host_vehicle_id;
    most_moving = std::max(most_moving, t.moving.size());
    stationary = std::max(stationary, t.stationary.size());
    lanes = std::max<size_t>(lanes, t.lanes);
    for (const osi::MovingObject& m : t.moving) moving.insert(m.id);
  }
  void add(const osi::SensorView& v) {
    if (v.truth) add(*v.truth);
    if (v.host_vehicle_id) host = v.host_vehicle_id;
    lidars = std::max(lidars, v.lidar.size());
    for (const osi::LidarSensorView& l : v.lidar) {
      reflections += l.reflections.size();
      returns += size_t(std::count_if(l.reflections.begin(), l.reflections.end(),
                                      [](const osi::Reflection& f) { return !f.is_miss(); }));
    }
  }
  void add(const osi::SensorData& d) {
    for (const auto& view : d.views) add(*view);
    for (const osi::LidarDetectionData& l : d.lidar) detections += l.detections.size();
    lidars = std::max(lidars, d.lidar.size());
    if (d.logical) logical += d.logical->detections.size();
    objects += d.objects.size();
    for (const osi::DetectedObject& o : d.objects) tracks.insert(o.tracking_id);
    listed += d.object_header.has_value();
  }
};

TraceContents contents_of(osi::TraceReader& reader) {
  TraceContents c;
  for (std::string message; reader.next(message);) {
    c.bytes += message.size();
    if (reader.type() == osi::MessageType::kGroundTruth) {
      const osi::GroundTruth t = osi::read_ground_truth(message, reader.place());
      c.add(t.version, t.timestamp);
      c.add(t);
    } else if (reader.type() == osi::MessageType::kSensorView) {
      const osi::SensorView v = osi::read_sensor_view(message, reader.place());
      c.add(v.version, v.timestamp);
      c.add(v);
    } else {
      const osi::SensorData d = osi::read_sensor_data(message, reader.place());
      c.add(d.version, d.timestamp);
      c.add(d);
    }
  }
  return c;
}

Json json_of(const TraceContents& c, osi::MessageType type) {
  Json j;
  j["message"] = osi::name(type);
  j["messages"] = c.messages;
  j["bytes"] = c.bytes;
  j["versions"] = c.versions;
  if (c.first_s) j["first_s"] = *c.first_s;
  if (c.last_s) j["last_s"] = *c.last_s;
  j["times_that_do_not_ascend"] = c.stands;
  if (c.host) j["host_vehicle_id"] = *c.host;
  j["moving_objects"] = c.moving.size();
  j["most_moving_objects"] = c.most_moving;
  j["stationary_objects"] = c.stationary;
  j["lanes"] = c.lanes;
  j["lidars"] = c.lidars;
  j["reflections"] = c.reflections;
  j["returns"] = c.returns;
  if (type == osi::MessageType::kSensorData) {
    j["detections"] = c.detections;
    j["logical_detections"] = c.logical;
    j["object_lists"] = c.listed;
    j["objects"] = c.objects;
    j["tracks"] = c.tracks.size();
  }
  return j;
}

}  // namespace

void osi_info(const Verb& verb, const OsiArguments& a) {
  osi::TraceReader reader(a.input);
  const TraceContents c = contents_of(reader);
  std::string versions;
  for (const std::string& v : c.versions) versions += (versions.empty() ? "" : ", ") + v;
  std::string text =
      fmt::format("{} {} messages, OSI {}\n", c.messages, osi::name(reader.type()), versions);
  if (c.first_s) text += fmt::format("  time        {:.3f} to {:.3f} s\n", *c.first_s, *c.last_s);
  if (c.stands) text += fmt::format("  standing    {} times do not ascend\n", c.stands);
  if (c.host) text += fmt::format("  host        {}\n", *c.host);
  text += fmt::format("  truth       {} moving objects, {} stationary, {} lanes\n", c.moving.size(),
                      c.stationary, c.lanes);
  if (c.reflections) {
    text += fmt::format("  lidar       {} rays, {} returns, {} sensors\n", c.reflections, c.returns,
                        c.lidars);
  }
  if (reader.type() == osi::MessageType::kSensorData) {
    text += fmt::format("  detections  {} of lidars, {} in the vehicle's frame\n", c.detections,
                        c.logical);
    text += fmt::format("  objects     {} in {} lists, {} tracks\n", c.objects, c.listed,
                        c.tracks.size());
  }
  verb.report(json_of(c, reader.type()), text);
}

}  // namespace underbrush::app
