/// \file
/// The worlds that requests may name besides the one that a server was started with.
#pragma once
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "underbrush/live/open_world.hpp"

namespace underbrush::live {

/// The worlds of a folder, which are opened when they are first asked for. The two that were asked
/// for last stay open. Several threads may use it.
class OtherWorlds {
 public:
  /// Each world has the sensors, the movers and the options of `options`. An empty folder has none.
  OtherWorlds(std::filesystem::path folder, WorldOptions options);

  /// The names of the files and folders in the folder, sorted; at most 1000.
  std::vector<std::string> names() const;
  /// The sensors in a world; their world stays open as long as they are held. Null where another
  /// world is being opened until the deadline. Throws `std::invalid_argument` for a name that is
  /// none of the folder, and as `open_world` does.
  std::shared_ptr<LiveSensors> sensors(const std::string& name, Deadline deadline);

 private:
  using Kept = std::pair<std::string, std::shared_ptr<OpenedWorld>>;
  std::shared_ptr<OpenedWorld> kept(const std::string& name);

  std::filesystem::path folder_;
  WorldOptions options_;
  std::timed_mutex opening_;  ///< One world is opened at a time.
  std::mutex mutex_;          ///< It guards `kept_`.
  std::vector<Kept> kept_;    ///< The open worlds, in the order of their last requests.
};

}  // namespace underbrush::live
