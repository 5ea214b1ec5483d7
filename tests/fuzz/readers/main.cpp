// The functions that libFuzzer calls. The environment variable READER names the reader; without it,
// the program writes its seeds into the present folder and prints its table of readers.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "fuzz/readers/reader.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::fuzz {
namespace {

const Reader* chosen = nullptr;
Path place;  // Where the damaged bytes are written.

void put(std::string_view bytes) {
  const int file = ::open(place.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || ::write(file, bytes.data(), bytes.size()) != ssize_t(bytes.size())) abort();
  ::close(file);
}

void run(std::string_view bytes) {
  try {
    if (const auto* parse = std::get_if<void (*)(std::string_view)>(&chosen->read)) {
      (*parse)(bytes);
    } else {
      put(bytes);
      std::get<void (*)(const Path&)>(chosen->read)(place);
    }
  } catch (const FormatError&) {
  } catch (const DataError&) {
  }
}

}  // namespace
}  // namespace underbrush::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace underbrush::fuzz;  // NOLINT(google-build-using-namespace)
  underbrush::set_threads(1);
  const char* name = std::getenv("READER");
  for (const Reader& r : readers()) {
    if (name && r.name == name) chosen = &r;
    if (!name) std::printf("%s %s\n", r.name.data(), r.seeds.data());
  }
  if (!name) {
    make_seeds();
    std::exit(0);
  }
  if (!chosen) std::exit(2);
  place = chosen->seeds.substr(0, chosen->seeds.find(' '));
  std::filesystem::remove(place);  // The seed may have other names.
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  underbrush::fuzz::run({reinterpret_cast<const char*>(data), size});
  return 0;
}
