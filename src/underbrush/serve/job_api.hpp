/// \file
/// Requests that start commands: docs/reference/serve-api.md.
#pragma once
#include <filesystem>
#include <string>

#include "underbrush/serve/jobs.hpp"
#include "underbrush/serve/label_api.hpp"

namespace underbrush::serve {

/// Answers requests about jobs. A job is a verb of this program with files that are served and
/// names in the folder for results; no other words reach its command line but numbers and names
/// from lists.
class JobApi {
 public:
  /// `program` is the program that is started; its outputs go to `folder`.
  JobApi(ServedFiles files, std::filesystem::path folder, std::filesystem::path program);

  /// Answers a request whose path begins with "api/jobs".
  HttpReply answer(const HttpRequest& request);

 private:
  std::vector<std::string> command_of(const Query& query, std::filesystem::path& output) const;
  HttpReply start(const Query& query);

  ServedFiles files_;
  std::filesystem::path folder_, program_;
  Jobs jobs_;
};

}  // namespace underbrush::serve
