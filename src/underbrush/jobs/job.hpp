/// \file
/// The file that describes a job: a command of the program, the values that it is repeated for, and
/// the number of its parts.
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace underbrush {
/// Work cut into tasks that run anywhere, in any order, and whose results are joined.
namespace jobs {

/// A command, for each combination of the values of `over`.
struct Job {
  std::vector<std::string> command;  ///< The words after the program's name; {NAME} is a value.
  std::map<std::string, std::vector<std::string>> over;  ///< The values of each name.
  size_t pieces = 1;  ///< Parts into which the beams of each command are cut.
};

/// Reads a job's file (YAML): `command`, a text that is cut at blanks or a list of words; `over`, a
/// map of lists; `pieces`, a number. Throws `FormatError`.
Job read_job(const std::filesystem::path& path);

/// Returns the command for each combination of values, the last name's values in turn first. Throws
/// `std::invalid_argument` where {NAME} has no values, or a name is not in the command.
std::vector<std::vector<std::string>> commands_of(const Job& job);

/// Returns a command followed by the settings of its `--config` file, as options NAME=VALUE, but
/// for those that the command has itself. Throws `FormatError`.
std::vector<std::string> with_settings(const std::vector<std::string>& words);

}  // namespace jobs
}  // namespace underbrush
