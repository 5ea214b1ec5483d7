/// \file
/// The check that the outputs of a verb destroy neither its inputs nor the files of others.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace underbrush::app {

/// A file or folder that a verb writes.
struct Output {
  std::string option;          ///< The option that names it, such as "-o".
  std::filesystem::path path;  ///< Empty: not written.
  /// The files that are written into a folder that is not replaced as a whole; empty for others.
  std::vector<std::string> files = {};
};

/// Returns whether this program made the file: it is empty, names Underbrush near its start or end,
/// or begins as our tables do.
bool is_ours(const std::filesystem::path& file);

/// Throws `std::invalid_argument` if two outputs are the same file or one lies in another, and if
/// an output is one of the `inputs` or would replace one; throws `IoError` if an output would
/// replace a file that is not ours, unless `force`. Files are compared by their places, through
/// links, not by name.
void check_outputs(const std::vector<Output>& outputs,
                   const std::vector<std::filesystem::path>& inputs, bool force);

}  // namespace underbrush::app
