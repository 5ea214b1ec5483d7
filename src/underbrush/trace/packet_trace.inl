// Traces ordered rays in packets that take turns. kernel_*.cpp use this file.
#pragma once
#include "underbrush/trace/packet.inl"
#include "underbrush/trace/single.inl"

namespace underbrush::trace {
namespace {

// Starts a packet. Gives false if its rays spread too far to be traced together.
template <Query kQuery>
bool begin(PacketTraversal& w, const View& view, Batch& batch, const uint32_t* number, int count) {
  PacketQuery& s = w.search;
  s.view = &view;
  s.batch = &batch;
  s.number = number;
  s.count = count;
  const FloatRays& from = *batch.float_rays;
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
    s.found.element[g] = s.found.instance[g] = all(Intersection::kNone);
    s.found.low[g] = all(float(batch.limits.max_m) * 0.999999f);
    s.found.high[g] = all(t_max);
    s.found.exact[g] = 0;
  }
  for (int k = 0; kQuery == Query::kAll && k < kPacket; ++k) {
    reinterpret_cast<float*>(s.found.high)[k] =
        float(batch.entry_limits_m[ray_at(s, k)]) * 1.000001f;
  }
  update_reach(s.found);
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

template <Query kQuery>
void end(const PacketTraversal& w) {
  if (kQuery == Query::kAll) return;
  const PacketQuery& s = w.search;
  Batch& batch = *s.batch;
  Candidate* ellipsoid = batch.ellipsoids->of + batch.ellipsoids->count;
  Candidate* triangle = batch.triangles->of + batch.triangles->count;
  for (int g = 0; g * kLanes < s.count; ++g) {
    const unsigned places =
        s.count - g * kLanes < kLanes ? (1u << (s.count - g * kLanes)) - 1 : ~0u;
    const unsigned none = bits(equal(s.found.element[g], all(Intersection::kNone)));
    const unsigned in_block = bits(below(all(kInBlock - 1), s.found.element[g]));
    const unsigned open = ~s.found.exact[g] & places & kEveryLane;
    const uint32_t* number = s.number + g * kLanes;
    const auto found_at = [&](int k) {
      return Candidate{uint32_t(batch.first + number[k]), uint32_t(s.found.instance[g][k]),
                       uint32_t(s.found.element[g][k])};
    };
    for (unsigned left = open & none; left; left &= left - 1) {
      batch.best[batch.first + number[__builtin_ctz(left)]] = Intersection{};
    }
    for (unsigned left = open & ~in_block; left; left &= left - 1) {
      *ellipsoid++ = found_at(__builtin_ctz(left));
    }
    for (unsigned left = open & in_block & ~none; left; left &= left - 1) {
      *triangle++ = found_at(__builtin_ctz(left));
    }
  }
  batch.ellipsoids->count = size_t(ellipsoid - batch.ellipsoids->of);
  batch.triangles->count = size_t(triangle - batch.triangles->of);
}

constexpr size_t kFew = 4;  // packets of fewer rays do not pay
constexpr int kTraversals = 6;

template <Query kQuery>
void trace_all(const View& view, Batch& batch, const uint32_t* order, size_t count) {
  PacketTraversal traversals[kTraversals];
  size_t at = 0;
  const auto next = [&](PacketTraversal& w) {
    while (at < count) {
      const uint32_t* number = order + at;
      const size_t n = count - at < size_t(kPacket) ? count - at : size_t(kPacket);
      at += n;
      if (n > kFew && begin<kQuery>(w, view, batch, number, int(n))) return true;
      for (size_t k = 0; k < n; ++k) trace_one(view, kQuery, batch, batch.first + number[k]);
    }
    return false;
  };
  PacketTraversal* busy[kTraversals];
  int busy_count = 0;
  for (PacketTraversal& w : traversals) {
    if (next(w)) busy[busy_count++] = &w;
  }
  // Every packet advances before any of them visits, so that the memory has been fetched by then.
  while (busy_count > 0) {
    for (int k = 0; k < busy_count;) {
      PacketTraversal& w = *busy[k];
      if (advance(w)) {
        ++k;
        continue;
      }
      end<kQuery>(w);
      if (!next(w)) busy[k] = busy[--busy_count];
    }
    for (int k = 0; k < busy_count; ++k) visit<kQuery>(*busy[k]);
  }
}

}  // namespace
}  // namespace underbrush::trace
