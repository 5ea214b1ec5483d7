#include "studies/extrapolation.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::studies {
namespace {

constexpr double kStretchM = 30, kEveryM = 50, kLeastStretchM = 3;
constexpr int kBeyondM[] = {5, 10, 20};
constexpr double kWithinM = 1;  // m; of the distance beyond.
constexpr double kNearM = 3, kEarlierM = 50;

Continuation continuation(const Path& path, double from_m, double to_m) {
  Continuation out;
  std::vector<std::pair<double, uint32_t>> between;
  size_t inside = 0;
  for (size_t k = 0; k < path.scan.size(); ++k) {
    const double at = path.at_m[k];
    if (at >= from_m && at <= to_m) {
      if (inside++ % 2 == 0) {
        out.train.push_back(path.scan[k]);
      } else {
        between.emplace_back(std::abs(at - 0.5 * (from_m + to_m)), path.scan[k]);
      }
    }
    for (const int beyond : kBeyondM) {
      if (std::abs(at - to_m - beyond) <= kWithinM) out.beyond[beyond].push_back(path.scan[k]);
    }
  }
  std::sort(between.begin(), between.end());
  for (size_t k = 0; k < std::min<size_t>(3, between.size()); ++k) {
    out.inside.push_back(between[k].second);
  }
  std::sort(out.inside.begin(), out.inside.end());
  return out;
}

}  // namespace

Path path_of(std::span<const ScanInfo> scans) {
  Path out;
  for (const ScanInfo& s : scans) {
    const Vec3& place = s.world_from_sensor.translation;
    const double step = out.place.empty() ? 0 : (place - out.place.back()).norm();
    out.at_m.push_back(out.at_m.empty() ? 0 : out.at_m.back() + step);
    out.place.push_back(place);
    out.scan.push_back(s.scan);
  }
  return out;
}

std::vector<Continuation> continuations(const Path& path) {
  std::vector<Continuation> out;
  if (path.at_m.empty()) return out;
  const double length = path.at_m.back();
  if (length < kStretchM + kBeyondM[0]) {
    const double end = length - kBeyondM[0] - 0.5;
    if (end >= kLeastStretchM) out.push_back(continuation(path, 0, end));
    return out;
  }
  for (double from = 0; from + kStretchM + kBeyondM[0] <= length; from += kEveryM) {
    out.push_back(continuation(path, from, from + kStretchM));
  }
  return out;
}

std::optional<SecondPass> second_pass(const Path& path) {
  SecondPass out;
  size_t first = path.scan.size();
  for (size_t k = 0; k < path.scan.size(); ++k) {
    for (size_t j = 0; j < k && path.at_m[k] - path.at_m[j] >= kEarlierM; ++j) {
      if ((path.place[k] - path.place[j]).norm() > kNearM) continue;
      first = std::min(first, k);
      out.test.push_back(path.scan[k]);
      break;
    }
  }
  if (out.test.empty()) return std::nullopt;
  out.train.assign(path.scan.begin(), path.scan.begin() + std::ptrdiff_t(first));
  return out;
}

}  // namespace underbrush::studies
