#include "states.hpp"

#include <map>
#include <memory>
#include <mutex>

namespace underbrush::fmu {
namespace {

// The functions of FMI name a state by its pointer alone, and a state may be that of another
// instance: the list is that of the process.
struct States {
  std::mutex mutex;
  std::map<const void*, std::shared_ptr<const SavedState>> all;
};

States& states() {
  static States& kept = *new States;
  return kept;
}

}  // namespace

void* keep_state(SavedState state) {
  auto held = std::make_shared<SavedState>(std::move(state));
  void* const pointer = held.get();
  const std::lock_guard lock(states().mutex);
  states().all[pointer] = std::move(held);
  return pointer;
}

std::shared_ptr<const SavedState> state_of(const void* pointer) {
  const std::lock_guard lock(states().mutex);
  const auto found = states().all.find(pointer);
  return found == states().all.end() ? nullptr : found->second;
}

bool forget_state(const void* pointer) {
  const std::lock_guard lock(states().mutex);
  return states().all.erase(pointer) > 0;
}

}  // namespace underbrush::fmu
