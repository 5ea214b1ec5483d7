/// \file
/// The real scan that travels with the program (share/examples), as a log.
#pragma once
#include <filesystem>
#include <optional>

#include "cli/verb.hpp"

namespace underbrush::app {

/// The scan, below the folder of files that travel with the program.
inline constexpr const char* kExampleScan = "examples/marv_forest.pcd";

/// Finds the file of the example scan. It is searched in the folder that the environment variable
/// UNDERBRUSH_SHARE names or, where that is not set, in share/underbrush/ beside an installed
/// program's bin/, or in share/ of the source tree that holds the program's build folder. The
/// result is empty if the file does not exist.
std::optional<std::filesystem::path> example_scan();

/// Imports the scan to `folder`/log.ply and splits it: its odd columns go to test.ply, the others
/// to train.ply. Returns the number of beams.
size_t import_example(const Verb& verb, const std::filesystem::path& scan,
                      const std::filesystem::path& folder);

}  // namespace underbrush::app
