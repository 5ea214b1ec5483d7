#include "underbrush/serve/log_data.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"
#include "underbrush/serve/bytes.inl"
#include "underbrush/serve/json_reply.inl"
#include "underbrush/serve/octree_cache.hpp"

namespace underbrush::serve {
namespace {

constexpr size_t kMostBeams = 200'000;
constexpr size_t kMostEchoes = 64;  // rows of one beam
constexpr uint64_t kMostRunRows = 8'000'000;
constexpr uint64_t kMostPlaces = 4000;

Vec3 origin_of(const OctreeFile& file) {
  const Json at = Json::parse(file.json()).at("origin_m");
  return {at.at(0).get<double>(), at.at(1).get<double>(), at.at(2).get<double>()};
}

}  // namespace

LogData::LogData(std::filesystem::path path, std::filesystem::path cache)
    : path_(std::move(path)), cache_(std::move(cache)) {}

LogData::~LogData() {
  if (builder_.joinable()) builder_.join();
}

void LogData::start() {
  if (started_) return;
  started_ = true;
  builder_ = std::thread([this] {
    std::shared_ptr<const OctreeFile> octree;
    std::unique_ptr<io::LogReader> reader;
    std::string error;
    try {
      octree = cached_octree(path_, cache_, [this](size_t done, size_t total) {
        done_ = double(done) / double(std::max<size_t>(total, 1));
      });
      const io::Input input = io::open_input(path_);
      const Json j = Json::parse(octree->json());
      if (input.is_log && input.beams->size() == j.value("rows", size_t(0))) {
        reader = std::make_unique<io::LogReader>(path_);
      }
    } catch (const std::exception& e) {
      error = printable(e.what());
    }
    const std::lock_guard lock(mutex_);
    octree_ = error.empty() ? octree : nullptr;
    reader_ = std::move(reader);
    error_ = error;
  });
}

std::shared_ptr<const OctreeFile> LogData::octree() {
  const std::lock_guard lock(mutex_);
  return octree_;
}

std::string LogData::state(bool build) {
  const std::lock_guard lock(mutex_);
  if (!build && !started_ && !kept_octree(path_, cache_)) return text_of({{"state", "absent"}});
  start();
  if (!error_.empty()) return text_of({{"state", "failed"}, {"error", error_}});
  if (!octree_) return text_of({{"state", "building"}, {"done", done_.load()}});
  const OctreeHeader& h = octree_->header();
  return text_of({{"state", "ready"},
                  {"bytes", octree_->bytes()},
                  {"nodes_at", h.nodes_at},
                  {"nodes", h.nodes},
                  {"runs_at", h.runs_at},
                  {"runs", h.runs},
                  {"octree", Json::parse(octree_->json())}});
}

std::shared_ptr<const OctreeFile> LogData::needed() {
  auto file = octree();
  require(file != nullptr, "the octree is not ready");
  return file;
}

BeamLog LogData::rows(uint64_t first, size_t n) {
  if (reader_) return reader_->rows(first, n);
  // Rows without a place of their own in the file are found by reading up to them.
  const io::Input input = io::open_input(path_);
  BeamLog out;
  size_t at = 0;
  for (BeamLog chunk; out.size() < n && input.beams->next(chunk); at += chunk.size()) {
    if (out.empty()) out = chunk.like();
    if (at + chunk.size() <= first) continue;
    const size_t begin = first > at ? first - at : 0;
    out.append(chunk, begin, std::min(chunk.size(), begin + n - out.size()));
  }
  require(out.size() == n, "no such row");
  return out;
}

std::string LogData::beams(size_t run) {
  const auto file = needed();
  require(run < file->runs().size(), "no such run");
  const OctreeRun& r = file->runs()[run];
  const BeamLog log = rows(r.first_row, r.rows);
  const Vec3 origin = origin_of(*file);
  const uint32_t step = uint32_t((log.size() + kMostBeams - 1) / kMostBeams);
  std::string bytes;
  append(bytes, step == 0 ? 0u : uint32_t((log.size() + step - 1) / step));
  append(bytes, step);
  for (size_t i = 0; i < log.size(); i += step) {
    for (const Vec3& point : {Vec3(log.origin[i] - origin), Vec3(log.end_point(i) - origin)}) {
      const Vec3f p = point.cast<float>();
      append(bytes, p.data(), 3);
    }
    append(bytes, uint32_t(r.first_row + i));
    append(bytes, log.is_hit(i) ? 1u : log.flags[i] & kInferred ? 2u : 0u);
  }
  return bytes;
}

// Adds those beams of a run whose numbers are in [number, number + n).
void LogData::append_run(const OctreeRun& run, uint64_t number, size_t n, LoggedBeams& out) {
  require(run.rows <= kMostRunRows, "a scan of more than 8 000 000 rows");
  const BeamLog log = rows(run.first_row, run.rows);
  const std::vector<bool> begins = begins_beam(log);
  if (out.row.empty()) {
    out.beams = log.like();
    out.number = number;
  }
  uint64_t next = run.first_beam;
  for (size_t i = 0; i < log.size(); ++i) {
    if (!begins[i]) continue;
    const uint64_t at = next++;
    if (at < number || at - number >= n) continue;
    out.beams.append(log, i);
    out.row.push_back(uint32_t(run.first_row + i));
  }
}

LoggedBeams LogData::beams_of_run(size_t run) {
  const auto file = needed();
  require(run < file->runs().size(), "no such run");
  const OctreeRun& r = file->runs()[run];
  LoggedBeams out;
  append_run(r, r.first_beam, r.rows, out);
  return out;
}

LoggedBeams LogData::beams_from(uint64_t number, size_t n) {
  const auto file = needed();
  require(n <= kMostRunRows, "more than 8 000 000 beams");
  const auto& runs = file->runs();
  auto run = std::upper_bound(runs.begin(), runs.end(), number,
                              [](uint64_t b, const OctreeRun& o) { return b < o.first_beam; });
  LoggedBeams out;
  if (run != runs.begin()) --run;
  for (; run != runs.end() && out.row.size() < n; ++run) append_run(*run, number, n, out);
  return out;
}

// The rows 0, step, 2 step and so on of `rows` rows.
BeamLog LogData::some_rows(uint64_t rows, uint64_t step) {
  BeamLog out;
  if (reader_) {
    for (uint64_t row = 0; row < rows; row += step) {
      const BeamLog one = reader_->rows(row, 1);
      if (out.empty()) out = one.like();
      out.append(one, 0);
    }
    return out;
  }
  const io::Input input = io::open_input(path_);
  uint64_t at = 0, next = 0;
  for (BeamLog chunk; input.beams->next(chunk); at += chunk.size()) {
    if (out.empty()) out = chunk.like();
    for (; next < at + chunk.size(); next += step) out.append(chunk, next - at);
  }
  return out;
}

std::string LogData::trajectory() {
  const auto file = needed();
  {
    const std::lock_guard lock(mutex_);
    if (!trajectory_.empty()) return trajectory_;
  }
  const Json facts = Json::parse(file->json());
  const auto rows = facts.at("rows").get<uint64_t>();
  const BeamLog log =
      some_rows(rows, std::max<uint64_t>(1, (rows + kMostPlaces - 1) / kMostPlaces));
  const Vec3 origin = origin_of(*file);
  const auto first_s = facts.at("first_time_s").get<double>();
  std::string bytes;
  append(bytes, uint32_t(log.size()));
  for (size_t i = 0; i < log.size(); ++i) {
    append(bytes, float(log.time_s[i] - first_s));
    for (Eigen::Index c = 0; c < 3; ++c) append(bytes, float(log.origin[i][c] - origin[c]));
  }
  const std::lock_guard lock(mutex_);
  trajectory_ = bytes;
  return bytes;
}

LoggedBeam LogData::beam(uint64_t row) {
  const auto file = needed();
  const auto& runs = file->runs();
  auto run = std::upper_bound(runs.begin(), runs.end(), row,
                              [](uint64_t r, const OctreeRun& o) { return r < o.first_row; });
  require(run != runs.begin(), "no such row");
  --run;
  require(row < run->first_row + run->rows, "no such row");
  if (const BeamLog one = rows(row, 1); !one.extra.contains(kEchoColumn)) {
    return {one, run->first_beam + (row - run->first_row), row, 0};  // each row is a beam
  }
  const uint64_t end = run->first_row + run->rows;
  const size_t n = size_t(std::min<uint64_t>(row + kMostEchoes, end) - run->first_row);
  const BeamLog log = rows(run->first_row, n);
  const std::vector<bool> begins = begins_beam(log);
  const size_t asked = size_t(row - run->first_row);
  LoggedBeam out;
  size_t first = 0;
  out.number = run->first_beam;
  for (size_t i = 1; i <= asked; ++i) {
    if (!begins[i]) continue;
    first = i;
    ++out.number;
  }
  size_t last = asked + 1;
  while (last < log.size() && !begins[last]) ++last;
  out.rows = log.like();
  out.rows.append(log, first, last);
  out.first = run->first_row + first;
  out.asked = asked - first;
  return out;
}

bool LogData::keyframes_serve(const elements::Model& model) {
  const std::lock_guard lock(mutex_);
  const auto known = keyframes_serve_.find(&model);
  if (known != keyframes_serve_.end()) return known->second;
  const io::Input input = io::open_input(path_);
  return keyframes_serve_[&model] = keyframes::KeyframeCache::serves(model, *input.beams);
}

std::string LogData::beam_json(uint64_t row) {
  const LoggedBeam b = beam(row);
  const size_t i = b.asked;
  const BeamLog& log = b.rows;
  const auto list = [](const auto& v) { return Json{double(v[0]), double(v[1]), double(v[2])}; };
  Json j{{"row", row}, {"beam", b.number}};
  j["hit"] = log.is_hit(i);
  j["inferred"] = (log.flags[i] & kInferred) != 0;
  j["range_m"] = log.is_hit(i) ? Json(log.range_m[i]) : Json(nullptr);
  j["origin_m"] = list(log.origin[i]);
  j["direction"] = list(log.direction[i]);
  j["end_m"] = list(log.end_point(i));
  j["intensity"] = log.intensity[i];
  j["time_s"] = log.time_s[i];
  j["ring"] = log.ring[i];
  j["scan"] = log.scan[i];
  j["packet"] = log.packet[i];
  for (const auto& [name, column] : log.extra) {
    std::visit([&, key = name](const auto& c) { j["columns"][key] = c[i]; }, column);
  }
  j["echoes_m"] = Json::array();
  for (size_t k = 0; k < log.size(); ++k) {
    if (log.is_hit(k)) j["echoes_m"].push_back(log.range_m[k]);
  }
  return text_of(j);
}

}  // namespace underbrush::serve
