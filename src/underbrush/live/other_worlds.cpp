#include "underbrush/live/other_worlds.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush::live {
namespace fs = std::filesystem;

OtherWorlds::OtherWorlds(fs::path folder, WorldOptions options)
    : folder_(std::move(folder)), options_(std::move(options)) {
  if (!folder_.empty() && !fs::is_directory(folder_)) {
    throw IoError(folder_.string() + ": is no folder");
  }
}

std::vector<std::string> OtherWorlds::names() const {
  constexpr size_t kMost = 1000;
  std::vector<std::string> out;
  if (folder_.empty()) return out;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(".") && !leads_out(folder_, name)) out.push_back(name);
  }
  std::ranges::sort(out);
  if (out.size() > kMost) out.resize(kMost);
  return out;
}

std::shared_ptr<OpenedWorld> OtherWorlds::kept(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(kept_, name, &Kept::first);
  if (found == kept_.end()) return nullptr;
  std::rotate(found, found + 1, kept_.end());
  return kept_.back().second;
}

std::shared_ptr<LiveSensors> OtherWorlds::sensors(const std::string& name, Deadline deadline) {
  constexpr size_t kMostOpen = 2;
  std::shared_ptr<OpenedWorld> world = kept(name);
  if (!world) {
    std::unique_lock opening(opening_, std::defer_lock);
    if (!opening.try_lock_until(deadline)) return nullptr;
    world = kept(name);  // Another thread may have opened it meanwhile.
    if (!world) {
      const std::vector<std::string> known = names();
      if (std::ranges::find(known, name) == known.end()) {
        throw std::invalid_argument("there is no world " + in_quotes(name));
      }
      WorldOptions options = options_;
      options.world = (folder_ / name).string();
      world = std::make_shared<OpenedWorld>(open_world(options));
      const std::lock_guard lock(mutex_);
      if (kept_.size() >= kMostOpen) kept_.erase(kept_.begin());
      kept_.emplace_back(name, world);
    }
  }
  return {world, world->sensors.get()};
}

}  // namespace underbrush::live
