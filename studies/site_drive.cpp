#include "studies/site_drive.hpp"

namespace underbrush::studies {

SiteDrive::SiteDrive(const GeneratedSite& site, const sensor::Sensor& sensor, uint64_t seed)
    : site_(site),
      pattern_(sensor, site.site.world_from_sensor,
               site.site.world_from_sensor.poses().front().time_s,
               site.site.world_from_sensor.poses().back().time_s, 1 << 18) {
  beam_.seed = seed;
  beam_.shape = sensor.beam;
  beam_.range_sigma_m = sensor.range_sigma_m;
  beam_.element_ids = true;
}

LogInfo SiteDrive::info() const {
  LogInfo info = pattern_.info();
  info.has_misses = true;
  info.classes = "underbrush";
  return info;
}

void SiteDrive::answer(size_t first, BeamLog& beams) const {
  simulate::scan(site_.world, site_.flat.label, beam_, first, beams);
  auto& element = std::get<std::vector<uint32_t>>(beams.extra.at("element"));
  for (uint32_t& e : element) e = e < site_.flat.instance.size() ? site_.flat.instance[e] : 0;
  beams.extra["instance"] = std::move(element);
  beams.extra.erase("element");
}

}  // namespace underbrush::studies
