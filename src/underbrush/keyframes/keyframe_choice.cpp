#include "underbrush/keyframes/keyframe_choice.hpp"

#include <algorithm>
#include <bit>
#include <optional>

namespace underbrush::keyframes {
namespace {

/// Keyframes that may lie nearer to one another than the spacing.
constexpr size_t kMostNear = 16, kLeastNear = 2;

/// The numbers below n, such that each beginning of them is spread evenly.
std::vector<size_t> evenly(size_t n) {
  std::vector<size_t> out;
  const size_t slots = std::bit_ceil(n);
  for (size_t k = 0; k < slots; ++k) {
    size_t reversed = 0;  // in binary digits
    for (size_t bit = 1; bit < slots; bit *= 2) reversed = 2 * reversed + (k & bit ? 1 : 0);
    if (reversed < n) out.push_back(reversed);
  }
  return out;
}

/// The places that are chosen such that fewer than `most_near` others lie nearer than the spacing;
/// nothing if they are more than `most`.
std::optional<std::vector<size_t>> chosen(const std::vector<Vec3>& places, double spacing_m,
                                          size_t most_near, size_t most) {
  std::vector<size_t> out;
  for (const size_t k : evenly(places.size())) {
    const auto is_near = [&](size_t o) { return (places[o] - places[k]).norm() < spacing_m; };
    if (size_t(std::count_if(out.begin(), out.end(), is_near)) >= most_near) continue;
    out.push_back(k);
    if (out.size() > most) return {};
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

std::vector<size_t> chosen_keyframes(const std::vector<Vec3>& places,
                                     const KeyframeOptions& options, size_t bytes) {
  const size_t most = std::max(kLeastNear, options.most_bytes / bytes);
  size_t near = kMostNear;
  double spacing = options.spacing_m;
  while (true) {
    if (auto out = chosen(places, spacing, near, most)) return *out;
    if (near > kLeastNear) {
      near /= 2;
    } else {
      spacing *= 1.25;
    }
  }
}

}  // namespace underbrush::keyframes
