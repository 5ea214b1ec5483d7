#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "studies/primitives.hpp"
#include "studies/site_drive.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

constexpr double kTrainM = 10, kTestM = 5, kApartM = 100;

/// Scans a generated site along its track; every `every`-th scan is taken, with its true labels.
BeamLog drive_through(uint64_t seed, bool quick) {
  test_site::SiteParameters parameters;
  parameters.seed = seed;
  if (quick) {
    parameters.terrain.size_x_m = parameters.terrain.size_y_m = 20;
    parameters.trees = 6;
    parameters.shrubs = 20;
    parameters.tussocks_per_m2 = parameters.mowed_per_m2 = 0.5;
  }
  const uint32_t every = quick ? 8 : 10;
  const GeneratedSite site(parameters);
  SiteDrive drive(site, sensor::load(quick ? "velodyne-vlp16" : "velodyne-hdl32e"), seed);
  BeamLog out;
  out.info = drive.info();
  for (BeamLog chunk; drive.next(chunk);) {
    BeamLog part = chunk.like();
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (chunk.scan[i] % every == 0) part.append(chunk, i);
    }
    drive.answer(out.size(), part);
    out.append(part, 0, part.size());
  }
  std::erase_if(out.info.scans, [&](const ScanInfo& s) { return s.scan % every != 0; });
  return out;
}

}  // namespace

SitePair generated_pair(uint64_t train_seed, uint64_t test_seed, bool quick) {
  return {fmt::format("sites {} and {}", train_seed, test_seed), drive_through(train_seed, quick),
          drive_through(test_seed, quick)};
}

std::vector<StretchPair> stretch_pairs(std::span<const ScanInfo> scans, double train_m,
                                       double test_m, double apart_m) {
  std::vector<double> path(scans.size(), 0);
  for (size_t k = 1; k < scans.size(); ++k) {
    path[k] = path[k - 1] +
              (scans[k].world_from_sensor.translation - scans[k - 1].world_from_sensor.translation)
                  .norm();
  }
  const auto within = [&](double begin, double length) {
    std::vector<size_t> out;
    for (size_t k = 0; k < path.size(); ++k) {
      if (path[k] >= begin && path[k] < begin + length) out.push_back(k);
    }
    return out;
  };
  const auto apart = [&](size_t a, size_t b) {
    return (scans[a].world_from_sensor.translation - scans[b].world_from_sensor.translation).norm();
  };
  std::vector<StretchPair> pairs;
  if (path.empty()) return pairs;
  for (double a = 0; a + train_m <= path.back(); a += test_m) {
    const std::vector<size_t> train = within(a, train_m);
    for (double b = 0; b + test_m <= path.back(); b += test_m) {
      const std::vector<size_t> test = within(b, test_m);
      if (train.empty() || test.empty()) continue;
      double least = INFINITY;
      for (const size_t i : train) {
        for (const size_t k : test) least = std::min(least, apart(i, k));
      }
      if (least < apart_m) continue;
      StretchPair pair{fmt::format("{:.0f} to {:.0f} m and {:.0f} to {:.0f} m, {:.1f} m apart", a,
                                   a + train_m, b, b + test_m, least),
                       {},
                       {}};
      for (const size_t i : train) pair.train.push_back(scans[i].scan);
      for (const size_t k : test) pair.test.push_back(scans[k].scan);
      pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

std::vector<fs::path> drives_of(const fs::path& data) {
  std::vector<fs::path> logs;
  if (data.empty()) return logs;
  for (const auto& entry : fs::directory_iterator(data)) {
    if (fs::exists(entry.path() / "log.ply")) logs.push_back(entry.path() / "log.ply");
  }
  std::sort(logs.begin(), logs.end());
  return logs;
}

std::vector<StretchPair> pairs_of_drive(const fs::path& log) {
  return stretch_pairs(io::LogReader(log).info().scans, kTrainM, kTestM, kApartM);
}

SitePair read_stretches(const fs::path& log, const StretchPair& stretches) {
  io::LogReader reader(log);
  SitePair pair;
  pair.name = stretches.name;
  pair.min_range_m = kVehicleM;
  pair.one_site = true;
  BeamLog* parts[] = {&pair.train, &pair.test};
  const std::vector<uint32_t>* wanted[] = {&stretches.train, &stretches.test};
  for (int k = 0; k < 2; ++k) {
    const std::set<uint32_t> scans(wanted[k]->begin(), wanted[k]->end());
    parts[k]->info = reader.info();
    std::erase_if(parts[k]->info.scans, [&](const ScanInfo& s) { return !scans.count(s.scan); });
  }
  for (BeamLog chunk; reader.next(chunk);) {
    for (size_t begin = 0, end; begin < chunk.size(); begin = end) {
      for (end = begin + 1; end < chunk.size() && chunk.scan[end] == chunk.scan[begin];) ++end;
      for (int k = 0; k < 2; ++k) {
        if (std::count(wanted[k]->begin(), wanted[k]->end(), chunk.scan[begin])) {
          parts[k]->append(chunk, begin, end);
        }
      }
    }
  }
  for (BeamLog* part : parts) label_log(*part, kVehicleM);
  return pair;
}

}  // namespace underbrush::studies
