#include <dlfcn.h>

#include <array>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/strategies.hpp"
#include "underbrush/osi/strategy_library.h"
#include "underbrush/osi/write.hpp"

namespace underbrush::osi {
namespace {

/// The functions of a library, which stays loaded as long as this exists.
struct Library {
  void* handle = nullptr;
  decltype(&underbrush_strategy_version) version = nullptr;
  decltype(&underbrush_strategy_new) make = nullptr;
  decltype(&underbrush_strategy_free) free = nullptr;
  decltype(&underbrush_strategy_step) step = nullptr;
  decltype(&underbrush_strategy_reset) reset = nullptr;
  decltype(&underbrush_strategy_clone) clone = nullptr;

  Library() = default;
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    if (handle) dlclose(handle);
  }
};

using Error = std::array<char, 256>;

std::string reason_of(const Error& error) {
  const std::string_view text(error.data(), error.size());
  return printable(text.substr(0, text.find('\0')));
}

template <class Function>
void find(Library& library, const char* name, const Parameters& p, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library.handle, name));
  if (!function) p.fail("library", std::string("has no function ") + name);
}

std::shared_ptr<const Library> open(const StrategyEntry& entry) {
  const Parameters p(entry);
  auto library = std::make_shared<Library>();
  library->handle = dlopen(entry.library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library->handle) {
    const char* reason = dlerror();
    p.fail("library", printable(reason ? reason : "cannot be loaded"));
  }
  find(*library, "underbrush_strategy_version", p, library->version);
  find(*library, "underbrush_strategy_new", p, library->make);
  find(*library, "underbrush_strategy_free", p, library->free);
  find(*library, "underbrush_strategy_step", p, library->step);
  find(*library, "underbrush_strategy_reset", p, library->reset);
  find(*library, "underbrush_strategy_clone", p, library->clone);
  if (library->version() != UNDERBRUSH_STRATEGY_VERSION) {
    p.fail("library", "is for another version of the interface");
  }
  return library;
}

/// A strategy of a user's library.
class LibraryStrategy : public Strategy {
 public:
  LibraryStrategy(std::shared_ptr<const Library> library, void* strategy, std::string name)
      : library_(std::move(library)), strategy_(strategy), name_(std::move(name)) {}
  ~LibraryStrategy() override { library_->free(strategy_); }
  LibraryStrategy(const LibraryStrategy&) = delete;
  LibraryStrategy& operator=(const LibraryStrategy&) = delete;

  void step(SensorData& data) override {
    in_.clear();
    write(data, in_);
    const void* out = nullptr;
    size_t bytes = 0;
    Error error{};
    const int failed =
        library_->step(strategy_, in_.data(), in_.size(), &out, &bytes, error.data(), error.size());
    if (failed || (!out && bytes)) throw DataError(name_ + ": " + reason_of(error));
    data = read_sensor_data({static_cast<const char*>(out), bytes}, "output of " + name_);
  }
  void reset() override { library_->reset(strategy_); }
  std::unique_ptr<Strategy> clone() const override {
    void* copy = library_->clone(strategy_);
    require_data(copy != nullptr, "a strategy of a library cannot be copied");
    return std::make_unique<LibraryStrategy>(library_, copy, name_);
  }

 private:
  std::shared_ptr<const Library> library_;
  void* strategy_;
  std::string name_, in_;
};

}  // namespace

std::unique_ptr<Strategy> load_strategy(const StrategyEntry& entry) {
  auto library = open(entry);
  std::string parameters;
  for (const auto& [key, value] : entry.parameters) parameters += key + ": " + value + "\n";
  Error error{};
  void* strategy = library->make(parameters.c_str(), error.data(), error.size());
  if (!strategy) Parameters(entry).fail("", reason_of(error));
  return std::make_unique<LibraryStrategy>(std::move(library), strategy, entry.name);
}

}  // namespace underbrush::osi
