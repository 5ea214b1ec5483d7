/// \file
/// The answers of the server: the page, and the data of the files that it was started for.
/// docs/reference/serve-api.md lists the requests.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/serve/http_server.hpp"
#include "underbrush/serve/opened_files.hpp"

namespace underbrush::serve {

/// The greatest part of an octree that one request may ask for, bytes.
inline constexpr uint64_t kMostBytes = uint64_t(16) << 20;

/// Options of `Api`.
struct ApiOptions {
  std::filesystem::path cache;  ///< The folder of `cached_octree`.
  std::string version;          ///< Shown on the page.
  uint64_t seed = 1;            ///< Seed of traces that name none.
  /// The folder to which labels, and results of commands, are written; empty: nothing is written.
  std::filesystem::path labels;
  std::filesystem::path program;  ///< The program that runs commands; empty: none are run.
};

/// Answers requests about files, which are known by their number in the list and by nothing else.
class Api {
 public:
  Api(OpenedFiles files, ApiOptions options);
  ~Api();
  Api(const Api&) = delete;
  Api& operator=(const Api&) = delete;

  /// Answers a request; several threads may call it. Throws `std::invalid_argument` for a request
  /// that makes no sense, and what reading the files throws.
  HttpReply answer(const HttpRequest& request);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace underbrush::serve
