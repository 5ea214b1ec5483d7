#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "underbrush/io/json_text.inl"
#include "underbrush/perception/grid_file.hpp"
#include "underbrush/pipeline/reports_json.inl"

namespace underbrush::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using perception::CellLabel;

Json json_of(const perception::ValueErrors& e) {
  Json j;
  j["cycles"] = e.cycles;
  for (size_t k = 0; k < perception::kComparedValues.size(); ++k) {
    j["rmse_m"][perception::kComparedValues[k]] = io::finite_or_null(e.rmse_m[k]);
    j["normalised"][perception::kComparedValues[k]] = io::finite_or_null(e.normalised[k]);
  }
  return j;
}

Json json_of(const GridSummary& g) {
  const auto area = [&](CellLabel label) { return g.area_m2[size_t(label)]; };
  return {{"cycles", g.cycles},
          {"free_m2", area(CellLabel::kFree)},
          {"permeable_m2", area(CellLabel::kPermeable)},
          {"solid_m2", area(CellLabel::kSolid)},
          {"unknown_m2", area(CellLabel::kUnknown)},
          {"seconds", g.seconds}};
}

}  // namespace

Json json_of(const perception::ListScore& s) {
  Json j;
  j["cycles"] = s.cycles;
  j["objects"] = s.objects;
  j["found"] = s.found;
  j["detection_rate"] = double(s.found) / double(std::max<size_t>(s.objects, 1));
  j["unmatched"] = s.unmatched;
  j["id_switches"] = s.switches;
  j["position_mean_m"] = s.position_mean_m;
  j["position_rms_m"] = s.position_rms_m;
  j["yaw_mean_deg"] = s.yaw_mean_rad * 180 / M_PI;
  j["ospa_m"] = s.ospa_m;
  j["hota"] = s.hota.hota;
  j["hota_detection"] = s.hota.detection;
  j["hota_association"] = s.hota.association;
  for (const auto& bin : s.by_range) {
    j["by_range"].push_back(
        {{"from_m", bin.from_m}, {"objects", bin.objects}, {"found", bin.found}});
  }
  for (const auto& followed : s.followed) {
    Json o{{"id", followed.id}, {"class", perception::name(followed.label)}};
    for (const auto& m : followed.moments) {
      o["time"].push_back(m.time_s);
      o["existence"].push_back(m.found ? m.found->existence : 0);
    }
    j["followed"].push_back(o);
  }
  return j;
}

Json json_of(std::span<const perception::ComparedObject> objects) {
  Json j = Json::array();
  for (const perception::ComparedObject& o : objects) {
    j.push_back({{"id", o.id},
                 {"class", perception::name(o.label)},
                 {"simulated_real", json_of(o.simulated_real)},
                 {"simulated_truth", json_of(o.simulated_truth)},
                 {"real_truth", json_of(o.real_truth)}});
  }
  return j;
}

Json json_of(const Perceived& perceived) {
  const perception::PerceivedLog& p = perceived.log;
  Json j;
  j["cycles"] = p.lists.size();
  j["points"] = p.points;
  size_t objects = 0;
  for (const auto& list : p.lists) objects += list.objects.size();
  j["objects"] = objects;
  j["seconds"] = p.seconds;
  if (!p.truth.empty()) {
    j["truth"] = json_of(perception::score_lists(p.lists, p.truth));
  }
  if (perceived.grid) j["grid"] = json_of(*perceived.grid);
  return j;
}

Json json_of(const osi::TraceContents& c, osi::MessageType type) {
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

}  // namespace underbrush::pipeline
