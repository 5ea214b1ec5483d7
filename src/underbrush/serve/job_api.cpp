#include "underbrush/serve/job_api.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <span>
#include <sstream>

#include "underbrush/actors/learn_actors.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/seed.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/pipeline/annotate_site.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/pipeline/extract_primitives.hpp"
#include "underbrush/pipeline/score_logs.hpp"
#include "underbrush/pipeline/segment_log.hpp"
#include "underbrush/pipeline/simulate_options.hpp"
#include "underbrush/serve/json_reply.inl"
#include "underbrush/update/fit_log_options.hpp"

namespace underbrush::serve {
namespace {

// Which kinds of files a place of the command line takes.
enum class Takes { kLog, kModel, kWorld, kPrimitives, kWritten };

// A word of a command: a file that the request names by its number (or, for one that the page
// wrote, by its name in the folder), after the option's name if it has one.
struct Input {
  const char* key;
  const char* option;
  Takes takes;
  bool needed;
};
// An option that a request may set, with `_` for `-` in its key.
struct Setting {
  std::string name;  ///< Without dashes.
  std::string group, unit, help, value, type, usual;
  double least = -kNoLimit, most = kNoLimit;
  std::vector<std::string_view> choices = {};

  std::string key() const {
    std::string out = name;
    std::replace(out.begin(), out.end(), '-', '_');
    return out;
  }
};

// Whether the value of an option is text of a form that is stated, and names no file.
template <class Row>
bool is_plain_text(const Row& row) {
  const std::string_view type = type_of(row);
  if ((type != "str" && type != "Sequence[str]") || row.value.empty()) return false;
  for (const std::string_view place : {"ANNOTATION", "PRIMITIVES", ".json"}) {
    if (row.value.find(place) != std::string_view::npos) return false;
  }
  return true;
}

// The rows of a table that name no file and that help lists, without those of the group `left_out`.
template <class Row>
std::vector<Setting> settings_of(std::span<const Row> table, std::string_view left_out = "none") {
  const typename Row::Options defaults{};
  std::vector<Setting> out;
  for (const Row& row : table) {
    const std::string type(type_of(row));
    const bool is_value = type == "float" || type == "int" || type == "bool";
    if (!is_value && row.choices.empty() && !is_plain_text(row)) continue;
    if (row.group == left_out) continue;
    if constexpr (requires { row.listed; }) {
      if (row.listed == fit::Listed::kReference) continue;
    }
    out.push_back({std::string(row.name), std::string(row.group), std::string(row.unit),
                   std::string(row.help), std::string(row.value), type, text_of(row, defaults),
                   row.least, row.most, row.choices});
  }
  return out;
}

const Setting kSeed{"seed", "", "", kSeedHelp, "", "int", text_of(fit::FitOptions().seed), 0, 9e15};

std::vector<Setting> with_seed(std::vector<Setting> settings) {
  settings.insert(settings.begin(), kSeed);
  return settings;
}

std::vector<Setting> joined(std::vector<Setting> settings, const std::vector<Setting>& more) {
  settings.insert(settings.end(), more.begin(), more.end());
  return settings;
}

struct Verb {
  const char* name;
  std::vector<Input> inputs;
  std::vector<Setting> settings;
  const char* extension;    ///< Ending of the output's name; "" for a folder.
  const char* action = "";  ///< The word after the verb, if it takes one.
};

const std::vector<Verb>& verbs() {
  static const std::vector<Verb> kVerbs = {
      {"segment",
       {{"log", "", Takes::kLog, true}},
       settings_of(pipeline::segment_options()),
       ".ply"},
      {"fit",
       {{"log", "", Takes::kLog, true}},
       with_seed(joined(settings_of(fit::parameters()),
                        settings_of(update::fit_log_options(), update::kUpdateGroup))),
       ""},
      {"extract",
       {{"model", "", Takes::kModel, true}, {"log", "", Takes::kLog, true}},
       settings_of(pipeline::extract_options()),
       ""},
      {"annotate",
       {{"log", "", Takes::kLog, true}, {"ground", "--ground", Takes::kModel, false}},
       settings_of(pipeline::annotate_options(), "Generated site"),
       ".json"},
      {"compose",
       {{"annotation", "", Takes::kWritten, true},
        {"primitives", "", Takes::kPrimitives, true},
        {"ground", "--ground", Takes::kModel, false}},
       with_seed(settings_of(pipeline::compose_options())),
       ""},
      {"primitives",
       {{"primitives", "", Takes::kPrimitives, true}, {"edits", "--edits", Takes::kWritten, false}},
       {},
       "",
       "merge"},
      {"actors",
       {{"log", "", Takes::kLog, true}, {"boxes", "--boxes", Takes::kWritten, false}},
       settings_of(actors::actor_options()),
       ""},
      {"simulate",
       {{"world", "", Takes::kWorld, true},
        {"like", "--like", Takes::kLog, true},
        {"actors", "--actors", Takes::kWritten, false}},
       with_seed(settings_of(pipeline::simulate_options())),
       ".ply"},
      {"score",
       {{"real", "", Takes::kLog, true},
        {"simulated", "", Takes::kLog, true},
        {"model", "--model", Takes::kWorld, false},
        {"train", "--train", Takes::kLog, false}},
       settings_of(pipeline::score_options()),
       ".json"},
  };
  return kVerbs;
}

bool fits(FileKind kind, Takes takes) {
  switch (takes) {
    case Takes::kLog:
      return kind == FileKind::kLog;
    case Takes::kModel:
      return kind == FileKind::kModel;
    case Takes::kWorld:
      return kind == FileKind::kModel || kind == FileKind::kScene;
    case Takes::kPrimitives:
      return kind == FileKind::kPrimitives;
    case Takes::kWritten:
      break;
  }
  return false;
}

// A command line as a person types it.
std::string shell_text(std::span<const std::string> words) {
  std::string out;
  for (const std::string& word : words) {
    const bool plain =
        !word.empty() &&
        word.find_first_not_of(
            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/=:,+@%") ==
            std::string::npos;
    out += out.empty() ? "" : " ";
    if (plain) {
      out += word;
      continue;
    }
    out += '\'';
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    out += '\'';
  }
  return printable(out, 4000);
}

Json json_of(const JobFacts& f) {
  std::vector<std::string> shown = f.command;
  shown[0] = "underbrush";
  return {{"number", f.number},
          {"verb", f.command[1]},
          {"command", shell_text(shown)},
          {"state", name(f.state)},
          {"exit_code", f.exit_code},
          {"seconds", f.seconds},
          {"progress", printable(f.progress)}};
}

std::string number_text(double value, bool whole) {
  char text[40];
  std::snprintf(text, sizeof(text), whole ? "%.0f" : "%.12g", value);
  return text;
}

// An option and its values, which a request separates by blanks. A value begins with a letter or a
// digit and has no slash, so that it is neither an option nor a path. A second value of an option
// that takes one would be a file to the command.
std::vector<std::string> with_values(const std::string& option, bool is_list,
                                     const std::string& text) {
  std::vector<std::string> out{option};
  std::istringstream words(text);
  for (std::string word; words >> word; out.push_back(word)) {
    const bool plain = word.size() <= 80 &&
                       std::isalnum(static_cast<unsigned char>(word.front())) &&
                       word.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                           "_-=:,.+") == std::string::npos;
    require(plain, "a value with other characters than letters, digits and _ - = : , . +");
  }
  require(out.size() > 1, "a value is missing");
  require(is_list || out.size() == 2, "more than one value");
  return out;
}

// The words by which a command takes what the request says of a setting.
std::vector<std::string> words_of(const Setting& setting, const Query& query) {
  const std::string key = setting.key(), option = "--" + setting.name;
  if (!query.has(key.c_str())) return {};
  if (setting.type == "bool") {
    const std::string word = query.text(key.c_str());
    require(word == "true" || word == "false", "a flag is true or false");
    return word == "true" ? std::vector<std::string>{option} : std::vector<std::string>{};
  }
  if (!setting.choices.empty()) {
    const std::string word = query.text(key.c_str());
    require(std::count(setting.choices.begin(), setting.choices.end(), word) == 1,
            "a word that is none of the choices");
    return {option, word};
  }
  if (setting.type != "float" && setting.type != "int") {
    return with_values(option, setting.type != "str", query.text(key.c_str()));
  }
  const double value = query.real(key.c_str());
  const bool whole = setting.type == "int";
  require(value >= setting.least && value <= setting.most && (!whole || value == std::floor(value)),
          "a number beyond its limits");
  return {option, number_text(value, whole)};
}

Json limit(double value) { return std::isinf(value) ? Json(nullptr) : Json(value); }

Json json_of(const Setting& s) {
  return {{"name", s.name},      {"group", s.group},        {"type", s.type},
          {"default", s.usual},  {"unit", s.unit},          {"help", s.help},
          {"value", s.value},    {"least", limit(s.least)}, {"most", limit(s.most)},
          {"choices", s.choices}};
}

// The settings of all commands, by command.
Json all_settings() {
  Json out = Json::object();
  for (const Verb& verb : verbs()) {
    if (verb.settings.empty()) continue;
    for (const Setting& setting : verb.settings) out[verb.name].push_back(json_of(setting));
  }
  return out;
}

}  // namespace

JobApi::JobApi(ServedFiles files, std::filesystem::path folder, std::filesystem::path program)
    : files_(std::move(files)), folder_(std::move(folder)), program_(std::move(program)) {}

std::vector<std::string> JobApi::command_of(const Query& query,
                                            std::filesystem::path& output) const {
  const std::string wanted = query.text("verb");
  const auto verb =
      std::find_if(verbs().begin(), verbs().end(), [&](const Verb& v) { return v.name == wanted; });
  require(verb != verbs().end(), "no such command");
  std::vector<std::string> words{program_.string(), verb->name};
  if (*verb->action) words.emplace_back(verb->action);
  for (const Input& input : verb->inputs) {
    if (!query.has(input.key) && !input.needed) continue;
    std::filesystem::path path;
    if (input.takes == Takes::kWritten) {
      path = folder_ / query.file_name(input.key);
      require(std::filesystem::is_regular_file(std::filesystem::symlink_status(path)),
              "no such file in the folder");
    } else {
      const OpenedFile file = files_.file(query.number(input.key));
      if (!fits(file.kind, input.takes)) {
        throw std::invalid_argument(std::string("the file for '") + input.key +
                                    "' is of another kind");
      }
      path = file.path;
    }
    if (*input.option) words.emplace_back(input.option);
    words.push_back(path.string());
  }
  for (const Setting& setting : verb->settings) {
    for (std::string& word : words_of(setting, query)) words.push_back(std::move(word));
  }
  if (wanted == "compose") words.emplace_back("--allow-outside");
  output = folder_ / query.file_name("name");
  require(output.extension() == verb->extension, "the name of the result has another ending");
  require(!std::filesystem::exists(std::filesystem::symlink_status(output)),
          "a file of this name is there already");
  words.insert(words.end(), {wanted == "score" ? "--json" : "-o", output.string()});
  return words;
}

HttpReply JobApi::start(const Query& query) {
  std::filesystem::path output;
  const std::vector<std::string> command = command_of(query, output);
  const bool served = command[1] != "annotate";  // an annotation is no file that can be looked at
  const size_t number = jobs_.start(command, [this, output, served] {
    if (served) files_.add(output);
  });
  return reply_of(json_of(jobs_.job(number)));
}

HttpReply JobApi::answer(const HttpRequest& request) {
  const Query query(request);
  if (request.path == "api/jobs") {
    Json j{{"jobs", Json::array()}};
    for (const JobFacts& facts : jobs_.list()) j["jobs"].push_back(json_of(facts));
    return reply_of(j);
  }
  if (request.path == "api/jobs/options") return reply_of(all_settings());
  if (request.path == "api/jobs/log") {
    const JobFacts facts = jobs_.job(query.number("number"));
    Json j = json_of(facts);
    j["log"] = facts.log;
    return reply_of(j);
  }
  if (request.path == "api/jobs/command") {
    std::filesystem::path output;
    std::vector<std::string> words = command_of(query, output);
    words[0] = "underbrush";
    return reply_of({{"command", shell_text(words)}});
  }
  if (request.method != "POST") return error_reply(405, "only POST starts commands");
  if (request.path == "api/jobs/start") return start(query);
  if (request.path == "api/jobs/cancel") {
    jobs_.cancel(query.number("number"));
    return reply_of(Json::object());
  }
  return error_reply(404, "no such page");
}

}  // namespace underbrush::serve
