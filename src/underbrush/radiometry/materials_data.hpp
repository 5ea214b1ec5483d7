/// \file
/// This file gives access to the table of share/materials, which is built into the library.
#pragma once
#include <string_view>

namespace underbrush::radiometry {

/// The text of share/materials/materials.yaml. CMake generates it.
std::string_view materials_yaml();

}  // namespace underbrush::radiometry
