#include <algorithm>
#include <array>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/jobs/child.hpp"
#include "underbrush/jobs/fit_tasks.hpp"
#include "underbrush/pipeline/requested_beams.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/regions/open_regions.hpp"
#include "underbrush/regions/site_folder.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::jobs {
namespace fs = std::filesystem;
namespace {

/// A verb whose commands depend on nothing but their inputs, and the options that name outputs.
struct PlannedVerb {
  std::string_view name;
  std::array<std::string_view, 5> outputs;  ///< With the short name before the long one.
};

constexpr PlannedVerb kVerbs[] = {
    {"import", {"-o", "--output", "--json"}},
    {"simulate", {"-o", "--output", "--json"}},
    {"score", {"--json", "--report"}},
    {"fit", {"-o", "--output", "--json"}},
    {"movers", {"-o", "--output", "--json"}},
    {"segment", {"-o", "--output", "--json"}},
    {"compose", {"-o", "--output", "--json"}},
    {"regions", {"-o", "--output", "--json"}},
    {"extract", {"-o", "--output", "--json"}},
    {"rasters", {"-o", "--output", "--json"}},
    {"split", {"--train", "--test"}},
    {"actors", {"-o", "--output", "--marked", "--met", "--json"}},
    {"optimize", {"-o", "--output", "--json", "--report"}},
    {kStudy, {"--json", "--report", "--keep"}},
};

/// Rough costs for the guesses of a plan: of a beam, of a byte that is read, and of a start.
constexpr double kSecondsOfBeam = 2e-6, kSecondsOfByte = 5e-8, kSecondsOfStart = 1;
constexpr uint64_t kBytesOfStart = 256u << 20;

/// A command taken apart.
struct Command {
  std::vector<std::string> words;  ///< Without outputs.
  std::vector<std::string> known;  ///< The same with the settings of its file.
  struct Named {
    std::string option, path;
  };
  std::vector<Named> outputs;
};

const PlannedVerb& verb_of(const std::vector<std::string>& words) {
  const auto* found = std::find_if(std::begin(kVerbs), std::end(kVerbs),
                                   [&](const PlannedVerb& v) { return v.name == words.at(0); });
  if (found != std::end(kVerbs)) return *found;
  std::string known;
  for (const PlannedVerb& v : kVerbs) known += (known.empty() ? "" : ", ") + std::string(v.name);
  throw std::invalid_argument("a plan has commands of " + known + ", not of " +
                              in_quotes(words.at(0)));
}

Command taken_apart(const std::vector<std::string>& words) {
  const PlannedVerb& verb = verb_of(words);
  Command out;
  for (size_t k = 0; k < words.size(); ++k) {
    const size_t equals = words[k].find('=');
    const std::string option = words[k].substr(0, equals);
    if (option.empty() || std::ranges::find(verb.outputs, option) == verb.outputs.end()) {
      out.words.push_back(words[k]);
      continue;
    }
    if (equals == std::string::npos) ++k;
    require(k < words.size(), "the command ends with an option without its value");
    const std::string path = equals == std::string::npos ? words[k] : words[k].substr(equals + 1);
    require(!path.empty() && path != "-", "an output of a task is a file or folder");
    out.outputs.push_back({option, path});
  }
  for (const std::string& word : words) {
    const std::string option = word.substr(0, word.find('='));
    if (option != "--checkpoint" && option != "--resume") continue;
    throw std::invalid_argument(option + " is not for a plan, whose tasks run whole");
  }
  if (out.outputs.empty()) {
    throw std::invalid_argument("the command of " + std::string(verb.name) +
                                " names no output: a task's result is a file or folder");
  }
  out.known = with_settings(out.words);
  return out;
}

/// Makes the plan of one command after the other.
class Planner {
 public:
  Planner(Plan& plan, size_t pieces) : plan_(plan), pieces_(pieces) {}

  void add(const std::vector<std::string>& words) {
    const Command command = taken_apart(words);
    Task task;
    task.command = command.words;
    task.command_number = commands_++;
    task.inputs = inputs_of(command.known);
    const std::string seed = value_of(command.known, "--seed");
    try {
      if (!seed.empty()) task.seed = std::stoull(seed);
    } catch (const std::logic_error&) {
      throw std::invalid_argument("--seed is not a number: " + in_quotes(seed));
    }
    const std::string memory = value_of(command.known, "--memory");
    const uint64_t of_world = regions::memory_of(memory.empty() ? regions::kMemory : memory);
    uint64_t bytes = 0;
    task.memory_bytes = kBytesOfStart;
    for (const std::string& path : task.inputs) {
      const uint64_t of_input = plan_.inputs.at(path).bytes;
      bytes += of_input;
      // A task holds only some regions of a world, or some parts of a site, in memory at a time.
      const bool in_parts = regions::is_world(path) || regions::is_site(path);
      task.memory_bytes += in_parts ? std::min(2 * of_input, of_world) : 2 * of_input;
    }
    task.seconds = kSecondsOfStart + kSecondsOfByte * double(bytes);
    for (const Command::Named& output : command.outputs) {
      if (!results_.insert(fs::path(output.path).lexically_normal().string()).second) {
        throw std::invalid_argument("two results are called " + in_quotes(output.path) +
                                    ": name the values of over in it");
      }
      if (plan_.inputs.contains(output.path)) {
        throw std::invalid_argument(in_quotes(output.path) + " is an input and a result");
      }
    }
    pieces_ == 1 ? add_whole(std::move(task), command) : add_pieces(task, command);
  }

 private:
  /// The words that name a file or folder, whole or after an = or :.
  std::vector<std::string> inputs_of(const std::vector<std::string>& words) {
    std::set<std::string> found;
    const auto add = [&](const std::string& path) {
      std::error_code error;
      const fs::file_status status = fs::status(path, error);
      if (path.empty() || !fs::exists(status)) return;
      if (!fs::is_regular_file(status) && !fs::is_directory(status)) {
        throw std::invalid_argument(in_quotes(path) + " is neither a file nor a folder");
      }
      found.insert(path);
    };
    for (size_t k = 1; k < words.size(); ++k) {
      add(words[k]);
      for (const char mark : {'=', ':'}) {
        for (size_t at = 0; (at = words[k].find(mark, at)) != std::string::npos; ++at) {
          add(words[k].substr(at + 1));
          add(words[k].substr(0, at));
        }
      }
      const size_t first = words[k].find(':'), last = words[k].rfind(':');  // MODEL:POSES:MATERIAL
      if (first != last) add(words[k].substr(first + 1, last - first - 1));
    }
    if (words[0] == "compose" || words[0] == "optimize") add_annotated(found);
    const std::string rig = words[0] == "simulate" ? value_of(words, "--rig") : "";
    if (fs::exists(rig)) {
      for (const perception::MountedSensor& s : perception::load_rig(rig).sensors) add(s.sensor);
    }
    for (const std::string& path : found) {
      if (plan_.inputs.contains(path)) continue;
      plan_.inputs[path] = {io::hash_of_all(regions::hashed_parts(path)), io::size_of(path)};
    }
    return {found.begin(), found.end()};
  }

  /// Adds the grounds and trajectories that annotations name.
  static void add_annotated(std::set<std::string>& found) {
    std::set<std::string> named;
    for (const std::string& path : found) {
      if (!path.ends_with(".json")) continue;
      const primitives::Annotation a = primitives::read_annotation(path, true);
      named.insert(a.ground.string());
      for (const primitives::PlacedObject& o : a.objects) {
        if (!o.trajectory.empty()) named.insert(o.trajectory.string());
      }
    }
    found.merge(named);
  }

  void add_whole(Task task, const Command& command) {
    for (const Command::Named& o : command.outputs) {
      // The name of a folder may end in a slash.
      const fs::path path = fs::path(o.path + "/.").lexically_normal().parent_path();
      plan_.results.push_back({o.path, {plan_.tasks.size()}, task.outputs.size(), 0});
      task.outputs.push_back({o.option, path.filename().string()});
    }
    plan_.tasks.push_back(std::move(task));
  }

  void add_pieces(const Task& whole, const Command& command) {
    const bool is_fit = command.words[0] == "fit";
    require(is_fit || command.words[0] == "simulate", "pieces are of simulate and of fit");
    require(command.outputs.size() == 1 && command.outputs[0].option != "--json",
            "a command that is cut into pieces has one output, the log or the model");
    for (const char* option : {"--profile", "--waveforms", "--beams", "--update", "--stage"}) {
      if (value_of(command.known, option).empty()) continue;
      throw std::invalid_argument(std::string(option) + " is not for pieces");
    }
    if (is_fit) {
      plan_.results.push_back(
          {command.outputs[0].path, {add_fit(whole, command.known, pieces_, plan_)}, 0, 0});
      return;
    }
    const pipeline::RequestedBeams requested = beams_of(command.known);
    BeamSource& beams = requested.source();
    BeamLog chunk;
    beams.rewind();
    require_data(beams.next(chunk), "no beams");
    Result result{command.outputs[0].path, {}, 0, chunk.size()};
    const size_t n = beams.size(), pieces = std::min(pieces_, n);
    for (size_t k = 0; k < pieces; ++k) {
      const size_t first = n / pieces * k + std::min(k, n % pieces);
      const size_t end = first + n / pieces + (k < n % pieces ? 1 : 0);
      Task task = whole;
      task.command.push_back("--beams=" + std::to_string(first) + ":" + std::to_string(end));
      task.outputs = {{"-o", "piece.ublog"}};
      task.seconds += kSecondsOfBeam * double(end - first);
      result.tasks.push_back(plan_.tasks.size());
      plan_.tasks.push_back(std::move(task));
    }
    plan_.results.push_back(std::move(result));
  }

  static pipeline::RequestedBeams beams_of(const std::vector<std::string>& words) {
    const std::string like = value_of(words, "--like");
    if (!like.empty())
      return {std::make_unique<io::BeamReader>(like, pipeline::kSimulatedBeams), like, {}};
    const std::string sensor = value_of(words, "--sensor"), rig = value_of(words, "--rig"),
                      path = value_of(words, "--trajectory");
    require(
        sensor.empty() != rig.empty() && !path.empty(),
        "a command that is cut has --like LOG, or --sensor NAME or --rig FILE with --trajectory "
        "POSES");
    const Trajectory poses = io::read_trajectory(path);
    if (!rig.empty()) return {perception::load_rig(rig), poses};
    return {sensor::load(sensor), poses};
  }

  Plan& plan_;
  size_t pieces_, commands_ = 0;
  std::set<std::string> results_;
};

}  // namespace

Plan make_plan(const Job& job, const std::string& program) {
  Plan plan;
  plan.program = program;
  Planner planner(plan, job.pieces);
  for (const auto& words : commands_of(job)) planner.add(words);
  return plan;
}

}  // namespace underbrush::jobs
