/// \file
/// Requests about labels: docs/reference/serve-api.md.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "underbrush/serve/labels_of_file.hpp"
#include "underbrush/serve/query.hpp"

namespace underbrush::serve {

/// The functions of the server that requests about labels need.
struct ServedFiles {
  std::function<OpenedFile(size_t)> file;  ///< Throws for a number that no file has.
  std::function<LogData*(size_t)> log;     ///< Null for a file that is no log.
  std::function<size_t(const std::filesystem::path&)> add;  ///< Serves another file; its number.
};

/// Answers requests about labels, on any number of threads.
class LabelApi {
 public:
  /// Labels, and files made of them, are written to `folder` and nowhere else.
  LabelApi(ServedFiles files, std::filesystem::path folder);

  /// Answers a request whose path begins with "api/labels". A request that changes labels must be a
  /// POST request.
  HttpReply answer(const HttpRequest& request);

 private:
  LabelsOfFile& labels(const Query& query, const char* key = "file");
  HttpReply files() const;
  HttpReply edit(const Query& query);
  HttpReply box(const Query& query);
  HttpReply step(const Query& query, bool back);
  HttpReply take_over(const Query& query);
  HttpReply carry(const Query& query);
  HttpReply write(const Query& query);
  HttpReply change(const std::string& what, const Query& query);

  ServedFiles files_;
  std::filesystem::path folder_;
  std::mutex mutex_;  ///< Guards the map.
  std::map<size_t, std::unique_ptr<LabelsOfFile>> labels_;
};

}  // namespace underbrush::serve
