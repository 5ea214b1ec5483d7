/// \file
/// The function of the library that carries the service, which `serve` loads.
#pragma once
#include "underbrush/live/server_options.hpp"
#include "underbrush/live/service.hpp"

namespace underbrush::live {

/// Changes with the types that the program and the library share.
inline constexpr int kCarrierVersion = 2;

/// Does what `serve` does. Returns "", or what is wrong.
using Carrier = std::string (*)(int version, Service& service, const ServerOptions& options,
                                const ServerStarted& started);
/// The name of that function in the library.
inline constexpr const char* kCarrierName = "underbrush_live_carrier";

}  // namespace underbrush::live
