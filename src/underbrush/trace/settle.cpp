#include "underbrush/trace/kernel.hpp"

namespace underbrush::trace {

bool settle_nearest(const View& view, const Query& query, uint32_t element, Met& best) {
  const Met met = meet(*view.model, element, query.origin, query.direction, query.limits);
  if (met.none() || (!best.none() && !met.before(best))) return false;
  best = met;
  return true;
}

void settle_all(const View& view, const Query& query, uint32_t element, std::vector<Met>& met) {
  const Met m = meet(*view.model, element, query.origin, query.direction, query.limits);
  if (!m.none()) met.push_back(m);
}

}  // namespace underbrush::trace
