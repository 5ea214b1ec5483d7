/// \file
/// This file gives access to the data files of share/sensors, which are built into the library.
#pragma once
#include <span>
#include <string_view>

namespace underbrush::sensor {

/// A data file of the catalogue: its name and its text.
struct CatalogueEntry {
  std::string_view name, text;
};

/// All data files, sorted by name. CMake generates them.
std::span<const CatalogueEntry> catalogue();

/// The tables of directions (CSV) that data files refer to, by file name. CMake generates them.
std::span<const CatalogueEntry> catalogue_tables();

}  // namespace underbrush::sensor
