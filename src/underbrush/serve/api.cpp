#include "underbrush/serve/api.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "page_assets.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/sensor/catalogue.hpp"
#include "underbrush/serve/actor_api.hpp"
#include "underbrush/serve/beam_echoes.hpp"
#include "underbrush/serve/beam_trace.hpp"
#include "underbrush/serve/job_api.hpp"
#include "underbrush/serve/json_reply.inl"
#include "underbrush/serve/label_api.hpp"
#include "underbrush/serve/log_preview.hpp"
#include "underbrush/serve/primitive_api.hpp"
#include "underbrush/serve/query.hpp"
#include "underbrush/serve/range_errors.hpp"
#include "underbrush/serve/range_image.hpp"

namespace underbrush::serve {
namespace {

constexpr size_t kMostCompared = 4;  // pairs of logs
constexpr uint64_t kMostScoreBytes = uint64_t(64) << 20;
constexpr const char* kBytes = "application/octet-stream";

}  // namespace

struct Api::Impl {
  using Answer = HttpReply (Impl::*)(const HttpRequest&);

  Impl(OpenedFiles opened, ApiOptions given)
      : options(std::move(given)), notes(opened.notes), edits(opened.edits) {
    for (OpenedFile& file : opened.files) files.push_back(std::move(file));
    if (options.labels.empty()) return;
    const ServedFiles served{
        [this](size_t id) { return file_at(id); },
        [this](size_t id) { return file_at(id).kind == FileKind::kLog ? &log_at(id) : nullptr; },
        [this](const std::filesystem::path& path) { return add(path); }};
    labels = std::make_unique<LabelApi>(served, options.labels);
    if (!options.program.empty()) {
      jobs = std::make_unique<JobApi>(served, options.labels, options.program);
    }
  }

  OpenedFile file_at(size_t id) {
    const std::lock_guard lock(mutex);
    require(id < files.size(), "no such file");
    return files[id];
  }
  size_t add(const std::filesystem::path& path) {
    OpenedFiles found = find_files({path});
    const std::lock_guard lock(mutex);
    files.push_back(std::move(found.files.at(0)));
    return files.size() - 1;
  }
  LogData& log_at(size_t id) {
    const std::lock_guard lock(mutex);
    auto& log = logs[id];
    if (!log) log = std::make_unique<LogData>(files[id].path, options.cache);
    return *log;
  }
  LogData& log_of(const HttpRequest& request, const char* key = "file") {
    const size_t id = Query(request).number(key);
    require(file_at(id).kind == FileKind::kLog, "this file is no log");
    return log_at(id);
  }
  const WorldData& world_of(const HttpRequest& request, const char* key = "file") {
    const size_t id = Query(request).number(key);
    const OpenedFile file = file_at(id);
    require(file.kind != FileKind::kLog && file.kind != FileKind::kScore,
            "this file is no model, scene or set of primitives");
    World& world = [&]() -> World& {
      const std::lock_guard lock(mutex);
      return worlds[id];
    }();
    // Read without the lock, so that other files are answered meanwhile.
    std::call_once(world.once, [&] { world.data = std::make_unique<WorldData>(file); });
    return *world.data;
  }

  HttpReply list(const HttpRequest&) {
    Json j{{"program", "underbrush " + options.version}, {"files", Json::array()}};
    const std::lock_guard lock(mutex);
    for (size_t k = 0; k < files.size(); ++k) {
      j["files"].push_back(
          {{"id", k}, {"name", printable(files[k].name)}, {"kind", name(files[k].kind)}});
    }
    j["notes"] = notes;
    j["seed"] = options.seed;
    j["labels"] = labels != nullptr;
    j["jobs"] = jobs != nullptr;
    if (!edits.list.empty()) {
      const auto edited = std::ranges::find(files, edits.actors, &OpenedFile::path);
      j["edits"] = {{"file", edited - files.begin()}, {"list", Json::parse(edits.list)}};
    }
    j["sensors"] = Json::array();
    for (const sensor::CatalogueEntry& entry : sensor::catalogue()) {
      j["sensors"].push_back(std::string(entry.name));
    }
    return reply_of(j);
  }
  HttpReply octree(const HttpRequest& request) {
    const bool build = Query(request).number("build", 1) != 0;
    return {200, "application/json", log_of(request).state(build)};
  }
  HttpReply preview(const HttpRequest& request) {
    const OpenedFile file = file_at(Query(request).number("file"));
    require(file.kind == FileKind::kLog, "this file is no log");
    return {200, kBytes, log_preview(file.path)};
  }
  HttpReply octree_bytes(const HttpRequest& request) {
    const auto file = log_of(request).octree();
    require(file != nullptr, "the octree is not ready");
    require(request.range && request.range->count, "ask for a range, bytes=A-B");
    const uint64_t first = request.range->first, size = file->bytes();
    if (first >= size) return error_reply(416, "beyond the end");
    const uint64_t count = std::min(*request.range->count, size - first);
    require(count <= kMostBytes, "a range of more than 16 MiB");
    HttpReply reply{200, kBytes, std::string(count, '\0'), std::pair(first, size)};
    file->read(first, reply.body.data(), count);
    return reply;
  }
  HttpReply beams(const HttpRequest& request) {
    return {200, kBytes, log_of(request).beams(Query(request).number("run"))};
  }
  HttpReply beam(const HttpRequest& request) {
    return {200, "application/json", log_of(request).beam_json(Query(request).number("row"))};
  }
  HttpReply trace(const HttpRequest& request) {
    LogData& log = log_of(request);
    const WorldData& world = world_of(request, "world");
    return {200, "application/json",
            trace_beam(log.beam(Query(request).number("row")), world,
                       Query(request).number("seed", options.seed),
                       log.keyframes_serve(world.traced().models()[0]))};
  }
  HttpReply echoes(const HttpRequest& request) {
    const Query query(request);
    return {200, "application/json",
            beam_echoes(log_of(request).beam(query.number("row")), world_of(request, "world"),
                        query.text("sensor"), query.number("seed", options.seed))};
  }
  HttpReply trajectory(const HttpRequest& request) {
    return {200, kBytes, log_of(request).trajectory()};
  }
  HttpReply image(const HttpRequest& request) {
    const Query query(request);
    LogData& log = log_of(request);
    const LoggedBeams beams = log.beams_of_run(query.number("run"));
    std::vector<float> ranges;
    if (query.has("other")) ranges = other_ranges(beams, log_of(request, "other"));
    if (query.has("world")) {
      const WorldData& world = world_of(request, "world");
      ranges = simulated_ranges(beams, world, query.number("seed", options.seed),
                                log.keyframes_serve(world.traced().models()[0]));
    }
    return {200, kBytes, range_image(beams, ranges)};
  }
  struct Compared {
    std::pair<size_t, size_t> ids;
    std::once_flag once;
    std::unique_ptr<RangeErrors> errors;
  };
  std::shared_ptr<Compared> comparison(const std::pair<size_t, size_t>& ids) {
    const std::lock_guard lock(mutex);
    const auto found = std::find_if(compared.begin(), compared.end(),
                                    [&](const auto& other) { return other->ids == ids; });
    if (found != compared.end()) return *found;
    compared.push_front(std::make_shared<Compared>());
    compared.front()->ids = ids;
    if (compared.size() > kMostCompared) compared.pop_back();
    return compared.front();
  }
  HttpReply errors(const HttpRequest& request) {
    const Query query(request);
    const std::pair ids(query.number("file"), query.number("other"));
    const auto octree = log_of(request).octree();
    require(octree != nullptr, "the octree is not ready");
    require(file_at(ids.second).kind == FileKind::kLog, "this file is no log");
    const std::shared_ptr<Compared> pair = comparison(ids);
    std::call_once(pair->once, [&] {
      pair->errors =
          std::make_unique<RangeErrors>(file_at(ids.first).path, file_at(ids.second).path);
    });
    return {200, kBytes, pair->errors->of_nodes(*octree, query.numbers("nodes"))};
  }
  HttpReply world(const HttpRequest& request) {
    return {200, "application/json", world_of(request).json()};
  }
  HttpReply actors(const HttpRequest& request) {
    const Query query(request);
    const std::string name = query.has("name") ? printable(query.text("name"), 80) : "edits";
    return {200, "application/json", actors_json(world_of(request), query.text("edits"), name)};
  }
  // The place of a new list of edits.
  std::filesystem::path path_of_edits(const Query& query) const {
    std::filesystem::path path = options.labels / query.file_name("name");
    require(path.extension() == ".json", "the name of a list of edits ends with .json");
    require(!std::filesystem::exists(std::filesystem::symlink_status(path)),
            "a file of this name is there already");
    return path;
  }
  HttpReply write_actors(const HttpRequest& request) {
    const Query query(request);
    const std::filesystem::path path = path_of_edits(query);
    write_edits(path, file_at(query.number("file")), world_of(request), query.text("edits"));
    return reply_of({{"path", printable(path.string())}});
  }
  HttpReply primitives(const HttpRequest& request) {
    return {200, "application/json", primitives_json(file_at(Query(request).number("file")))};
  }
  HttpReply write_primitive_edits(const HttpRequest& request) {
    const Query query(request);
    const std::filesystem::path path = path_of_edits(query);
    const size_t count = primitive_edits.add(path, file_at(query.number("file")), query);
    return reply_of({{"path", printable(path.string())}, {"edits", count}});
  }
  HttpReply ellipsoids(const HttpRequest& request) {
    return {200, kBytes, world_of(request).ellipsoids(Query(request).number("model"))};
  }
  HttpReply ground(const HttpRequest& request) {
    return {200, kBytes,
            world_of(request).mesh(Query(request).number("model"), elements::Kind::kGround)};
  }
  HttpReply surface(const HttpRequest& request) {
    return {200, kBytes,
            world_of(request).mesh(Query(request).number("model"), elements::Kind::kSurface)};
  }
  HttpReply thumbnail(const HttpRequest& request) {
    return {200, "image/png", world_of(request).thumbnail(Query(request).number("model"))};
  }
  HttpReply score(const HttpRequest& request) {
    const OpenedFile file = file_at(Query(request).number("file"));
    require(file.kind == FileKind::kScore, "this file has no scores");
    const std::string text = read_file(file.path, kMostScoreBytes);
    if (!Json::accept(text)) throw FormatError(file.path.string(), "", "not JSON");
    return {200, "application/json", text};
  }

  ApiOptions options;
  std::vector<std::string> notes;
  GivenEdits edits;
  PrimitiveEdits primitive_edits;
  std::mutex mutex;              ///< Guards the list and the maps.
  std::deque<OpenedFile> files;  ///< Grows with the results of jobs.
  std::map<size_t, std::unique_ptr<LogData>> logs;
  struct World {
    std::once_flag once;
    std::unique_ptr<WorldData> data;
  };
  std::map<size_t, World> worlds;
  /// Comparisons take 8 bytes a row: only those asked for last are kept, the newest first.
  std::deque<std::shared_ptr<Compared>> compared;
  std::unique_ptr<LabelApi> labels;  ///< Null where nothing may be written.
  std::unique_ptr<JobApi> jobs;
};

Api::Api(OpenedFiles files, ApiOptions options)
    : impl_(std::make_unique<Impl>(std::move(files), std::move(options))) {}
Api::~Api() = default;

HttpReply Api::answer(const HttpRequest& request) {
  if (request.path.empty()) return {200, "text/html; charset=utf-8", kPageHtml};
  if (request.path == "app.js") return {200, "text/javascript; charset=utf-8", kPageScript};
  if (request.path == "app.css") return {200, "text/css; charset=utf-8", kPageStyle};
  static const std::map<std::string_view, Impl::Answer> kAnswers = {
      {"api/files", &Impl::list},
      {"api/octree", &Impl::octree},
      {"api/octree/data", &Impl::octree_bytes},
      {"api/preview", &Impl::preview},
      {"api/beams", &Impl::beams},
      {"api/beam", &Impl::beam},
      {"api/trace", &Impl::trace},
      {"api/echoes", &Impl::echoes},
      {"api/errors", &Impl::errors},
      {"api/range_image", &Impl::image},
      {"api/trajectory", &Impl::trajectory},
      {"api/world", &Impl::world},
      {"api/actors", &Impl::actors},
      {"api/primitives", &Impl::primitives},
      {"api/ellipsoids", &Impl::ellipsoids},
      {"api/ground", &Impl::ground},
      {"api/surface", &Impl::surface},
      {"api/score", &Impl::score},
      {"api/thumbnail", &Impl::thumbnail},
  };
  const auto begins = [&](std::string_view start) {
    return request.path == start ||
           (request.path.starts_with(start) && request.path[start.size()] == '/');
  };
  const Impl::Answer write = request.path == "api/actors/write"       ? &Impl::write_actors
                             : request.path == "api/primitives/write" ? &Impl::write_primitive_edits
                                                                      : nullptr;
  const bool writes = write != nullptr, of_jobs = begins("api/jobs");
  if (of_jobs ? !impl_->jobs : !impl_->labels && (writes || begins("api/labels"))) {
    return error_reply(403, "start underbrush serve with --labels FOLDER");
  }
  if (of_jobs) return impl_->jobs->answer(request);
  if (begins("api/labels")) return impl_->labels->answer(request);
  if (writes && request.method == "POST") return ((*impl_).*write)(request);
  if (writes) return error_reply(405, "only POST writes edits");
  if (request.method == "POST") return error_reply(405, "only GET is answered");
  const auto found = kAnswers.find(request.path);
  if (found == kAnswers.end()) return error_reply(404, "no such page");
  return ((*impl_).*(found->second))(request);
}

}  // namespace underbrush::serve
