#include "underbrush/movers/find_movers.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/movers/mover_groups.hpp"
#include "underbrush/movers/scan_image.hpp"

namespace underbrush::movers {
namespace {

/// The returns of a scan, and its image.
struct Scan {
  double time_s = 0;
  std::vector<ScanReturn> returns;
  std::vector<Vec3> from;
  std::optional<ScanImage> image;  ///< Nothing without returns.
};

/// Reads a source scan by scan.
class ScanReader {
 public:
  ScanReader(BeamSource& source, const MoverOptions& options) : source_(source), options_(options) {
    source_.rewind();
  }

  /// The next scan, or null.
  std::unique_ptr<Scan> next() {
    if (!fill()) return nullptr;
    auto scan = std::make_unique<Scan>();
    const uint32_t number = chunk_.scan[at_];
    scan->time_s = chunk_.time_s[at_];
    for (; fill() && chunk_.scan[at_] == number; ++at_, ++row_) {
      if (!chunk_.is_hit(at_) || double(chunk_.range_m[at_]) > options_.max_range_m) continue;
      scan->returns.push_back({row_, chunk_.end_point(at_)});
      scan->from.push_back(chunk_.origin[at_]);
    }
    if (!scan->returns.empty()) {
      scan->image.emplace(scan->time_s, scan->returns, scan->from, options_.cell_deg * M_PI / 180);
    }
    scan->from = {};
    return scan;
  }

 private:
  bool fill() {
    while (at_ == chunk_.size()) {
      at_ = 0;
      if (!source_.next(chunk_)) return false;
    }
    return true;
  }

  BeamSource& source_;
  const MoverOptions& options_;
  BeamLog chunk_;
  size_t at_ = 0;
  uint32_t row_ = 0;
};

/// The scans in a window of time, and the one among them that is compared with the others.
class Window {
 public:
  Window(BeamSource& source, const MoverOptions& options)
      : options_(options), reader_(source, options) {}

  /// Goes on to the next scan. Returns false at the end.
  bool advance() {
    if (now_ + 1 >= scans_.size() && !read()) return false;
    if (started_) scans_[now_++]->returns = {};
    started_ = true;
    const double reach = options_.look_s.back() + kHalfScanS;
    while (scans_.back()->time_s < now().time_s + reach && read()) {
    }
    while (scans_.front()->time_s < now().time_s - reach) {
      scans_.pop_front();
      --now_;
    }
    return true;
  }
  const Scan& now() const { return *scans_[now_]; }

  /// The images of the scans to compare with on one side in time, the farthest first, each once.
  std::vector<const ScanImage*> side(int direction) const {
    std::vector<const ScanImage*> out;
    size_t last = now_;
    for (const double s : options_.look_s) {
      const size_t k = nearest(now().time_s + direction * s);
      const bool is_on = direction > 0 ? k > last : k < last;
      if (!is_on || std::abs(scans_[k]->time_s - now().time_s - direction * s) > kHalfScanS)
        continue;
      last = k;
      if (scans_[k]->image) out.push_back(&*scans_[k]->image);
    }
    std::reverse(out.begin(), out.end());
    return out;
  }

 private:
  static constexpr double kHalfScanS = 0.3;
  bool read() {
    if (is_over_) return false;
    auto scan = reader_.next();
    is_over_ = !scan;
    if (scan) scans_.push_back(std::move(scan));
    return !is_over_;
  }
  size_t nearest(double time_s) const {
    size_t best = 0;
    for (size_t k = 1; k < scans_.size(); ++k) {
      if (std::abs(scans_[k]->time_s - time_s) < std::abs(scans_[best]->time_s - time_s)) best = k;
    }
    return best;
  }

  const MoverOptions& options_;
  ScanReader reader_;
  std::deque<std::unique_ptr<Scan>> scans_;
  size_t now_ = 0;
  bool started_ = false, is_over_ = false;
};

/// The result of the comparison with the scans of one side, from the outermost on.
struct Side {
  uint32_t empty = 0;  ///< Scans in which the place is empty, before the first with matter.
  bool has_matter = false;
};

Side compare_with(const std::vector<const ScanImage*>& images, const Vec3& point, double same_m,
                  uint32_t enough) {
  Side side;
  for (const ScanImage* image : images) {
    const PlaceState state = image->state_of(point, same_m, 2 * same_m);
    side.has_matter = state == PlaceState::kMatter;
    side.empty += state == PlaceState::kEmpty;
    if (side.has_matter || side.empty == enough) break;
  }
  return side;
}

std::vector<Evidence> evidence_of(const Window& window, const MoverOptions& options) {
  const Scan& scan = window.now();
  const std::vector<const ScanImage*> sides[2] = {window.side(-1), window.side(1)};
  std::vector<Evidence> out(scan.returns.size());
  parallel_for(out.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3& point = scan.returns[i].point;
      const ScanImage::Place at = scan.image->place(point);
      const double same = options.same_m + options.same_per_m * double(at.range_m);
      bool has_matter = false;
      uint32_t empty = 0;
      for (const auto& images : sides) {
        const Side side = compare_with(images, point, same, options.least_empty);
        empty = std::max(empty, side.empty);
        has_matter |= side.has_matter;
      }
      if (empty >= options.least_empty) {
        out[i] = {Verdict::kCandidate, float(scan.image->solid_share(at, 2 * same))};
      } else if (has_matter && empty == 0) {
        out[i].verdict = Verdict::kStays;
      }
    }
  });
  return out;
}

}  // namespace

void MoverOptions::check() const {
  require(!look_s.empty() && look_s.front() > 0 && std::is_sorted(look_s.begin(), look_s.end()),
          "movers: the times of compared scans must be positive and ascend");
  require(cell_deg >= 0.05 && cell_deg <= 10, "movers: cells of 0.05 to 10 degrees are needed");
  require(least_empty > 0 && max_range_m > 0 && same_m > 0 && same_per_m >= 0,
          "movers: the number of empty scans, the range or the tolerance is not positive");
  require(least_solid >= 0 && least_solid <= 1 && least_share >= 0 && least_share <= 1,
          "movers: a share is not from 0 to 1");
}

std::vector<uint8_t> find_movers(BeamSource& source, const MoverOptions& options,
                                 const std::function<void(size_t, size_t)>& progress) {
  options.check();
  std::vector<uint8_t> out(source.size());
  Window window(source, options);
  while (window.advance()) {
    const Scan& scan = window.now();
    if (!scan.image) continue;
    const std::vector<Evidence> evidence = evidence_of(window, options);
    const std::vector<uint8_t> mover = group_movers(*scan.image, scan.returns, evidence, options);
    for (size_t i = 0; i < mover.size(); ++i) out[scan.returns[i].row] = mover[i];
    if (progress) progress(scan.returns.back().row + 1, out.size());
  }
  return out;
}

void require_two_scans(BeamSource& source, const std::string& name) {
  std::optional<uint32_t> first;
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    if (!first) first = chunk.scan[0];
    if (std::ranges::any_of(chunk.scan, [&](uint32_t s) { return s != *first; })) return;
  }
  throw FormatError(name, "", "the log has fewer than two scans, so nothing can be seen to move");
}

void mark_movers(const std::vector<uint8_t>& is_mover, size_t first, BeamLog& chunk) {
  for (size_t i = 0; i < chunk.size(); ++i) {
    chunk.flags[i] = uint8_t((chunk.flags[i] & ~kMover) | (is_mover[first + i] ? kMover : 0));
  }
}

}  // namespace underbrush::movers
