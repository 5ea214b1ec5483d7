/// \file
/// The sensor server: a service on a port. What carries it is a library of its own, so that the
/// program starts as fast and needs as little without it.
#pragma once
#include "underbrush/live/server_options.hpp"
#include "underbrush/live/service.hpp"

namespace underbrush::live {

/// Answers clients over gRPC (share/live/sensor_server.proto) until the process ends. Throws
/// `IoError` where the address cannot be taken, or the library that carries the service is missing.
void serve(Service& service, const ServerOptions& options, const ServerStarted& started);

}  // namespace underbrush::live
