/// \file
/// This file holds object lists back until they are available.
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// The latency of the processing: the user gets the newest list that is available at a time. Its
/// state is a plain value.
class OutputDelay {
 public:
  /// Adds a list. Lists come in order of `time_s`. The memory of lists that were replaced is used
  /// again, so that none is allocated once the largest number of lists has waited.
  void push(const ObjectList& list) {
    if (waiting_ == lists_.size()) lists_.emplace_back();
    lists_[waiting_++] = list;
  }
  /// The newest list that is available at a time, or nothing. Older lists are forgotten.
  const ObjectList* at(double time_s) {
    size_t newest = waiting_;
    for (size_t k = 0; k < waiting_; ++k) {
      if (lists_[k].available_s <= time_s) newest = k;
    }
    if (newest == waiting_) return has_shown_ ? &shown_ : nullptr;
    std::swap(shown_, lists_[newest]);
    has_shown_ = true;
    for (size_t k = newest + 1; k < waiting_; ++k) std::swap(lists_[k - newest - 1], lists_[k]);
    waiting_ -= newest + 1;
    return &shown_;
  }
  /// Forgets all lists.
  void reset() {
    waiting_ = 0;
    has_shown_ = false;
  }

 private:
  std::vector<ObjectList> lists_;  ///< The first `waiting_` wait.
  size_t waiting_ = 0;
  ObjectList shown_;
  bool has_shown_ = false;
};

}  // namespace underbrush::perception
