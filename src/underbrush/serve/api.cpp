#include "underbrush/serve/api.hpp"

#include <charconv>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "page_assets.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/serve/beam_trace.hpp"

namespace underbrush::serve {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kMostScoreBytes = uint64_t(64) << 20;
constexpr const char* kBytes = "application/octet-stream";

uint64_t number_in(const HttpRequest& request, const char* key, uint64_t otherwise = UINT64_MAX) {
  const auto found = request.query.find(key);
  const std::string text = found == request.query.end() ? "" : found->second;
  if (text.empty() && otherwise != UINT64_MAX) return otherwise;
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::invalid_argument(std::string("the request needs a number '") + key + "'");
  }
  return value;
}

}  // namespace

struct Api::Impl {
  using Answer = HttpReply (Impl::*)(const HttpRequest&);

  Impl(OpenedFiles opened, std::filesystem::path folder, std::string number, uint64_t draws)
      : files(std::move(opened)),
        cache(std::move(folder)),
        version(std::move(number)),
        seed(draws) {}

  size_t id_of(const HttpRequest& request, const char* key) const {
    const uint64_t id = number_in(request, key);
    require(id < files.files.size(), "no such file");
    return size_t(id);
  }
  LogData& log_of(const HttpRequest& request, const char* key = "file") {
    const size_t id = id_of(request, key);
    require(files.files[id].kind == FileKind::kLog, "this file is no log");
    const std::lock_guard lock(mutex);
    auto& log = logs[id];
    if (!log) log = std::make_unique<LogData>(files.files[id].path, cache);
    return *log;
  }
  const WorldData& world_of(const HttpRequest& request, const char* key = "file") {
    const size_t id = id_of(request, key);
    const FileKind kind = files.files[id].kind;
    require(kind != FileKind::kLog && kind != FileKind::kScore,
            "this file is no model, scene or set of primitives");
    World& world = [&]() -> World& {
      const std::lock_guard lock(mutex);
      return worlds[id];
    }();
    // Read without the lock, so that other files are answered meanwhile.
    std::call_once(world.once, [&] { world.data = std::make_unique<WorldData>(files.files[id]); });
    return *world.data;
  }

  HttpReply list(const HttpRequest&) {
    Json j{{"program", "underbrush " + version}, {"files", Json::array()}};
    for (size_t k = 0; k < files.files.size(); ++k) {
      j["files"].push_back({{"id", k},
                            {"name", printable(files.files[k].name)},
                            {"kind", name(files.files[k].kind)}});
    }
    j["notes"] = files.notes;
    j["seed"] = seed;
    return {200, "application/json", j.dump(-1, ' ', false, Json::error_handler_t::replace)};
  }
  HttpReply octree(const HttpRequest& request) {
    return {200, "application/json", log_of(request).state()};
  }
  HttpReply octree_bytes(const HttpRequest& request) {
    const auto file = log_of(request).octree();
    require(file != nullptr, "the octree is not ready");
    require(request.range && request.range->count, "ask for a range, bytes=A-B");
    const uint64_t first = request.range->first, size = file->bytes();
    if (first >= size) return {416, "application/json", R"({"error":"beyond the end"})"};
    const uint64_t count = std::min(*request.range->count, size - first);
    require(count <= kMostBytes, "a range of more than 16 MiB");
    HttpReply reply{200, kBytes, std::string(count, '\0'), std::pair(first, size)};
    file->read(first, reply.body.data(), count);
    return reply;
  }
  HttpReply beams(const HttpRequest& request) {
    return {200, kBytes, log_of(request).beams(number_in(request, "run"))};
  }
  HttpReply beam(const HttpRequest& request) {
    return {200, "application/json", log_of(request).beam_json(number_in(request, "row"))};
  }
  HttpReply trace(const HttpRequest& request) {
    const LoggedBeam logged = log_of(request).beam(number_in(request, "row"));
    return {200, "application/json",
            trace_beam(logged, world_of(request, "world"), number_in(request, "seed", seed))};
  }
  HttpReply world(const HttpRequest& request) {
    return {200, "application/json", world_of(request).json()};
  }
  HttpReply ellipsoids(const HttpRequest& request) {
    return {200, kBytes, world_of(request).ellipsoids(number_in(request, "model"))};
  }
  HttpReply ground(const HttpRequest& request) {
    return {200, kBytes,
            world_of(request).mesh(number_in(request, "model"), elements::Kind::kGround)};
  }
  HttpReply surface(const HttpRequest& request) {
    return {200, kBytes,
            world_of(request).mesh(number_in(request, "model"), elements::Kind::kSurface)};
  }
  HttpReply score(const HttpRequest& request) {
    const OpenedFile& file = files.files[id_of(request, "file")];
    require(file.kind == FileKind::kScore, "this file has no scores");
    const std::string text = read_file(file.path, kMostScoreBytes);
    if (!Json::accept(text)) throw FormatError(file.path.string(), "", "not JSON");
    return {200, "application/json", text};
  }

  OpenedFiles files;
  std::filesystem::path cache;
  std::string version;
  uint64_t seed;
  std::mutex mutex;  ///< Guards the maps.
  std::map<size_t, std::unique_ptr<LogData>> logs;
  struct World {
    std::once_flag once;
    std::unique_ptr<WorldData> data;
  };
  std::map<size_t, World> worlds;
};

Api::Api(OpenedFiles files, std::filesystem::path cache, std::string version, uint64_t seed)
    : impl_(std::make_unique<Impl>(std::move(files), std::move(cache), std::move(version), seed)) {}
Api::~Api() = default;

HttpReply Api::answer(const HttpRequest& request) {
  if (request.path.empty()) return {200, "text/html; charset=utf-8", kPageHtml};
  if (request.path == "app.js") return {200, "text/javascript; charset=utf-8", kPageScript};
  if (request.path == "app.css") return {200, "text/css; charset=utf-8", kPageStyle};
  static const std::map<std::string_view, Impl::Answer> kAnswers = {
      {"api/files", &Impl::list},
      {"api/octree", &Impl::octree},
      {"api/octree/data", &Impl::octree_bytes},
      {"api/beams", &Impl::beams},
      {"api/beam", &Impl::beam},
      {"api/trace", &Impl::trace},
      {"api/world", &Impl::world},
      {"api/ellipsoids", &Impl::ellipsoids},
      {"api/ground", &Impl::ground},
      {"api/surface", &Impl::surface},
      {"api/score", &Impl::score},
  };
  const auto found = kAnswers.find(request.path);
  if (found == kAnswers.end()) return {404, "application/json", R"({"error":"no such page"})"};
  return ((*impl_).*(found->second))(request);
}

}  // namespace underbrush::serve
