/// \file
/// The memory in which chunks are coded.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/compact/packed.hpp"
#include "underbrush/compact/track.hpp"

namespace underbrush::compact {

/// The memory that a thread reuses for chunk after chunk, because the system clears fresh memory.
struct Scratch {
  Codec codec;
  std::vector<Place> places;
  std::array<std::vector<uint32_t>, 3> rest;  ///< Residuals of directions.
  std::vector<uint32_t> words;
  std::vector<uint64_t> longs;
  std::vector<float> values;
};

}  // namespace underbrush::compact
