// The octree of `underbrush serve`: time and memory of building one for a generated log, the bytes
// that a viewer reads before it shows a first picture, and the time of labelling with a lasso. The
// log is made while it is read, so that 10⁸ points need no file.
#include "underbrush/serve/octree.hpp"

#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "command_line.hpp"
#include "programs.hpp"
#include "timing.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/serve/label_document.hpp"
#include "underbrush/serve/selection.hpp"

namespace underbrush::bench {
namespace {

/// A vehicle's scans of a hilly ground with trees along a road of 40 m for a million points.
class Drive : public BeamSource {
 public:
  explicit Drive(size_t points) : points_(points) {
    info_.sensor = "generated";
    info_.max_range_m = 120;
    info_.has_misses = true;
  }
  const LogInfo& info() const override { return info_; }
  size_t size() const override { return points_; }
  void rewind() override { at_ = 0; }
  bool next(BeamLog& chunk) override {
    const size_t n = std::min<size_t>(size_t(1) << 20, points_ - at_);
    chunk.info = info_;
    chunk.resize(n);
    parallel_for(n, 8192, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) beam(at_ + k, k, chunk);
    });
    at_ += n;
    return n > 0;
  }

 private:
  void beam(size_t i, size_t k, BeamLog& chunk) const {
    const auto random = [&](uint32_t what) {
      return uniform_from_bits(random_bits(i, what, Purpose::kPlace));
    };
    const double along = 40e-6 * double(i), turn = 2 * M_PI * double(i % 20000) / 20000;
    const double range = 3 + 60 * random(0) * random(1);
    const Vec3 origin(along, 0, 2);
    Vec3 at(along + range * std::cos(turn), range * std::sin(turn), 0);
    at.z() = 2 * std::sin(at.x() / 30) * std::cos(at.y() / 20) + 0.02 * random(2);
    const Vec3 cell(std::floor(at.x() / 6), std::floor(at.y() / 6), 0);
    const uint64_t tree = mix64(uint64_t(int64_t(cell.x())) * 7919 + uint64_t(int64_t(cell.y())));
    if (tree % 3 == 0) at.z() += random(3) * double(tree % 7);
    const Vec3 d = at - origin;
    chunk.origin[k] = origin;
    chunk.direction[k] = d.normalized().cast<float>();
    chunk.range_m[k] = float(d.norm());
    chunk.intensity[k] = float(tree % 256);
    chunk.time_s[k] = 1e-6 * double(i);
    chunk.ring[k] = uint16_t(i % 64);
    chunk.scan[k] = uint32_t(i / 100000);
    chunk.packet[k] = uint32_t(i / 1000);
    chunk.flags[k] = 0;
  }

  size_t points_, at_ = 0;
  LogInfo info_;
};

/// Largest memory of the process so far (bytes), and its processor time (s).
struct Usage {
  size_t peak_bytes = 0;
  double processor_s = 0;
};
Usage usage_so_far() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return {size_t(u.ru_maxrss) * 1024, seconds(u.ru_utime) + seconds(u.ru_stime)};
}

/// Times of a lasso around a share of all points, with a depth limit or without.
struct LassoTimes {
  double find_s = 0, change_s = 0, keep_s = 0;
  uint64_t rows = 0, journal_bytes = 0;
};
LassoTimes lasso_times(const serve::OctreeFile& file, const std::filesystem::path& journal,
                       double depth_m) {
  const serve::NodeCubes cubes(file);
  serve::LabelFacts facts{"generated", "underbrush", cubes.rows, ""};
  serve::LabelDocument document(journal, facts, {}, file.nodes().size());
  const auto j = nlohmann::json::parse(file.json());
  const double low_x = j["low_m"][0], high_x = j["high_m"][0], side_m = high_x - low_x;
  const double middle_x = (low_x + high_x) / 2;
  serve::DrawnShape shape;  // a circle of 100 corners, as wide as 70 % of the site, from above
  shape.clip_from_point.setZero();
  shape.clip_from_point(0, 0) = shape.clip_from_point(1, 1) = 2 / side_m;
  shape.clip_from_point(0, 3) = -2 * middle_x / side_m;
  shape.clip_from_point(3, 2) = -1;
  shape.clip_from_point(3, 3) = 1000;
  shape.clip_from_point.topRows(2) *= 1000;
  shape.width_px = shape.height_px = 1000;
  for (int k = 0; k < 100; ++k) {
    const double angle = 2 * M_PI * k / 100;
    shape.path_px.emplace_back(500 + 350 * std::cos(angle), 500 + 350 * std::sin(angle));
  }
  serve::Selection selection;
  selection.drawn = shape;
  selection.depth_m = depth_m;
  serve::LabelAction action;
  action.label = 2;
  LassoTimes out;
  std::optional<serve::FoundRows> found;
  out.find_s =
      seconds_of([&] { found.emplace(find_rows(file, cubes, selection, document.values())); });
  serve::LabelChange change;
  out.change_s =
      seconds_of([&] { change = change_of(*found, selection, action, document.values()); });
  out.rows = change.size();
  out.keep_s = seconds_of([&] { document.change(change); });
  out.journal_bytes = document.journal().bytes();
  return out;
}

nlohmann::ordered_json lasso_json(const LassoTimes& t) {
  return {{"rows", t.rows},
          {"find_s", t.find_s},
          {"change_s", t.change_s},
          {"keep_s", t.keep_s},
          {"journal_bytes", t.journal_bytes}};
}

void measure_lassos(const std::filesystem::path& octree, const std::filesystem::path& folder,
                    nlohmann::ordered_json& j) {
  const TemporaryPath journals(folder, "journals");
  std::filesystem::create_directory(journals.path());
  for (const double depth_m : {0.0, 0.5}) {
    const char* name = depth_m > 0 ? "lasso_with_depth" : "lasso";
    const serve::OctreeFile file(octree);
    const LassoTimes t = lasso_times(file, journals.path() / name, depth_m);
    std::printf(
        "%s: %.1f M points found in %.2f s, change made in %.2f s, kept on disk and applied in "
        "%.2f s, %.1f MB of journal\n",
        name, double(t.rows) / 1e6, t.find_s, t.change_s, t.keep_s, double(t.journal_bytes) / 1e6);
    j[name] = lasso_json(t);
  }
}

}  // namespace

int bench_octree(int argc, char** argv) {
  CommandLine line("Building the octree of a generated log");
  double millions = 10;
  std::string folder = ".";
  bool quick = false;
  line.add("--millions", &millions, "Millions of points");
  line.add("--folder", &folder, "Folder for the octree while it is measured");
  line.add_json();
  line.add("--quick", &quick, "Measure a small case");
  if (const auto end = line.parse(argc, argv)) return *end;

  Drive log(size_t(1e6 * (quick ? 1 : millions)));
  const TemporaryPath place(folder, "octree");
  const double read_s = seconds_of([&] {
    for (BeamLog chunk; log.next(chunk);) {
    }
  });
  const double before_s = usage_so_far().processor_s;
  const double build_s = seconds_of([&] { serve::build_octree(log, place.path()); });
  const Usage usage = usage_so_far();
  const double processor_s = usage.processor_s - before_s;
  uint64_t first = 0, bytes = 0;
  size_t nodes = 0;
  const double open_s = seconds_of([&] {
    const serve::OctreeFile file(place.path());
    nodes = file.nodes().size();
    bytes = file.bytes();
    // A first picture takes the tables and the upper levels up to 100 000 points.
    first = bytes - file.header().nodes_at;
    size_t points = 0;
    for (const serve::OctreeNode& n : file.nodes()) {
      if (points >= 100'000) break;
      points += n.points;
      first += n.points * serve::kPointBytes;
    }
  });
  nlohmann::ordered_json j{{"points", log.size()},
                           {"threads", threads()},
                           {"generate_s", read_s},
                           {"build_s", build_s},
                           {"points_per_s", double(log.size()) / build_s},
                           {"processor_s", processor_s},
                           {"peak_bytes", usage.peak_bytes},
                           {"file_bytes", bytes},
                           {"nodes", nodes},
                           {"open_s", open_s},
                           {"first_picture_bytes", first}};
  std::printf(
      "%zu points, %d threads: built in %.1f s (%.2f M points/s), %.1f s of processor time; "
      "generating the points once takes %.1f s\npeak %.2f GiB; %zu nodes, %.2f GB; opened in %.3f "
      "s, "
      "first picture %.1f MB\n",
      log.size(), threads(), build_s, double(log.size()) / build_s / 1e6, processor_s, read_s,
      double(usage.peak_bytes) / double(1u << 30), nodes, double(bytes) / 1e9, open_s,
      double(first) / 1e6);
  measure_lassos(place.path(), folder, j);
  line.write(j);
  return 0;
}

}  // namespace underbrush::bench
