#include <algorithm>
#include <map>
#include <utility>

#include "underbrush/actors/learn_actors.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/movers/find_movers.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/perception/perceive_options.hpp"

namespace underbrush::actors {
namespace {

using perception::SeenBox;

constexpr double kLeastWayM = 1, kLeastShare = 0.5;

struct Count {
  size_t returns = 0, moved = 0;
};

bool has_marks(BeamSource& log) {
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    if (std::ranges::any_of(chunk.flags, [](uint8_t f) { return (f & kMover) != 0; })) return true;
  }
  return false;
}

/// Gives each box the mean time of the returns of its scan that lie in it, because a real pipeline
/// takes all points of a cycle for those of one time. Boxes without returns are left out.
std::vector<SeenBox> at_times_of_returns(BeamSource& log, const std::vector<SeenBox>& boxes) {
  std::map<uint32_t, std::vector<size_t>> of_scan;
  for (size_t k = 0; k < boxes.size(); ++k) of_scan[boxes[k].scan].push_back(k);
  std::vector<std::pair<double, size_t>> sum(boxes.size());
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      const auto here = of_scan.find(chunk.scan[i]);
      if (here == of_scan.end() || !chunk.is_hit(i)) continue;
      const Vec3 end = chunk.end_point(i);
      for (const size_t k : here->second) {
        const perception::OrientedBox& box = boxes[k].object.box;
        if (((box.to_box(end).cwiseAbs() - box.size_m / 2).array() > 0).any()) continue;
        sum[k].first += chunk.time_s[i];
        ++sum[k].second;
      }
    }
  }
  std::vector<SeenBox> out;
  for (size_t k = 0; k < boxes.size(); ++k) {
    if (sum[k].second == 0) continue;
    out.push_back(boxes[k]);
    out.back().time_s = sum[k].first / double(sum[k].second);
  }
  return out;
}

/// Counts the returns of each track, and those that moved.
std::vector<Count> counts_of(BeamSource& log, const std::vector<Track>& tracks,
                             const BoxOptions& options) {
  const std::vector<uint8_t> marks =
      has_marks(log) ? std::vector<uint8_t>() : movers::find_movers(log);
  BoxesOfBeams boxes(tracks, options);
  std::vector<Count> out(tracks.size());
  size_t row = 0;
  log.rewind();
  for (BeamLog chunk; log.next(chunk); row += chunk.size()) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      const auto track = boxes.track_of_return(chunk, i);
      if (!track) continue;
      ++out[*track].returns;
      out[*track].moved += marks.empty() ? (chunk.flags[i] & kMover) != 0 : marks[row + i] != 0;
    }
  }
  return out;
}

}  // namespace

std::vector<Track> find_tracks(BeamSource& log, const ActorOptions& options) {
  perception::PerceiveOptions perceive;
  perceive.pipeline = "real";
  const perception::PerceivedLog perceived =
      perception::perceived(log, nullptr, perception::setup_of(perceive));
  std::vector<Track> tracks =
      tracks_of(at_times_of_returns(log, boxes_of(perceived.lists, log.info())));
  const std::vector<Count> counts = counts_of(log, tracks, options.boxes);
  std::vector<Track> out;
  for (size_t k = 0; k < tracks.size(); ++k) {
    const Vec3 way =
        tracks[k].seen.back().object.box.centre_m - tracks[k].seen.front().object.box.centre_m;
    const bool moved = double(counts[k].moved) >= kLeastShare * double(counts[k].returns);
    if (moved && counts[k].returns >= options.least_returns && way.norm() >= kLeastWayM) {
      out.push_back(std::move(tracks[k]));
    }
  }
  return out;
}

std::vector<Track> tracks_of_log(BeamSource& log, const std::string& file,
                                 const std::filesystem::path& boxes, const ActorOptions& options) {
  std::vector<Track> tracks;
  if (boxes.empty()) {
    tracks = find_tracks(log, options);
  } else if (perception::is_labelled_box_file(boxes)) {
    tracks = tracks_of(
        perception::LogTruth(boxes, log.info(), {options.boxes_elevation_deg * kDegree}).seen());
  } else {
    tracks = tracks_of(boxes_of(osi::read_lists(boxes), log.info()));
  }
  if (tracks.empty()) throw FormatError(file, "", "there is no track of anything that moved");
  return tracks;
}

}  // namespace underbrush::actors
