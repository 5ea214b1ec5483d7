/// \file
/// The answers of the sensor server, independent of the protocol that carries them to clients.
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/live/firing.hpp"

namespace underbrush::live {

class LiveSensors;
class OtherWorlds;

/// The data of a sensor for clients.
struct SensorFacts {
  std::string name, model;  ///< Its name in the rig, and in the sensor catalogue.
  double rate_hz = 0, beams_per_revolution = 0, max_range_m = 0;
  Pose vehicle_from_sensor;
};

/// The sensors and actors in a world, and the limits and other worlds of the server.
struct Description {
  std::vector<SensorFacts> sensors;
  std::vector<std::string> actors;
  std::vector<std::string> layouts;  ///< The layouts of point clouds.
  std::vector<std::string> worlds;   ///< Names of the worlds besides the server's own.
  uint64_t max_beams = 0;            ///< The most beams of a firing.
};

/// A request to fire.
struct FireRequest {
  Firing firing;
  std::vector<std::string> columns;  ///< An empty list means the usual ones.
  std::string layout;  ///< Layout of a cloud for each sensor in place of columns; "" = no clouds.
  std::string world;   ///< Its name; "" = the one that the server was started with.
};

/// The call of a client.
struct Call {
  Deadline deadline;
  std::function<bool()> is_cancelled;
  /// Sends a part and waits until it is on its way. Returns false if nobody waits for it.
  std::function<bool(Part)> send;
};

/// The answers of a sensor server. Its functions may be called from several threads at a time; one
/// firing after another is answered, so that each has all processors. They are virtual so that the
/// library with gRPC, which is loaded when a server starts, links nothing else of this library.
class Service {
 public:
  virtual ~Service() = default;
  /// Describes a world ("" = the server's own), and opens it if need be. Returns nothing where
  /// another world is being opened until the deadline. Throws `std::invalid_argument` for a world
  /// that there is not or that cannot be read.
  virtual std::optional<Description> describe(const std::string& world, Deadline deadline) = 0;
  /// Fires and sends the answer. Returns false if it was cancelled or the deadline passed before
  /// all was sent. Throws `std::invalid_argument` for a request that cannot be answered.
  virtual bool fire(const FireRequest& request, const Call& call) = 0;
};

/// Limits of a server.
struct ServiceLimits {
  uint64_t beams = uint64_t(1) << 20;  ///< The most beams of a firing.
  double duration_s = 3600;            ///< The longest time from the sensors' start to the end.
  size_t rows = 1 << 16;               ///< The most rows of a part.
};

/// Makes the service of sensors, which must outlive it, as must the `others` that requests may
/// name.
std::unique_ptr<Service> service_of(LiveSensors& sensors, const ServiceLimits& limits = {},
                                    OtherWorlds* others = nullptr);

}  // namespace underbrush::live
