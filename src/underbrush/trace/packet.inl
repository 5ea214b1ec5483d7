// Included by kernel.inl: a packet's way through the tree, and into the instances.
namespace underbrush::trace {
namespace {

// Groups with a ray that enters the box (edges relative to the centre) before what it has found.
template <bool kMixed, bool kFirst>
inline unsigned groups_entering(const Rays& r, const Found& found, float t_min, const float lo[3],
                                const float hi[3], unsigned groups) {
  unsigned out = 0;
  F near_edge[3], far_edge[3];
  for (int a = 0; a < 3; ++a) {
    const bool swap = !kMixed && r.negative[a];
    near_edge[a] = all(swap ? hi[a] : lo[a]);
    far_edge[a] = all(swap ? lo[a] : hi[a]);
  }
  for (unsigned left = groups; left; left &= left - 1) {
    const int g = __builtin_ctz(left);
    F enter = all(t_min), leave = found.high[g];
    for (int a = 0; a < 3; ++a) {
      const F x = muladd(near_edge[a], r.inverse[a][g], r.start[a][g]);
      const F y = muladd(far_edge[a], r.inverse[a][g], r.start[a][g]);
      enter = greater(enter, kMixed ? lesser(x, y) : x);
      leave = lesser(leave, kMixed ? greater(x, y) : y);
    }
    if (bits(le(enter * 0.999997f, leave))) {
      out |= 1u << g;
      if (kFirst) break;
    }
  }
  return out;
}

struct PacketEntry {
  float depth;
  uint32_t reference, groups;
};

inline void prefetch(const void* p, int lines) {
  for (int k = 0; k < lines; ++k) __builtin_prefetch(static_cast<const char*>(p) + 64 * k);
}

inline void prefetch(const Frame& f, uint32_t reference) {
  const uint32_t index = reference & kIndexMask;
  if (!(reference & kLeaf)) {
    prefetch(&f.nodes[reference], 4);
  } else if ((reference & kKindMask) == kTriangles) {
    prefetch(&f.triangles[index], 6);
  } else if ((reference & kKindMask) != kInstance) {
    prefetch(&f.ellipsoids[index], 6);
  }
}

// Visits what the packet reaches below `root`, nearer nodes first; `leaf(reference, groups)`.
template <Ask kAsk, bool kMixed, class Leaf>
inline void descend(Search& s, const Frame& f, uint32_t root, Leaf leaf) {
  const Rays& r = *f.rays;
  const unsigned everyone = (1u << kGroups) - 1;
  uint8_t inner[5][3], outer[3];  // which edges of a box make that corner
  for (int p = 0; p < 5; ++p) {
    for (int a = 0; a < 3; ++a) inner[p][a] = uint8_t(r.plane[p][a] > 0 ? a : 3 + a);
  }
  for (int a = 0; a < 3; ++a) outer[a] = uint8_t(r.plane[4][a] > 0 ? 3 + a : a);
  PacketEntry stack[256];
  int top = 0;
  stack[top++] = {-1, root, everyone};
  while (top > 0) {
    const PacketEntry at = stack[--top];
    if (at.depth > s.found.farthest) continue;
    if (at.reference & kLeaf) {
      leaf(at.reference, at.groups);
      continue;
    }
    const Node& n = f.nodes[at.reference];
    alignas(32) float edge[6][8];  // lo x y z, hi x y z, relative to the centre
    for (int a = 0; a < 3; ++a) {
      *reinterpret_cast<F8*>(edge[a]) = load8(n.lo[a]) - f.lower[a];
      *reinterpret_cast<F8*>(edge[3 + a]) = load8(n.hi[a]) - f.upper[a];
    }
    // Of each box how far the corner lies along a plane's normal that lies least so.
    const auto along = [&](int p, const uint8_t* which) {
      const float* normal = r.plane[p];
      return muladd(
          load8(edge[which[0]]), all8(normal[0]),
          muladd(load8(edge[which[1]]), all8(normal[1]), load8(edge[which[2]]) * normal[2]));
    };
    const F8 depth = along(4, inner[4]) - r.depth;
    I8 inside = (depth <= all8(s.found.farthest)) & (along(4, outer) >= all8(r.behind));
    for (int p = 0; p < 4; ++p) inside &= along(p, inner[p]) <= all8(r.side[p]);
    unsigned left = bits(inside);
    const int base = top;
    while (left) {
      const int k = __builtin_ctz(left);
      left &= left - 1;
      const float lo[3] = {edge[0][k], edge[1][k], edge[2][k]};
      const float hi[3] = {edge[3][k], edge[4][k], edge[5][k]};
      const uint32_t child = n.child[k];
      unsigned groups = everyone;
      if (child & kLeaf) {
        groups = groups_entering<kMixed, false>(r, s.found, f.t_min, lo, hi, groups);
        if (!groups) continue;
      } else if (!groups_entering<kMixed, true>(r, s.found, f.t_min, lo, hi, groups)) {
        continue;
      }
      prefetch(f, child);
      int put = top++;
      while (put > base && stack[put - 1].depth < depth[k]) {
        stack[put] = stack[put - 1];
        --put;
      }
      stack[put] = {depth[k], child, groups};
    }
  }
}

template <Ask kAsk, bool kMixed>
inline void search_model(Search& s, const Frame& f, uint32_t root) {
  descend<kAsk, kMixed>(s, f, root, [&](uint32_t leaf, unsigned groups) {
    const uint32_t index = leaf & kIndexMask, kind = leaf & kKindMask;
    bool any = false;
    if (kind == kTriangles) {
      any = visit_triangles<kAsk>(s, f, f.triangles[index], groups);
    } else if (kAsk != Ask::kSurface) {
      any = visit_ellipsoids<kAsk>(s, f, f.ellipsoids[index], groups, kind == kCareful);
    }
    if (any && kAsk != Ask::kAll) remember(s.found);
  });
}

// Ranges in units of another frame, apart by the rounding.
inline void rescale(Found& found, float factor) {
  for (int g = 0; g < kGroups; ++g) {
    found.low[g] *= factor * 0.9999998f;
    found.high[g] *= factor * 1.0000002f;
  }
  remember(found);
}

// Back to the frame of `before`, in which what was not found since stays as it was.
inline void scale_back(Found& found, const Found& before, const Frame& f) {
  rescale(found, f.scale);
  for (int g = 0; g < kGroups; ++g) {
    const M is_new = equal(found.instance[g], all(f.instance));
    found.low[g] = pick(is_new, found.low[g], before.low[g]);
    found.high[g] = pick(is_new, found.high[g], before.high[g]);
  }
  remember(found);
}

template <Ask kAsk>
void search_instance(Search& s, const Frame& world, const Entry& entry) {
  const Placement p = place(*s.view, entry.instance, world.rays->centre);
  const Bvh& bvh = *p.bvh;
  Frame f;
  f.nodes = bvh.nodes.data();
  f.ellipsoids = bvh.ellipsoids.data();
  f.triangles = bvh.triangles.data();
  f.instance = entry.instance;
  f.salt_low = uint32_t(p.salt);
  f.salt_high = uint32_t(p.salt >> 32);
  f.scale = float(p.scale);
  f.t_min = world.t_min / f.scale * 0.9999999f;
  f.t_max = world.t_max / f.scale * 1.0000001f;

  Rays local;
  f.rays = world.rays;
  if (!p.translation) {
    rotate(*world.rays, p, local);
    f.rays = &local;
  }
  set_centre(f, p.centre, f.rays->spread);
  Found before;
  if (p.scale != 1) {
    before = s.found;
    rescale(s.found, float(1 / p.scale));
  }
  if (f.rays->mixed) {
    search_model<kAsk, true>(s, f, entry.node);
  } else {
    search_model<kAsk, false>(s, f, entry.node);
  }
  if (p.scale != 1) scale_back(s.found, before, f);
}

template <Ask kAsk>
bool trace_packet(const View& view, Batch& batch) {
  const float t_min = float(batch.limits.min_m) * 0.999999f;
  const float t_max = float(batch.limits.max_m) * 1.000001f;
  Search s;
  s.view = &view;
  s.batch = &batch;
  const Columns& from = *batch.columns;
  Rays rays;
  for (int a = 0; a < 3; ++a) {
    rays.centre[a] = from.centre[a];
    float* d = reinterpret_cast<float*>(rays.d[a]);
    float* o = reinterpret_cast<float*>(rays.o[a]);
    for (int k = 0; k < kPacket; ++k) {
      d[k] = from.direction[a][batch.number[k]];
      o[k] = from.offset[a][batch.number[k]];
    }
  }
  rays.spread = from.spread;
  if (!enclose(rays)) return false;
  finish(rays);
  for (int g = 0; g < kGroups; ++g) {
    s.found.element[g] = s.found.instance[g] = all(Met::kNone);
    s.found.low[g] = all(float(batch.limits.max_m) * 0.999999f);
    s.found.high[g] = all(t_max);
  }
  for (int k = 0; k < kPacket; ++k) {
    const size_t i = batch.ray(k);
    if (kAsk == Ask::kAll) {
      reinterpret_cast<float*>(s.found.high)[k] = float(batch.entry_limits_m[i]) * 1.000001f;
    } else if (kAsk == Ask::kAccepted) {
      reinterpret_cast<uint32_t*>(s.keys.low)[k] = uint32_t(batch.keys[i]);
      reinterpret_cast<uint32_t*>(s.keys.high)[k] = uint32_t(batch.keys[i] >> 32);
    }
  }
  remember(s.found);
  Frame world;
  world.rays = &rays;
  world.nodes = view.nodes;
  world.scale = 1;
  world.t_min = t_min;
  world.t_max = t_max;
  set_centre(world, rays.centre, rays.spread);
  const auto leaf = [&](uint32_t reference, unsigned) {
    search_instance<kAsk>(s, world, view.entries[reference & kIndexMask]);
  };
  if (rays.mixed) {
    descend<kAsk, true>(s, world, view.root, leaf);
  } else {
    descend<kAsk, false>(s, world, view.root, leaf);
  }
  if (kAsk == Ask::kAll) return true;
  for (int k = 0; k < batch.count; ++k) {
    const uint32_t element = reinterpret_cast<const uint32_t*>(s.found.element)[k];
    if (element == Met::kNone || s.found.exact >> k & 1) continue;
    const uint32_t instance = reinterpret_cast<const uint32_t*>(s.found.instance)[k];
    batch.known[batch.known_count++] = {uint32_t(batch.ray(k)), instance, element};
  }
  return true;
}

}  // namespace
}  // namespace underbrush::trace
