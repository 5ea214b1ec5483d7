/// \file
/// Groups of candidates within one scan.
#pragma once
#include <vector>

#include "underbrush/movers/mover_options.hpp"
#include "underbrush/movers/scan_image.hpp"

namespace underbrush::movers {

/// The result of the comparison of a return with other scans.
enum class Verdict : uint8_t {
  kNone,   ///< No evidence, or too little.
  kStays,  ///< Matter was there in the outermost scan of a side, and no side began empty.
  kCandidate
};

/// The evidence on a return.
struct Evidence {
  Verdict verdict = Verdict::kNone;
  float solid = 0;  ///< `ScanImage::solid_share` of a candidate.
};

/// Returns for each return of a scan whether it belongs to a group of candidates as described at
/// `find_movers`.
std::vector<uint8_t> group_movers(const ScanImage& image, const std::vector<ScanReturn>& returns,
                                  const std::vector<Evidence>& evidence,
                                  const MoverOptions& options);

}  // namespace underbrush::movers
