/// \file
/// A program that is run to its end. It is internal to the module.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace underbrush::jobs {

/// The end of a program, and the costs of its run.
struct ChildEnd {
  int exit_code = 0;  ///< 128 and the signal's number where a signal ended it.
  double seconds = 0;
  double processor_s = 0;  ///< s; of all its threads.
  uint64_t peak_memory_bytes = 0;
};

/// The verb of studies, which are a program beside that of all other verbs.
inline constexpr const char* kStudy = "study";

/// Returns the words that start a command, where `program` is the path of the program of most
/// verbs.
std::vector<std::string> started(std::vector<std::string> command, const std::string& program);

/// Whether a command has run to its end. A study whose verdict falls short has, with exit code 1.
bool has_ended(const std::vector<std::string>& command, int exit_code);

/// Runs a program, words[0], to its end, with an empty standard input and its output in a new
/// file. It ends with this process, however that one ends. Throws `IoError` where no process can
/// be made.
ChildEnd run_child(std::vector<std::string> words, const std::filesystem::path& printed);

}  // namespace underbrush::jobs
