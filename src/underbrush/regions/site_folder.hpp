/// \file
/// Annotations that are larger than memory: a folder of parts, each with its own ground.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/cells.hpp"
#include "underbrush/sites/generate.hpp"
#include "underbrush/test_site/terrain.hpp"

namespace underbrush::regions {

/// Version of the layout that is written; newer versions are refused.
inline constexpr int kSiteVersion = 1;

/// A part of a site: the annotation of a rectangle, which names the ground there.
struct SitePart {
  Cell2 place;  ///< Column and row of the part.
  std::filesystem::path annotation;
  double south_m = 0;  ///< m, world; no object of the part stands below this y.
};

/// A site in parts.
struct SiteFolder {
  double side_m = 0;            ///< m; the side of a part.
  std::vector<SitePart> parts;  ///< In rows from south to north, in a row from west to east.
};

/// The numbers of the parts, triangles and objects that `generate_site` wrote.
struct GeneratedSite {
  size_t parts = 0, triangles = 0;
  std::map<elements::Class, size_t> objects;  ///< Their numbers by class.
};

/// A function that is called with the number of parts that are done and that of all.
using PartProgress = std::function<void(size_t, size_t)>;

/// Generates a site of terrain (`sites::SiteGenerator`) and writes it in parts of the side
/// `side_m` (m), rounded to whole triangles of the side `spacing_m` (m). Memory is that of a row of
/// parts. Throws `IoError`, and `std::invalid_argument` for options out of range.
GeneratedSite generate_site(const std::filesystem::path& path,
                            const test_site::TerrainParameters& terrain, double spacing_m,
                            double ground_sigma_m, const sites::GenerateOptions& options,
                            double side_m, const std::string& provenance,
                            const PartProgress& progress = {});

/// Whether `path` is a site in parts.
bool is_site(const std::filesystem::path& path);
/// Throws the `IoError` that `generate_site` would begin with.
void check_site_output(const std::filesystem::path& path);
/// Reads the list of the parts of a site. Throws `FormatError`.
SiteFolder read_site(const std::filesystem::path& path);

}  // namespace underbrush::regions
