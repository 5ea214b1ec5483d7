#include "underbrush/live/open_world.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

#include "underbrush/core/check.hpp"

namespace underbrush::live {
namespace {

void add_mover(pipeline::World& world, const std::string& text) {
  const size_t equals = text.find('=');
  require(equals != std::string::npos && equals > 0 && equals + 1 < text.size(),
          "live: --mover takes NAME=MODEL");
  add_absent(world, text.substr(0, equals), actors::read_mover(text.substr(equals + 1)));
}

}  // namespace

void add_absent(pipeline::World& world, const std::string& name, elements::Model model) {
  pipeline::add_mover(world, std::move(model), Trajectory({StampedPose()}), "", name);
  world.info.movers.back().from_s = std::numeric_limits<double>::infinity();
}

OpenedWorld open_world(const WorldOptions& options) {
  require(options.sensor.empty() != options.rig.empty(), "live: give --sensor NAME or --rig FILE");
  options.simulate.check();
  pipeline::World world = pipeline::read_world(options.world);
  for (const std::string& mover : options.movers) add_mover(world, mover);
  pipeline::change_world(world, options.simulate);
  world.info.materials.resize(world.scene.models.size());
  OpenedWorld out;
  out.world = std::make_unique<pipeline::TracedWorld>(std::move(world),
                                                      pipeline::matter_of(options.simulate));
  out.sensors = options.rig.empty()
                    ? std::make_unique<LiveSensors>(*out.world, options.simulate,
                                                    sensor::load(options.sensor))
                    : std::make_unique<LiveSensors>(*out.world, options.simulate,
                                                    perception::load_rig(options.rig));
  return out;
}

std::string read_token(const std::string& file) {
  constexpr size_t kLeast = 16, kMost = 128;
  std::ifstream in(file);
  std::string token, more;
  if (!in) throw IoError(file + ": cannot be read");
  in >> token;
  const bool is_one_word = !(in >> more) && token.size() >= kLeast && token.size() <= kMost;
  if (!is_one_word || !std::ranges::all_of(token, [](char c) { return c > ' ' && c < 127; })) {
    throw FormatError(file, "", "a token is one word of 16 to 128 printable characters");
  }
  return token;
}

}  // namespace underbrush::live
