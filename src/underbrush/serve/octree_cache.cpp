#include "underbrush/serve/octree_cache.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/input.hpp"

namespace underbrush::serve {
namespace {

std::string hash_of(const std::string& text) {
  uint64_t hash = text.size();
  for (const char c : text) hash = mix64(hash ^ (uint64_t(uint8_t(c)) + 0x9e3779b97f4a7c15ull));
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (int shift = 60; shift >= 0; shift -= 4) out += kDigits[hash >> shift & 15];
  return out;
}

// What an octree was built from: path, size and time of the last change.
std::string source_of(const std::filesystem::path& log) {
  struct stat facts {};
  if (::stat(log.c_str(), &facts) != 0) {
    throw FormatError(log.string(), "", std::strerror(errno));
  }
  return std::filesystem::canonical(log).string() + "|" + std::to_string(facts.st_size) + "|" +
         std::to_string(facts.st_mtim.tv_sec) + "." + std::to_string(facts.st_mtim.tv_nsec);
}

std::shared_ptr<const OctreeFile> opened(const std::filesystem::path& place,
                                         const std::string& source) {
  try {
    auto file = std::make_shared<const OctreeFile>(place);
    const auto j = nlohmann::json::parse(file->json(), nullptr, false);
    if (j.is_object() && j.value("source", std::string()) == source) return file;
  } catch (const FormatError&) {  // absent, damaged or of another version: it is made anew
  } catch (const nlohmann::json::exception&) {
  }
  return nullptr;
}

}  // namespace

std::filesystem::path user_cache() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache && std::filesystem::path(cache).is_absolute()) {
    return std::filesystem::path(cache) / "underbrush";
  }
  const char* home = std::getenv("HOME");
  if (home && std::filesystem::path(home).is_absolute()) {
    return std::filesystem::path(home) / ".cache" / "underbrush";
  }
  throw IoError("no folder for the cache: set XDG_CACHE_HOME or HOME, or name one with --cache");
}

std::filesystem::path octree_place(const std::filesystem::path& log,
                                   const std::filesystem::path& cache) {
  const std::string full = std::filesystem::weakly_canonical(log).string();
  return cache / (log.stem().string() + "-" + hash_of(full) + ".octree");
}

std::shared_ptr<const OctreeFile> kept_octree(const std::filesystem::path& log,
                                              const std::filesystem::path& cache) {
  if (!std::filesystem::exists(log)) return nullptr;
  return opened(octree_place(log, cache), source_of(log));
}

std::shared_ptr<const OctreeFile> cached_octree(
    const std::filesystem::path& log, const std::filesystem::path& cache,
    const std::function<void(size_t done, size_t total)>& progress) {
  const std::filesystem::path place = octree_place(log, cache);
  OctreeOptions options;
  options.source = source_of(log);
  options.progress = progress;
  if (auto file = opened(place, options.source)) return file;
  const io::Input input = io::open_input(log);
  if (!input.beams) throw DataError("scans without beams (" + input.format + "): import it first");
  std::error_code error;
  std::filesystem::create_directories(cache, error);
  if (error) throw IoError(cache.string() + ": cannot write: " + error.message());
  io::write_atomically(place, [&](const std::filesystem::path& temporary) {
    build_octree(*input.beams, temporary, options);
  });
  return std::make_shared<const OctreeFile>(place);
}

}  // namespace underbrush::serve
