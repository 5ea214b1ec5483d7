/// \file
/// The response of an instrument to a beam in a world: its waveform and its echoes.
#pragma once
#include <cstdint>
#include <string>

#include "underbrush/serve/log_data.hpp"
#include "underbrush/serve/world_data.hpp"

namespace underbrush::serve {

/// Fires a logged beam at a world and returns as JSON the response of the instrument: the name of
/// the sensor, the number of sub-rays, the threshold, the waveform (`range_m`, `signal`; samples
/// where nothing comes back are left out), and the echoes with range, intensity and the other
/// columns that the program writes. `sensor` is a name of the catalogue; if it is empty, the log's
/// own sensor is taken. The answer is that of `underbrush simulate WORLD --like LOG --super-sample
/// sensor` with that seed.
///
/// Throws `std::invalid_argument` where the catalogue does not have the sensor, or the log names
/// none.
std::string beam_echoes(const LoggedBeam& beam, const WorldData& world, const std::string& sensor,
                        uint64_t seed);

}  // namespace underbrush::serve
