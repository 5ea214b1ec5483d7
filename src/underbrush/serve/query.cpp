#include "underbrush/serve/query.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

namespace underbrush::serve {
namespace {

template <class T>
std::optional<T> parsed(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T>
std::optional<std::vector<T>> parsed_list(std::string_view text) {
  std::vector<T> out;
  for (size_t at = 0; at <= text.size();) {
    const size_t comma = std::min(text.find(',', at), text.size());
    const auto value = parsed<T>(text.substr(at, comma - at));
    if (!value) return std::nullopt;
    out.push_back(*value);
    at = comma + 1;
  }
  return out;
}

}  // namespace

void Query::fail(const char* key, const char* what) {
  throw std::invalid_argument(std::string("the request needs ") + what + " '" + key + "'");
}

bool Query::has(const char* key) const { return !text(key).empty(); }

std::string Query::text(const char* key) const {
  const auto found = request_.query.find(key);
  return found == request_.query.end() ? "" : found->second;
}

uint64_t Query::number(const char* key, std::optional<uint64_t> otherwise) const {
  if (otherwise && !has(key)) return *otherwise;
  const auto value = parsed<uint64_t>(text(key));
  if (!value) fail(key, "a number");
  return *value;
}

std::optional<uint32_t> Query::number32(const char* key) const {
  if (!has(key)) return std::nullopt;
  const auto value = parsed<uint32_t>(text(key));
  if (!value) fail(key, "a number below 2^32");
  return value;
}

double Query::real(const char* key, std::optional<double> otherwise) const {
  if (otherwise && !has(key)) return *otherwise;
  const auto value = parsed<double>(text(key));
  if (!value || !std::isfinite(*value)) fail(key, "a number");
  return *value;
}

std::vector<double> Query::reals(const char* key, size_t count) const {
  auto values = parsed_list<double>(text(key));
  const bool finite = values && std::all_of(values->begin(), values->end(),
                                            [](double v) { return std::isfinite(v); });
  if (!finite || (count != 0 && values->size() != count)) fail(key, "a list of numbers");
  return *values;
}

std::vector<uint32_t> Query::numbers(const char* key) const {
  if (!has(key)) return {};
  const auto values = parsed_list<uint32_t>(text(key));
  if (!values) fail(key, "a list of numbers");
  return *values;
}

std::string Query::file_name(const char* key) const {
  std::string name = text(key);
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  };
  if (name.empty() || name.size() > 80 || name[0] == '.' || name[0] == '-' ||
      !std::all_of(name.begin(), name.end(), allowed)) {
    fail(key, "a file's name of letters, digits, '.', '_' and '-'");
  }
  return name;
}

}  // namespace underbrush::serve
