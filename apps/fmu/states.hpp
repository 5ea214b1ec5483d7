/// \file
/// The saved states of all instances, so that a pointer which is none of them is refused.
#pragma once
#include <memory>

#include "model.hpp"

namespace underbrush::fmu {

/// A saved state: a copy of the model with its phase and time.
struct SavedState {
  Snapshot snapshot;
  unsigned phase;
  double time_s;
};

/// Keeps a state and returns the pointer by which the environment knows it.
void* keep_state(SavedState state);
/// Returns the state of a pointer, or nothing if there is none.
std::shared_ptr<const SavedState> state_of(const void* pointer);
/// Removes a state; does nothing for any other pointer. Returns whether it was one.
bool forget_state(const void* pointer);

}  // namespace underbrush::fmu
