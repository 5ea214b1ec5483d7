/// \file
/// The parameters of a request, checked.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/serve/http_server.hpp"

namespace underbrush::serve {

/// Reads the parameters of a request. All functions throw `std::invalid_argument` for a parameter
/// that is not as they describe.
class Query {
 public:
  explicit Query(const HttpRequest& request) : request_(request) {}

  bool has(const char* key) const;
  /// The text, or "" where it is absent.
  std::string text(const char* key) const;
  /// A whole number; `otherwise` where it is absent, if that is given.
  uint64_t number(const char* key, std::optional<uint64_t> otherwise = {}) const;
  /// A whole number below 2³², or nothing where it is absent.
  std::optional<uint32_t> number32(const char* key) const;
  /// A finite number.
  double real(const char* key, std::optional<double> otherwise = {}) const;
  /// Finite numbers with commas between them; `count` of them unless that is 0.
  std::vector<double> reals(const char* key, size_t count = 0) const;
  /// Whole numbers below 2³² with commas between them; none where it is absent.
  std::vector<uint32_t> numbers(const char* key) const;
  /// A name for a file in a folder: letters, digits, '.', '_' and '-', at most 80, no dot at the
  /// start.
  std::string file_name(const char* key) const;

 private:
  [[noreturn]] static void fail(const char* key, const char* what);
  const HttpRequest& request_;
};

}  // namespace underbrush::serve
