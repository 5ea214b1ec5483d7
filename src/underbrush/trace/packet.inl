// The traversal of a packet through the tree and into the instances. kernel_*.cpp use this file.
#pragma once
#include "underbrush/trace/packet_ellipsoids.inl"
#include "underbrush/trace/packet_finds.inl"
#include "underbrush/trace/packet_rays.inl"
#include "underbrush/trace/packet_triangles.inl"

namespace underbrush::trace {
namespace {

// Whether a ray of group g enters box k before what it has found. `edge` has the box edges lo x y
// z, hi x y z relative to the centre.
template <bool kMixed>
inline bool enters(const Rays& r, const Found& found, float t_min, const float edge[6][8], int k,
                   int g) {
  F enter = all(t_min), leave = found.high[g];
  for (int a = 0; a < 3; ++a) {
    const F x = muladd(all(edge[r.first_edge[a]][k]), r.inverse[a][g], r.start[a][g]);
    const F y = muladd(all(edge[r.last_edge[a]][k]), r.inverse[a][g], r.start[a][g]);
    enter = greater(enter, kMixed ? lesser(x, y) : x);
    leave = lesser(leave, kMixed ? greater(x, y) : y);
  }
  return bits(le(enter * 0.999997f, leave)) != 0;
}

struct PacketStackEntry {
  float depth;
  uint32_t reference, groups;
};

__attribute__((always_inline)) inline void prefetch(const void* p, int lines) {
  for (int k = 0; k < lines; ++k) __builtin_prefetch(static_cast<const char*>(p) + 64 * k);
}

__attribute__((always_inline)) inline void prefetch(const Frame& f, uint32_t reference) {
  const uint32_t index = reference & kIndexMask;
  if (!(reference & kLeaf)) {
    prefetch(&f.nodes[reference], 4);
  } else if (leaf_kind(reference) == LeafKind::kTriangles) {
    prefetch(&f.triangles[index], 8);
  } else if (f.ellipsoids) {
    prefetch(&f.ellipsoids[index], 6);
  }
}

inline void test_children(const PacketQuery& s, const Frame& f, const Node& node, unsigned groups,
                          ChildTests& tests) {
  const Rays& r = *f.rays;
  F8 twice_centre[3], side[3], size{};
  for (int a = 0; a < 3; ++a) {
    const F8 lo = load8(node.lo[a]) - all8(f.lower[a]), hi = load8(node.hi[a]) - all8(f.upper[a]);
    store(tests.edge[a], lo);
    store(tests.edge[3 + a], hi);
    twice_centre[a] = lo + hi;
    side[a] = hi - lo;
    size += absolute(twice_centre[a]) + side[a];
  }
  F8 from[3], to[3];
  for (int p = 0; p < 3; ++p) {
    F8 half = size * 5e-7f, middle{};
    for (int a = 0; a < 3; ++a) {
      half = muladd(side[a], all8(r.half_extent[p][a]), half);
      middle = muladd(twice_centre[a], all8(r.half_axis[p][a]), middle);
    }
    from[p] = middle - half;
    to[p] = middle + half;
  }
  bound_slopes(r, from, to, tests.seen);
  find_meetings<true>(r, s.found.reach, tests.seen, groups, tests.meetings);
}

// Pushes the children of a node that the packet may reach, the nearest last.
template <bool kMixed>
inline void open(const PacketQuery& s, const Frame& f, const Node& node, const ChildTests& tests,
                 PacketStackEntry* stack, int& top) {
  // Most groups that look at a whole box enter it, so that trying them would cost more than it
  // saves.
  const Meetings& meetings = tests.meetings;
  unsigned entered[8], left = 0;
  for (unsigned more = meetings.children; more; more &= more - 1) {
    const int k = __builtin_ctz(more);
    unsigned groups = meetings.whole[k];
    for (unsigned doubtful = meetings.any[k] & ~groups; doubtful; doubtful &= doubtful - 1) {
      const int g = __builtin_ctz(doubtful);
      groups |= unsigned(enters<kMixed>(*f.rays, s.found, f.t_min, tests.edge, k, g)) << g;
    }
    entered[k] = groups;
    left |= unsigned(groups != 0) << k;
  }
  const float* depths = tests.seen.depth;
  const F8 depth = load8(depths);
  for (unsigned more = left; more; more &= more - 1) {
    const int k = __builtin_ctz(more);
    const F8 own = all8(depths[k]);
    const unsigned further = bits(le(own, depth)) & (~bits(le(depth, own)) | ~0u << k << 1);
    prefetch(f, node.child[k]);
    stack[top + __builtin_popcount(further & left)] = {depths[k], node.child[k], entered[k]};
  }
  top += __builtin_popcount(left);
}

// Converts found ranges to the units of another frame. The bounds move apart by the rounding.
inline void rescale(Found& found, float factor) {
  for (int g = 0; g < kGroups; ++g) {
    found.low[g] *= all(factor * 0.9999998f);
    found.high[g] *= all(factor * 1.0000002f);
  }
  update_reach(found);
}

// Converts found ranges back to the frame of `before`. Elements that were found before keep their
// bounds.
inline void scale_back(Found& found, const Found& before, const Frame& f) {
  rescale(found, f.scale);
  for (int g = 0; g < kGroups; ++g) {
    const M is_new = equal(found.instance[g], all(f.instance));
    found.low[g] = pick(is_new, found.low[g], before.low[g]);
    found.high[g] = pick(is_new, found.high[g], before.high[g]);
  }
  update_reach(found);
}

// The state of a packet on its way through the tree. Several packets take turns, one step each, so
// that the memory which one needs arrives while the others work.
struct PacketTraversal {
  PacketQuery search;
  // in the world's frame, and in the instance's frame if that is rotated or scaled
  Rays rays, turned;
  Frame world, model;
  Found before;  // for a scaled instance: what was found before it, in the world's units
  uint32_t at;   // the reference that `tests` is of
  ChildTests tests;
  PacketStackEntry stack[512];
  int top, base;  // entries from `base` on belong to the model
  bool inside;    // whether the walk is in an instance
  bool scaled;
};

inline void enter_instance(PacketTraversal& w, const Subtree& entry) {
  const Placement p = place(*w.search.view, entry.instance, w.rays.centre);
  const Bvh& bvh = *p.bvh;
  Frame& f = w.model;
  f.nodes = bvh.nodes.data();
  f.ellipsoids = bvh.ellipsoids.data();
  f.triangles = bvh.triangles.data();
  f.instance = entry.instance;
  f.salt_low = uint32_t(p.salt);
  f.salt_high = uint32_t(p.salt >> 32);
  f.grain = lattice_of(p.cells_per_m->triangles, p.centre);
  for (int k = 0; k < p.cells_per_m->kinds; ++k) {
    f.grains[k] = lattice_of(p.cells_per_m->ellipsoids[k], p.centre);
  }
  f.grained = p.cells_per_m->triangles != 0;
  f.sways = p.sways;
  f.high_mask = p.sways ? 0 : ~0u;
  f.scale = float(p.scale);
  f.half_tau2 = float(0.5 * p.tau2);
  f.leaf_level = float(p.leaf_level);
  f.leaf_slope = float(p.leaf_slope);
  f.t_min = w.world.t_min / f.scale * 0.9999999f;
  f.t_max = w.world.t_max / f.scale * 1.0000001f;
  f.rays = &w.rays;
  if (!p.translation) {
    rotate(w.rays, p, w.turned);
    f.rays = &w.turned;
  }
  set_centre(f, p.centre, f.rays->spread);
  w.scaled = p.scale != 1;
  if (w.scaled) {
    w.before = w.search.found;
    rescale(w.search.found, float(1 / p.scale));
  }
  w.inside = true;
  w.base = w.top;
  w.stack[w.top++] = {-1, entry.node, kEveryGroup};
}

inline void leave_instance(PacketTraversal& w) {
  if (w.scaled) scale_back(w.search.found, w.before, w.model);
  w.inside = false;
}

// Goes to the next node or block and examines it. Gives false if there is none left.
inline bool advance(PacketTraversal& w) {
  const PacketQuery& s = w.search;
  while (true) {
    if (w.inside && w.top == w.base) leave_instance(w);
    if (w.top == 0) return false;
    const PacketStackEntry at = w.stack[--w.top];
    if (at.depth > s.found.farthest) continue;
    const Frame& f = w.inside ? w.model : w.world;
    const uint32_t index = at.reference & kIndexMask;
    const LeafKind kind = leaf_kind(at.reference);
    w.at = at.reference;
    if (!(at.reference & kLeaf)) {
      test_children(s, f, f.nodes[index], at.groups, w.tests);
    } else if (!w.inside) {
      enter_instance(w, s.view->entries[index]);
      continue;
    } else if (kind == LeafKind::kTriangles) {
      test_children(s, f, f.triangles[index], at.groups, w.tests);
    } else {
      test_children(s, f, f.ellipsoids[index], at.groups, w.tests);
    }
    return true;
  }
}

// Processes the node or block that `advance` has examined.
template <Query kQuery>
inline void visit(PacketTraversal& w) {
  PacketQuery& s = w.search;
  const Frame& f = w.inside ? w.model : w.world;
  const uint32_t index = w.at & kIndexMask;
  const LeafKind kind = leaf_kind(w.at);
  if (!(w.at & kLeaf)) {
    if (f.rays->mixed) {
      open<true>(s, f, f.nodes[index], w.tests, w.stack, w.top);
    } else {
      open<false>(s, f, f.nodes[index], w.tests, w.stack, w.top);
    }
    return;
  }
  unsigned sets = 0;
  if (kind == LeafKind::kTriangles) {
    sets = visit<kQuery>(s, f, f.triangles[index], w.tests);
  } else if (kQuery != Query::kSurface) {
    sets = visit<kQuery>(s, f, f.ellipsoids[index], kind, w.tests);
  }
  if (sets && kQuery != Query::kAll) update_reach(s.found, sets);
}

}  // namespace
}  // namespace underbrush::trace
