#include "underbrush/core/names.hpp"

#include <algorithm>
#include <numeric>

namespace underbrush {
namespace {

/// Returns the Levenshtein distance.
size_t distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t(0));
  for (size_t i = 0; i < a.size(); ++i) {
    size_t corner = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = corner + (a[i] == b[j] ? 0 : 1);
      corner = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
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
