// The command line of a benchmark. Its parser is compiled once, and not with every benchmark.
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace underbrush::bench {

/// The options of a benchmark.
class CommandLine {
 public:
  /// The variable that an option sets; a `bool` is that of a flag.
  using Value = std::variant<bool*, int*, size_t*, double*, std::string*, std::vector<size_t>*,
                             std::vector<std::string>*>;

  explicit CommandLine(const std::string& title);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
  ~CommandLine();

  /// Adds an option, whose value so far is its default. If there are `choices`, it takes no others.
  void add(const std::string& name, Value value, const std::string& help,
           const std::vector<std::string>& choices = {});
  /// Adds the option `--json`, the file to which `write` writes.
  void add_json();
  /// Returns the exit status if the program is to end: after its help, or for a wrong option.
  std::optional<int> parse(int argc, char** argv);
  /// Writes figures to the file that the user named, if any.
  void write(const nlohmann::ordered_json& figures) const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  std::string json_file_;
};

}  // namespace underbrush::bench
