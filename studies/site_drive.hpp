/// A lidar that is driven through a generated site.
#pragma once
#include "underbrush/test_site/test_site.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/footprint.hpp"

namespace underbrush::studies {

/// A site, ready to be scanned.
struct GeneratedSite {
  explicit GeneratedSite(const test_site::SiteParameters& parameters)
      : site(test_site::make_site(parameters)), flat(test_site::flatten(site)), world(flat.model) {}
  test_site::Site site;
  test_site::FlatSite flat;
  trace::World world;
};

/// The beams of a sensor along the site's track, in chunks. The site must outlive it.
class SiteDrive {
 public:
  SiteDrive(const GeneratedSite& site, const sensor::Sensor& sensor, uint64_t seed);

  /// Of a log that keeps misses; its classes are ours.
  LogInfo info() const;
  /// The next beams, not answered yet; false at the end.
  bool next(BeamLog& beams) { return pattern_.next(beams); }
  /// Answers beams, with the true `class` and `instance` of each hit. `first` numbers the first of
  /// them for the random numbers.
  void answer(size_t first, BeamLog& beams) const;

 private:
  const GeneratedSite& site_;
  sensor::PatternSource pattern_;
  simulate::FootprintOptions beam_;
};

}  // namespace underbrush::studies
