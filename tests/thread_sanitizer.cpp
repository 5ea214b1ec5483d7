// What a test has of its own under ThreadSanitizer, where core's loops are those of the FMU.
#include <algorithm>

#include "underbrush/core/parallel.hpp"

namespace underbrush {

// The FMU sorts nothing by this function.
void sort_keys(std::vector<std::array<uint64_t, 2>>& keys) { std::sort(keys.begin(), keys.end()); }

namespace {
// Four threads, however many cores there are.
[[maybe_unused]] const bool kSet = (set_threads(4), true);
}  // namespace
}  // namespace underbrush
