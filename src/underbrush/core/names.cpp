#include "underbrush/core/names.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace underbrush {
namespace {

/// Returns the Levenshtein distance, in which neighbours that changed places count once.
size_t distance(std::string_view a, std::string_view b) {
  std::vector<size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t(0));
  for (size_t i = 0; i < a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = last[j] + (a[i] == b[j] ? 0 : 1);
      row[j + 1] = std::min({replaced, row[j] + 1, last[j + 1] + 1});
      const bool swapped = i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j];
      if (swapped) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view given, const std::vector<std::string>& known) {
  std::string name(given);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
  size_t least = SIZE_MAX;
  std::string best;
  for (const std::string& k : known) {
    size_t d = distance(name, k);
    // `name` may be the part of a known name behind a dash, with a mistake or two.
    for (size_t dash = k.find('-'); dash != std::string::npos; dash = k.find('-', dash + 1)) {
      const size_t part = distance(name, std::string_view(k).substr(dash + 1));
      if (2 * part <= name.size()) d = std::min(d, part + 1);
    }
    if (d >= least || 2 * d > k.size()) continue;
    least = d;
    best = k;
  }
  return best;
}

}  // namespace underbrush
