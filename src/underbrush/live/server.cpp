#include "underbrush/live/server.hpp"

#include <dlfcn.h>

#include "underbrush/core/check.hpp"
#include "underbrush/live/carrier.hpp"

namespace underbrush::live {
namespace {

// Beside the program, as it is built and as it is installed.
constexpr const char* kLibrary = "../lib/underbrush/live_grpc.so";

Carrier loaded() {
  const auto program = std::filesystem::canonical("/proc/self/exe").parent_path();
  const std::filesystem::path path = program / kLibrary;
  if (!std::filesystem::exists(path)) {
    throw IoError("this build has no sensor server: " + path.lexically_normal().string() +
                  " is missing; scripts/setup.sh live, then build the target live_grpc");
  }
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const found = library ? ::dlsym(library, kCarrierName) : nullptr;
  if (!found) {
    const char* reason = ::dlerror();
    throw IoError("the sensor server cannot be loaded: " +
                  printable(reason ? reason : "it is another library"));
  }
  return reinterpret_cast<Carrier>(found);
}

}  // namespace

void serve(Service& service, const ServerOptions& options, const ServerStarted& started) {
  const std::string wrong = loaded()(kCarrierVersion, service, options, started);
  if (!wrong.empty()) throw IoError(wrong);
}

}  // namespace underbrush::live
