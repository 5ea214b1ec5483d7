/// \file
/// What the server answers: the page, and the data of the files that it was started for.
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

/// Answers requests about files, which are known by their number in the list and by nothing else.
class Api {
 public:
  /// `version` is shown on the page; `cache` is the folder of `cached_octree`; `seed` is that of
  /// traces that name none.
  Api(OpenedFiles files, std::filesystem::path cache, std::string version, uint64_t seed = 1);
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
