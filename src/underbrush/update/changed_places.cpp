#include "underbrush/update/changed_places.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace underbrush::update {

std::vector<ChangedPlace> changed_places(const std::vector<Vec3>& gone) {
  constexpr double kSideM = 4;
  constexpr size_t kMost = 10;
  std::map<std::pair<int64_t, int64_t>, ChangedPlace> cells;
  for (const Vec3& at : gone) {
    ChangedPlace& cell =
        cells[{int64_t(std::floor(at.x() / kSideM)), int64_t(std::floor(at.y() / kSideM))}];
    cell.centre += at;
    ++cell.gone;
  }
  std::vector<ChangedPlace> out;
  out.reserve(cells.size());
  for (const auto& [key, cell] : cells) out.push_back({cell.centre / double(cell.gone), cell.gone});
  std::stable_sort(out.begin(), out.end(),
                   [](const ChangedPlace& a, const ChangedPlace& b) { return a.gone > b.gone; });
  if (out.size() > kMost) out.resize(kMost);
  return out;
}

}  // namespace underbrush::update
