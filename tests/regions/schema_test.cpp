// The published schema of index.json, the writer and the reader have the same members.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/regions/index.hpp"

namespace underbrush::regions {
namespace {

using Json = nlohmann::json;

std::set<std::string> members_of(const Json& object) {
  std::set<std::string> names;
  for (const auto& [name, value] : object.items()) names.insert(name);
  return names;
}

Json json_in(const std::filesystem::path& file) { return Json::parse(std::ifstream(file)); }

TEST(WorldSchema, HasTheMembersOfTheIndex) {
  const io::TemporaryFolder folder;
  Index index;
  index.side_m = 128;
  index.regions.push_back({{-3, 4}, {Vec3(0, 1, 2), Vec3(3, 4, 5)}, {1, 2, 3}, 4, "xxh3:0"});
  write_index(folder.path(), index);
  const Json schema = json_in(UNDERBRUSH_TEST_SCHEMAS "/world.json");
  const Json written = json_in(folder / "index.json");
  const Json &of_region = schema["$defs"]["region"], &region = written["regions"][0];
  EXPECT_EQ(members_of(written), schema["required"].get<std::set<std::string>>());
  EXPECT_EQ(members_of(region), of_region["required"].get<std::set<std::string>>());
  EXPECT_EQ(members_of(region), members_of(of_region["properties"]));
  const Region read = read_index(folder.path()).regions.at(0);
  EXPECT_EQ(read.square, (Cell2{-3, 4}));
  EXPECT_EQ(read.bounds.max(), Vec3(3, 4, 5));
  EXPECT_EQ(read.elements, (std::array<uint32_t, 3>{1, 2, 3}));
  EXPECT_EQ(read.instances, 4u);
  // Each member is needed, and an unknown one is refused.
  const auto refuses = [&](const Json& changed) {
    std::ofstream(folder / "index.json") << changed;
    EXPECT_THROW(read_index(folder.path()), FormatError) << changed;
  };
  for (const std::string& name : members_of(written)) {
    Json changed = written;
    changed.erase(name);
    refuses(changed);
  }
  for (const std::string& name : members_of(region)) {
    Json changed = written;
    changed["regions"][0].erase(name);
    refuses(changed);
  }
  Json changed = written;
  changed["regions"][0]["colour"] = 1;
  refuses(changed);
}

}  // namespace
}  // namespace underbrush::regions
