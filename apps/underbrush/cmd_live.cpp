#include <fmt/format.h>

#include "cli/option_table.hpp"
#include "underbrush/live/other_worlds.hpp"
#include "underbrush/live/server.hpp"
#include "underbrush/serve/token.hpp"
#include "verbs.hpp"

namespace underbrush::app {
void add_live(Program& program) {
  struct Arguments {
    live::WorldOptions world;
    live::ServerOptions server;
    std::string worlds;
  };
  auto a = std::make_shared<Arguments>();
  const auto run = [a](const Verb& verb) {
    a->world.simulate.seed = verb.seed;
    std::string& token = a->server.token;  // The option names its file.
    token = token.empty() ? serve::random_token() : live::read_token(token);
    a->server.version = version();
    const live::OpenedWorld opened = live::open_world(a->world);
    live::OtherWorlds others(a->worlds, a->world);
    live::serve(*live::service_of(*opened.sensors, {}, &others), a->server,
                [&](const std::string& address) {
                  verb.report(
                      {{"address", address}, {"token", token}},
                      fmt::format("listening on {}, token {}; Ctrl-C ends\n", address, token));
                });
  };
  const auto verb = add_verb(program, "Simulation", "live", "Simulate sensors on request (gRPC)",
                             "underbrush live model/ --sensor ouster-os1-128\n"
                             "  underbrush live model/ --rig rig.yaml --mover car=car.obj",
                             run);
  CLI::App& app = verb->app;
  app.add_option("MODEL", a->world.world,
                 "A model, scene, world of regions or mesh; the whole world is read into memory")
      ->required();
  app.add_option("--sensor", a->world.sensor, "A sensor of the catalogue, or a YAML file");
  app.add_option("--rig", a->world.rig, "The sensors of a vehicle")->type_name("RIG.yaml");
  app.add_option("--mover", a->world.movers, "Add an object that clients can move; may be repeated")
      ->type_name("NAME=MODEL");
  app.add_option("--worlds", a->worlds, "Folder of other worlds, which requests may name")
      ->type_name("FOLDER");
  app.add_option("--listen", a->server.address, "HOST:PORT (port 0: a free one), or unix:PATH")
      ->capture_default_str();
  app.add_option("--token", a->server.token, "File with the clients' token")->type_name("FILE");
  add_options(*verb, pipeline::simulate_options(), a->world.simulate, "Instrument",
              {pipeline::kPartsGroup, pipeline::kWaveformsGroup});
}
}  // namespace underbrush::app
