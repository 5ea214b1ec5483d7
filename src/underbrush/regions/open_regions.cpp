#include "underbrush/regions/open_regions.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/regions/reach.hpp"

namespace underbrush::regions {
namespace {

std::string in_mib(uint64_t bytes) { return std::to_string((bytes >> 20) + 1) + " MiB"; }

}  // namespace

OpenRegions::OpenRegions(const WorldFolder& world, uint64_t memory_bytes)
    : world_(world),
      memory_bytes_(memory_bytes),
      for_regions_(memory_bytes - std::min(memory_bytes, world.common_bytes())),
      last_needed_(world.index().regions.size()),
      is_open_(world.index().regions.size()) {
  for (uint32_t k = 0; k < is_open_.size(); ++k) place_[world.index().regions[k].square] = k;
}

uint64_t OpenRegions::bytes_of(const std::vector<uint32_t>& regions) const {
  return std::accumulate(
      regions.begin(), regions.end(), uint64_t(0),
      [&](uint64_t sum, uint32_t k) { return sum + world_.index().regions[k].bytes(); });
}

size_t OpenRegions::open_for(const BeamLog& beams, size_t begin, const Reach& reach) {
  for (size_t count = beams.size() - begin;; count = (count + 1) / 2) {
    const std::vector<uint32_t> needed =
        reached(world_.index(), beams, begin, begin + count, reach.range_m, reach.spread_m);
    if (bytes_of(needed) <= for_regions_) {
      open(needed);
      return begin + count;
    }
    if (count > 1) continue;
    throw_too_little_memory("the regions that one beam can reach take",
                            world_.common_bytes() + bytes_of(needed), memory_bytes_);
  }
}

std::vector<uint32_t> OpenRegions::around(const std::vector<uint32_t>& regions) const {
  std::vector<uint32_t> out;
  for (const uint32_t k : regions) {
    const Cell2 square = world_.index().regions[k].square;
    for (int n = 0; n < 9; ++n) {
      const auto at = place_.find(Cell2{square.x + n % 3 - 1, square.y + n / 3 - 1});
      if (at != place_.end()) out.push_back(at->second);
    }
  }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

void OpenRegions::open(const std::vector<uint32_t>& needed) {
  ++now_;
  for (const uint32_t k : needed) last_needed_[k] = now_;
  if (std::ranges::all_of(needed, [&](uint32_t k) { return is_open_[k]; })) return;
  std::vector<uint32_t> wanted = around(needed);
  std::vector<uint32_t> recent;
  for (uint32_t k = 0; k < is_open_.size(); ++k) {
    if (is_open_[k]) recent.push_back(k);
  }
  std::ranges::stable_sort(recent, std::greater<>(), [&](uint32_t k) { return last_needed_[k]; });
  // To read many old regions anew would take longer than to read them when they are needed.
  const uint64_t enough = std::min(for_regions_, 2 * bytes_of(wanted));
  wanted.insert(wanted.begin(), needed.begin(), needed.end());
  wanted.insert(wanted.end(), recent.begin(), recent.end());
  is_open_.assign(is_open_.size(), false);
  uint64_t bytes = 0;
  for (const uint32_t k : wanted) {
    const uint64_t more = is_open_[k] ? 0 : world_.index().regions[k].bytes();
    if (bytes + more > enough) continue;
    is_open_[k] = true;
    bytes += more;
  }
  changed_ = true;
}

std::optional<std::vector<uint32_t>> OpenRegions::changed() {
  if (!std::exchange(changed_, false)) return std::nullopt;
  std::vector<uint32_t> open;
  for (uint32_t k = 0; k < is_open_.size(); ++k) {
    if (is_open_[k]) open.push_back(k);
  }
  return open;
}

void throw_too_little_memory(const std::string& what, uint64_t bytes, uint64_t memory_bytes) {
  throw DataError(what + " " + in_mib(bytes) + " of memory, more than --memory, which is " +
                  in_mib(memory_bytes));
}

uint64_t memory_of(const std::string& text) {
  constexpr std::pair<const char*, double> kUnits[] = {
      {"KiB", 0x1p10}, {"MiB", 0x1p20}, {"GiB", 0x1p30}, {"TiB", 0x1p40}};
  std::string number = text;
  double unit = 1;
  for (const auto& [name, bytes] : kUnits) {
    if (!text.ends_with(name)) continue;
    number.resize(text.size() - 3);
    unit = bytes;
  }
  const std::optional<double> value = io::number_of(number);
  if (!value || !(*value > 0) || !(*value * unit < 0x1p60)) {
    throw std::invalid_argument("memory is a size such as 2GiB or 500MiB, not " + in_quotes(text));
  }
  return uint64_t(*value * unit);
}

}  // namespace underbrush::regions
