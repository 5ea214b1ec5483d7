#include "underbrush/perception/existence.hpp"

#include <algorithm>
#include <bit>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {

void ExistenceOptions::check() const {
  const auto is_step = [](const ExistenceStep& s) { return s.gain > 0 && s.loss > 0; };
  bool ok = is_step(step);
  for (const auto& s : by_class) ok = ok && (!s || is_step(*s));
  require(ok, "existence: gain and loss must be positive");
  require(threshold > 0 && threshold <= 1, "existence: the threshold must be in (0, 1]");
  require(full_extent_m >= 0, "existence: the full extent must not be negative");
  require(needed >= 1 && window >= needed && window <= 32 && lost >= 1,
          "existence: 1 <= needed <= window <= 32 and lost >= 1 must hold");
}

bool Existence::follows(const ExistenceOptions& o) const {
  if (o.rule == ExistenceRule::kProbability) return probability_ >= o.threshold;
  if (listed_) return missed_ < o.lost;
  const int length = o.rule == ExistenceRule::kInARow ? o.needed : o.window;
  const uint32_t mask = length == 32 ? ~0u : (1u << length) - 1;
  return std::popcount(seen_ & mask) >= o.needed;
}

void Existence::update(const ExistenceOptions& o, ObjectClass label, uint32_t points,
                       double extent_m) {
  const ExistenceStep& step = o.by_class[size_t(label)] ? *o.by_class[size_t(label)] : o.step;
  const bool seen = points > (listed_ ? o.keep_points : step.start_points);
  const double share = o.full_extent_m > 0 ? std::clamp(extent_m / o.full_extent_m, 0.0, 1.0) : 1.0;
  probability_ = std::clamp(probability_ + (seen ? share * step.gain : -step.loss), 0.0, 1.0);
  seen_ = seen_ << 1 | uint32_t(seen);
  missed_ = seen ? 0 : missed_ + 1;
  listed_ = follows(o);
  was_listed_ = was_listed_ || listed_;
}

bool Existence::is_gone(const ExistenceOptions& o) const {
  if (listed_) return false;
  if (o.rule == ExistenceRule::kProbability) return was_listed_ || probability_ <= 0;
  return missed_ >= o.lost;
}

}  // namespace underbrush::perception
