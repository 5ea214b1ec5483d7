/// \file
/// The options of a sensor server.
#pragma once
#include <functional>
#include <string>

namespace underbrush::live {

/// Options of a server.
struct ServerOptions {
  /// HOST:PORT, where port 0 is a free one, or unix:PATH. Who reaches it and has the token can
  /// fire; nothing is encrypted, so any host but this machine's own is for networks that are safe.
  std::string address = "127.0.0.1:0";
  std::string token;    ///< The token that clients must give.
  std::string version;  ///< The program's version.
  int calls = 4;        ///< Number of calls that run or wait at a time; more are refused.
  size_t request_bytes = 1 << 20;
  double deadline_s = 60;  ///< The longest that a call may take.
};

/// A function that is called with the address once clients can connect.
using ServerStarted = std::function<void(const std::string& address)>;

}  // namespace underbrush::live
