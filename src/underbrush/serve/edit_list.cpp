#include "underbrush/serve/edit_list.hpp"

#include "underbrush/actors/actor_edits.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/serve/edit_list.inl"
#include "underbrush/serve/json_reply.inl"

namespace underbrush::serve {

GivenEdits read_edits(const std::filesystem::path& file) try {
  actors::read_actors(file);
  const Json list = edit_list(read_file(file), "");
  const std::string folder = list.at("actors");
  return {std::filesystem::canonical(file.parent_path() / folder), text_of(list)};
} catch (const std::invalid_argument& e) {
  throw FormatError(file.string(), "", e.what());
}

}  // namespace underbrush::serve
