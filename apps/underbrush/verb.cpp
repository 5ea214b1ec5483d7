#include "verb.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "version.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

double now_s() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

void hash_into(XXH3_state_t& state, const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> buffer(1 << 20);
  while (in.read(buffer.data(), std::streamsize(buffer.size())) || in.gcount() > 0) {
    XXH3_128bits_update(&state, buffer.data(), size_t(in.gcount()));
  }
}

// Of a folder: of all files in it, in order of name.
std::string hash_of(const fs::path& path) {
  std::vector<fs::path> files;
  if (fs::is_directory(path)) {
    for (const auto& entry : fs::recursive_directory_iterator(path)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
  } else {
    files = {path};
  }
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_128bits_reset(state.get());
  for (const fs::path& file : files) hash_into(*state, file);
  const XXH128_hash_t h = XXH3_128bits_digest(state.get());
  return fmt::format("xxh3:{:016x}{:016x}", h.high64, h.low64);
}

std::vector<std::string>& command_line() {
  static std::vector<std::string> words;
  return words;
}

// The command without what does not change the result: where outputs go, threads, interruptions.
std::vector<std::string> command_of_result() {
  static const std::set<std::string> kDropped = {"-o",       "--output", "--json", "--threads",
                                                 "--report", "--train",  "--test", "--checkpoint"};
  std::vector<std::string> out{"underbrush"};
  for (size_t i = 1; i < command_line().size(); ++i) {
    const std::string& word = command_line()[i];
    const size_t equals = word.find('=');
    if (word == "--resume") continue;
    if (!kDropped.count(word.substr(0, equals))) {
      out.push_back(word);
    } else if (equals == std::string::npos) {
      ++i;  // and its value
    }
  }
  return out;
}

// Devices and pipes are written to as they are; a file beside them makes no sense.
bool is_device(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::is_character_file(status) || fs::is_fifo(status);
}

}  // namespace

void remember_command_line(int argc, char** argv) { command_line().assign(argv, argv + argc); }

void Verb::report(const Json& results, const std::string& table) const {
  if (json != "-" && !(std::cout << table << std::flush)) {
    throw IoError("standard output: cannot write");
  }
  if (json.empty()) return;
  const std::string text = results.dump(2) + "\n";
  if (json == "-") {
    if (!(std::cout << text << std::flush)) throw IoError("standard output: cannot write");
    return;
  }
  if (is_device(json)) {
    std::ofstream out(json);
    if (!(out << text << std::flush)) throw IoError(json + ": cannot write");
    return;
  }
  io::write_atomically(json, text);
}

std::shared_ptr<Verb> add_verb(CLI::App& root, const std::string& name, const std::string& summary,
                               const std::string& example,
                               const std::function<void(const Verb&)>& run) {
  auto verb = std::make_shared<Verb>();
  CLI::App* app = root.add_subcommand(name, summary);
  verb->app = app;
  app->add_option("--seed", verb->seed, "Seed of all random numbers")->capture_default_str();
  app->add_option("--threads", verb->threads, "Threads to use, 0 = all")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app->add_option("--json", verb->json, "Write the results as JSON to FILE, - for standard output")
      ->type_name("FILE|-");
  app->footer("Example:\n  " + example);
  app->callback([verb, run] {
    set_threads(verb->threads);
    if (!verb->json.empty() && verb->json != "-" && !is_device(verb->json)) {
      io::check_output(verb->json);
    }
    run(*verb);
  });
  return verb;
}

std::string provenance(const Verb& verb, const std::vector<fs::path>& inputs) {
  Json p;
  p["program"] = "underbrush " UNDERBRUSH_VERSION;
  p["command"] = command_of_result();
  p["seed"] = verb.seed;
  p["inputs"] = Json::object();
  for (const fs::path& input : inputs) p["inputs"][input.string()] = hash_of(input);
  for (const std::string& file : verb.app->get_option("--config")->results()) {
    p["inputs"][file] = hash_of(file);
  }
  return p.dump();
}

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1), start_s_(now_s()) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void Progress::operator()(size_t done, size_t total) {
  if (!terminal_) return;
  const double t = now_s();
  if (t - last_s_ < 0.1) return;
  last_s_ = t;
  shown_ = true;
  const double share = total ? double(done) / double(total) : 0;
  const int filled = int(30 * share);
  std::string line =
      fmt::format("\r\x1b[K{} [{:-<30}] {:3.0f} %", what_, std::string(filled, '#'), 100 * share);
  if (share > 0.02) line += fmt::format("  {:.0f} s left", (t - start_s_) * (1 / share - 1));
  std::fputs(line.c_str(), stderr);
}

void StageProgress::operator()(std::string_view stage, size_t done, size_t total) {
  if (stage != stage_ || done == 0) {
    line_.reset();  // clears its line before the next begins
    stage_ = stage;
    line_ = std::make_unique<Progress>(stage_);
  }
  (*line_)(done, total);
}

std::string si(double value) {
  const char* units[] = {"", " k", " M", " G", " T"};
  int k = 0;
  while (std::abs(value) >= 1000 && k < 4) {
    value /= 1000;
    ++k;
  }
  return fmt::format("{:.3g}{}", value, units[k]);
}

}  // namespace underbrush::app
