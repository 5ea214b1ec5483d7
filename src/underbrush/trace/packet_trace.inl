// Traces ordered rays in packets that take turns. kernel.inl includes this file.
namespace underbrush::trace {
namespace {

// Starts a packet. Gives false if its rays spread too far to be traced together.
template <Ask kAsk>
bool begin(Walk& w, const View& view, Batch& batch, const uint32_t* number, int count) {
  Search& s = w.search;
  s.view = &view;
  s.batch = &batch;
  s.number = number;
  s.count = count;
  const Unfolded& from = *batch.unfolded;
  for (int a = 0; a < 3; ++a) w.rays.centre[a] = from.centre[a];
  for (int k = 0; k < kPacket; k += 8) {
    F8 x[8];
    for (int j = 0; j < 8; ++j) x[j] = load8(from.row[number[k + j]]);
    transpose(x);
    for (int a = 0; a < 3; ++a) {
      store(reinterpret_cast<float*>(w.rays.o[a]) + k, x[a]);
      store(reinterpret_cast<float*>(w.rays.d[a]) + k, x[3 + a]);
    }
    store(reinterpret_cast<float*>(s.keys.low) + k, x[6]);
    store(reinterpret_cast<float*>(s.keys.high) + k, x[7]);
  }
  w.rays.spread = from.spread;
  if (!enclose(w.rays)) return false;
  finish(w.rays);
  const float t_max = float(batch.limits.max_m) * 1.000001f;
  for (int g = 0; g < kGroups; ++g) {
    s.found.element[g] = s.found.instance[g] = all(Met::kNone);
    s.found.low[g] = all(float(batch.limits.max_m) * 0.999999f);
    s.found.high[g] = all(t_max);
    s.found.exact[g] = 0;
  }
  for (int k = 0; kAsk == Ask::kAll && k < kPacket; ++k) {
    reinterpret_cast<float*>(s.found.high)[k] =
        float(batch.entry_limits_m[ray_at(s, k)]) * 1.000001f;
  }
  remember(s.found);
  w.world.rays = &w.rays;
  w.world.nodes = view.nodes;
  w.world.ellipsoids = nullptr;
  w.world.scale = 1;
  w.world.t_min = float(batch.limits.min_m) * 0.999999f;
  w.world.t_max = t_max;
  set_centre(w.world, w.rays.centre, w.rays.spread);
  w.inside = false;
  w.stack[0] = {-1, view.root, kEveryGroup};
  w.top = 1;
  return true;
}

template <Ask kAsk>
void end(const Walk& w) {
  if (kAsk == Ask::kAll) return;
  const Search& s = w.search;
  Batch& batch = *s.batch;
  for (int k = 0; k < s.count; ++k) {
    const uint32_t element = reinterpret_cast<const uint32_t*>(s.found.element)[k];
    if (s.found.exact[k / kLanes] >> k % kLanes & 1) continue;
    if (element == Met::kNone) {
      batch.best[ray_at(s, k)] = Met{};
      continue;
    }
    const uint32_t instance = reinterpret_cast<const uint32_t*>(s.found.instance)[k];
    batch.known[batch.known_count++] = {uint32_t(ray_at(s, k)), instance, element};
  }
}

constexpr size_t kFew = 4;  // packets of fewer rays do not pay
constexpr int kWalks = 6;

template <Ask kAsk>
void trace_all(const View& view, Batch& batch, const uint32_t* order, size_t count) {
  Walk walks[kWalks];
  size_t at = 0;
  const auto next = [&](Walk& w) {
    while (at < count) {
      const uint32_t* number = order + at;
      const size_t n = count - at < size_t(kPacket) ? count - at : size_t(kPacket);
      at += n;
      if (n > kFew && begin<kAsk>(w, view, batch, number, int(n))) return true;
      for (size_t k = 0; k < n; ++k) trace_one(view, kAsk, batch, batch.first + number[k]);
    }
    return false;
  };
  Walk* busy[kWalks];
  int busy_count = 0;
  for (Walk& w : walks) {
    if (next(w)) busy[busy_count++] = &w;
  }
  // Every packet looks before any of them acts, so that what they look at has been fetched by then.
  while (busy_count > 0) {
    for (int k = 0; k < busy_count;) {
      Walk& w = *busy[k];
      if (look(w)) {
        ++k;
        continue;
      }
      end<kAsk>(w);
      if (!next(w)) busy[k] = busy[--busy_count];
    }
    for (int k = 0; k < busy_count; ++k) visit<kAsk>(*busy[k]);
  }
}

}  // namespace
}  // namespace underbrush::trace
