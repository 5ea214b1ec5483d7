#include "underbrush/io/hash.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <span>
#include <vector>

#include "underbrush/core/file.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

// A pipe or a device has no end; the reader of the input refuses it.
void hash_into(XXH3_state_t& state, const fs::path& file, std::span<char> buffer) {
  if (!is_file(file)) return;
  std::ifstream in(file, std::ios::binary);
  while (in.read(buffer.data(), std::streamsize(buffer.size())) || in.gcount() > 0) {
    XXH3_128bits_update(&state, buffer.data(), size_t(in.gcount()));
  }
}

/// The path itself, or all files of a folder, in no order.
std::vector<fs::path> files_of(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  return files;
}

}  // namespace

uint64_t size_of(const fs::path& path) {
  uint64_t sum = 0;
  for (const fs::path& file : files_of(path)) sum += is_file(file) ? fs::file_size(file) : 0;
  return sum;
}

std::string hash_of(const fs::path& path) { return hash_of_all({path}); }

std::string hash_of_all(const std::vector<fs::path>& paths) {
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_128bits_reset(state.get());
  constexpr size_t kBytes = 1 << 20;
  const auto buffer = std::make_unique_for_overwrite<char[]>(kBytes);
  for (const fs::path& path : paths) {
    std::vector<fs::path> files = files_of(path);
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) hash_into(*state, file, {buffer.get(), kBytes});
  }
  const XXH128_hash_t h = XXH3_128bits_digest(state.get());
  char text[40];
  std::snprintf(text, sizeof text, "xxh3:%016llx%016llx", static_cast<unsigned long long>(h.high64),
                static_cast<unsigned long long>(h.low64));
  return text;
}

}  // namespace underbrush::io
