#include "underbrush/perception/mover_score.hpp"

#include <algorithm>

namespace underbrush::perception {
namespace {

constexpr double kMovedM = 1, kMarginM = 0.1;
constexpr double kClearM = 0.4;  // above the bottom of a box, where the ground is not

struct Track {
  Vec3 first;
  double moved_m = 0;
};

// The scans of a log, with the rows of each.
template <class See>
void each_scan(BeamSource& log, See&& see) {
  log.rewind();
  size_t row = 0;
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t begin = 0, end = 0; begin < chunk.size(); begin = end) {
      while (end < chunk.size() && chunk.scan[end] == chunk.scan[begin]) ++end;
      see(chunk, begin, end, row + begin);
    }
    row += chunk.size();
  }
}

bool is_in(const TruthObject& object, const Vec3& point) {
  const Vec3 at = object.box.to_box(point), half = object.box.size_m / 2;
  return ((at.cwiseAbs() - half).array() < kMarginM).all() && at.z() > kClearM - half.z();
}

}  // namespace

MoverScore score_movers(BeamSource& log, const std::vector<uint8_t>& mark, const LogTruth& truth) {
  std::map<uint64_t, Track> tracks;
  TruthFrame frame;
  std::map<uint32_t, double> time_of_scan;
  for (const ScanInfo& s : log.info().scans) time_of_scan[s.scan] = s.time_s;
  const auto fill = [&](const BeamLog& chunk, size_t begin) {
    const uint32_t scan = chunk.scan[begin];
    const auto known = time_of_scan.find(scan);
    truth.at(scan, known == time_of_scan.end() ? chunk.time_s[begin] : known->second, 0.2, frame);
  };
  each_scan(log, [&](const BeamLog& chunk, size_t begin, size_t, size_t) {
    fill(chunk, begin);
    for (const TruthObject& o : frame.objects) {
      Track& t = tracks.try_emplace(o.id, Track{o.box.centre_m}).first->second;
      t.moved_m = std::max(t.moved_m, (o.box.centre_m - t.first).norm());
    }
  });
  MoverScore out;
  std::map<uint64_t, MarkedReturns*> seen;
  each_scan(log, [&](const BeamLog& chunk, size_t begin, size_t end, size_t row) {
    fill(chunk, begin);
    for (const TruthObject& o : frame.objects) {
      auto& by_class = tracks.at(o.id).moved_m > kMovedM ? out.moving : out.standing;
      MarkedReturns& counts = by_class[std::string(name(o.label))];
      if (seen.try_emplace(o.id, &counts).second) ++counts.objects;
    }
    for (size_t i = begin; i < end; ++i) {
      if (!chunk.is_hit(i)) continue;
      const Vec3 point = chunk.end_point(i);
      const auto object = std::ranges::find_if(
          frame.objects, [&](const TruthObject& o) { return is_in(o, point); });
      MarkedReturns& counts = object == frame.objects.end() ? out.elsewhere : *seen.at(object->id);
      ++counts.returns;
      counts.marked += mark[row + i - begin] != 0;
    }
  });
  return out;
}

}  // namespace underbrush::perception
