/// \file
/// The sensor server: a service on a port. gRPC is linked in a separate library, which is loaded
/// only when a server starts, so that other verbs start fast and need no gRPC.
#pragma once
#include "underbrush/live/server_options.hpp"
#include "underbrush/live/service.hpp"

namespace underbrush::live {

/// Answers clients over gRPC (share/live/sensor_server.proto) until the process ends. Throws
/// `IoError` where the address cannot be taken, or the library that carries the service is missing.
void serve(Service& service, const ServerOptions& options, const ServerStarted& started);

}  // namespace underbrush::live
