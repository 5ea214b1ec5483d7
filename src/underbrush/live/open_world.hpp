/// \file
/// A world with sensors in it, opened for a server.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "underbrush/live/live_sensors.hpp"

namespace underbrush::live {

/// The world and the sensors of a server.
struct WorldOptions {
  std::string world;        ///< A model, a scene, or a world of another program.
  std::string sensor, rig;  ///< One of them: a sensor's name or file, or the file of a rig.
  /// Movers of the clients, besides the actors of the world: NAME=MODEL, each absent until a
  /// request gives it a motion.
  std::vector<std::string> movers;
  pipeline::SimulateOptions simulate;
};

/// The world and its sensors.
struct OpenedWorld {
  std::unique_ptr<pipeline::TracedWorld> world;
  std::unique_ptr<LiveSensors> sensors;
};

/// Reads a world and prepares it. Throws as the readers and `LiveSensors` do.
OpenedWorld open_world(const WorldOptions& options);

/// Adds an object that clients can move, and that is absent until a request gives it a motion.
void add_absent(pipeline::World& world, const std::string& name, elements::Model model);

/// Reads the token of a server from a file. Throws `IoError` where it cannot be read, and
/// `FormatError` unless it is one word of 16 to 128 printable characters.
std::string read_token(const std::string& file);

}  // namespace underbrush::live
