#include "underbrush/optimize/slice.hpp"

#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/credit/held_out.hpp"

namespace underbrush::optimize {
namespace {

/// Numbers the scans of the slice in the order in which they begin.
std::map<uint32_t, size_t> scans_of(BeamSource& source, const SliceOptions& options) {
  std::map<uint32_t, size_t> out;
  std::map<uint32_t, bool> seen;
  double start = 0;
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    if (seen.empty()) start = chunk.time_s[0];
    for (size_t i = 0; i < chunk.size(); ++i) {
      if ((i && chunk.scan[i] == chunk.scan[i - 1]) || seen.count(chunk.scan[i])) continue;
      const double t = chunk.time_s[i] - start;
      seen[chunk.scan[i]] = t >= options.from_s && t < options.to_s;
      if (seen[chunk.scan[i]]) out.emplace(chunk.scan[i], out.size());
    }
  }
  return out;
}

}  // namespace

Slice take_slice(BeamSource& source, const SliceOptions& options) {
  require(options.one_in >= 2, "optimize: one scan in two or more must validate");
  require(options.from_s < options.to_s, "optimize: the slice is empty");
  const std::map<uint32_t, size_t> scans = scans_of(source, options);
  Slice out;
  out.scans = scans.size();
  out.by_scan = scans.size() >= options.one_in;
  out.fit.info = out.validation.info = source.info();
  const credit::HeldOut columns{options.one_in, options.seed};
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    const auto validates = [&](size_t i) {
      return out.by_scan ? scans.at(chunk.scan[i]) % options.one_in == options.one_in / 2
                         : columns(chunk, i);
    };
    for (size_t begin = 0, end; begin < chunk.size(); begin = end) {
      end = begin + 1;
      const bool inside = scans.count(chunk.scan[begin]) > 0, kept = inside && validates(begin);
      while (end < chunk.size() && chunk.scan[end] == chunk.scan[begin] &&
             (!inside || out.by_scan || validates(end) == kept)) {
        ++end;
      }
      if (inside) (kept ? out.validation : out.fit).append(chunk, begin, end);
    }
  }
  require(!out.fit.empty() && !out.validation.empty(),
          "optimize: the slice has no beams to fit and to validate");
  return out;
}

}  // namespace underbrush::optimize
