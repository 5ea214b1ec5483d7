/// \file
/// The function of the library that carries the service, which `serve` loads.
#pragma once
#include "underbrush/live/server_options.hpp"
#include "underbrush/live/service.hpp"

namespace underbrush::live {

/// The version of the types that the program and the library share.
inline constexpr int kCarrierVersion = 3;

/// A function that does the work of `serve`. Returns "", or the reason of a failure.
using Carrier = std::string (*)(int version, Service& service, const ServerOptions& options,
                                const ServerStarted& started);
/// The name of that function in the library.
inline constexpr const char* kCarrierName = "underbrush_live_carrier";

}  // namespace underbrush::live
