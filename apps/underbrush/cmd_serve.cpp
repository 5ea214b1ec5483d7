#include <fmt/format.h>

#include "underbrush/core/check.hpp"
#include "underbrush/serve/api.hpp"
#include "underbrush/serve/octree_cache.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace serve_verb {

struct Arguments {
  std::vector<std::string> paths;
  std::string cache, labels;
  int port = 0;
};

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw IoError(folder.string() + ": cannot be made a folder");
  }
}

void run(const Verb& verb, const Arguments& a) {
  serve::OpenedFiles files = serve::find_files({a.paths.begin(), a.paths.end()});
  const std::filesystem::path cache =
      a.cache.empty() ? serve::user_cache() : std::filesystem::path(a.cache);
  Json j{{"files", Json::array()}, {"notes", files.notes}};
  std::string text;
  for (const serve::OpenedFile& f : files.files) {
    j["files"].push_back({{"name", f.name}, {"kind", serve::name(f.kind)}});
    text += fmt::format("  {:<11} {}\n", serve::name(f.kind), printable(f.name));
  }
  for (const std::string& note : files.notes) text += fmt::format("  {}\n", note);
  serve::ApiOptions options{cache, version(), verb.seed, {}, {}};
  if (!a.labels.empty()) {
    make_folder(a.labels);
    options.labels = std::filesystem::canonical(a.labels);
    options.program = std::filesystem::canonical("/proc/self/exe");
    j["labels"] = options.labels.string();
  }
  serve::Api api(std::move(files), std::move(options));
  serve::HttpServer server(a.port,
                           [&](const serve::HttpRequest& request) { return api.answer(request); });
  j["address"] = server.address();
  verb.report(j, text + fmt::format("open {} in a browser; Ctrl-C ends\n", server.address()));
  server.run();
}

}  // namespace serve_verb
}  // namespace

void add_serve(Program& program) {
  using namespace serve_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Start", "serve", "Show logs, models, scenes and scores in the browser",
               "underbrush serve log.ply model/\n"
               "  underbrush serve folder/\n"
               "  underbrush serve log.ply world/ edits.json --labels work/",
               [a](const Verb& v) { run(v, *a); });
  CLI::App& app = verb->app;
  app.add_option(
         "PATH", a->paths,
         "Logs, scores (score --json), folders of models, scenes, worlds of regions or sets of "
         "primitives, or folders of these, and a list of edits of actors. A world of regions is "
         "read completely. Files that are not named here are not read")
      ->required();
  verb->not_of_result(app.add_option("--port", a->port, "Port of this machine; 0 = a free one")
                          ->check(CLI::Range(0, 65535))
                          ->capture_default_str());
  verb->not_of_result(
      app.add_option("--cache", a->cache,
                     "Folder for the octrees of logs; default: underbrush in $XDG_CACHE_HOME or in "
                     "~/.cache")
          ->type_name("FOLDER"));
  verb->not_of_result(
      app.add_option("--labels", a->labels,
                     "Allow the page to label logs, place boxes and start commands, and to write "
                     "to this folder alone; without this option nothing is written")
          ->type_name("FOLDER"));
}

}  // namespace underbrush::app
