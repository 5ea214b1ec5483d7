#include "underbrush/worlds/read_world.hpp"

namespace underbrush::worlds {

bool is_world(const std::filesystem::path& path) { return is_mesh(path); }

World read_world(const std::filesystem::path& path, const ReadOptions& options) {
  return read_mesh_world(path, options.mesh);
}

}  // namespace underbrush::worlds
