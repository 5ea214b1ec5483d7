// What a packet searches for and what it has found. Float bounds decide most cases, and the rest is
// decided in double precision. kernel_*.cpp use this file.
#pragma once
#include <cstdint>

#include "underbrush/trace/bvh.hpp"
#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/packet_rays.inl"
#include "underbrush/trace/simd.inl"

namespace underbrush::trace {
namespace {

// What the rays of a packet have found so far. The range of the element held for a ray certainly
// lies in [low, high], an interval that covers the rounding.
struct Found {
  F low[kGroups], high[kGroups];
  U element[kGroups];  // its number, or the place of a triangle
  U instance[kGroups];
  unsigned exact[kGroups];  // lanes whose element is in Batch::best
  F8 reach[kSets];          // the greatest `high` of each group
  float farthest;           // the greatest `high` of all
};

struct Keys {
  U low[kGroups], high[kGroups];
};

// The cells of a grain about the packet's centre: centre · cells_per_m + kCellOffset = cell + part.
struct Lattice {
  float cells_per_m;  // 0 without a grain
  float part[3];
  uint32_t cell[3];
};

inline Lattice lattice_of(double cells_per_m, const double centre[3]) {
  Lattice l;
  l.cells_per_m = float(cells_per_m);
  for (int a = 0; a < 3; ++a) {
    const double at = centre[a] * cells_per_m + kCellOffset[a];
    int64_t cell = int64_t(at);
    cell -= double(cell) > at;
    l.part[a] = float(at - double(cell));
    l.cell[a] = uint32_t(cell);
  }
  return l;
}

// A frame to search in: the rays, the packet's centre in floats, and the elements.
struct Frame {
  const Rays* rays;
  const Node* nodes;
  const EllipsoidBlock* ellipsoids;
  const TriangleBlock* triangles;
  float high[3], low[3];
  float lower[3], upper[3];  // the centre, moved outwards so that boxes come out too large
  uint32_t instance, salt_low, salt_high;
  uint32_t high_mask;  // of the keys' upper half, which is the time where matter sways
  float scale, half_tau2;
  float leaf_level, leaf_slope;                       // of `LeafAngleDistribution`
  Lattice grain;                                      // of triangles
  Lattice grains[elements::Grain::kMostClasses + 1];  // of ellipsoids
  bool grained;                                       // whether trials depend on cells
  bool sways;                                         // whether the matter of ellipsoids does
  float t_min, t_max;                                 // limits of the ranges that count
};

struct PacketQuery {
  const View* view;
  Batch* batch;
  const uint32_t* number;  // numbers of the rays, counted from the batch's first
  int count;               // further places repeat the last ray
  Keys keys;
  Found found;
};

// The eight boxes of a node, or the eight elements of a block, that a packet examines.
struct alignas(32) ChildTests {
  SlopeBounds seen;
  union {
    float edge[6][8];  // of boxes: lo x y z, hi x y z, relative to the centre
    struct {
      float mean[3][8], slack[8], size[8];
      float outer2[8], inner2[8];  // squares of 1 ± `slack`
    } ellipsoid;
    struct {
      float corner[3][8], side[3][3][8];  // corner 0, and the sides from it to the others
      struct {
        float normal[3][8], height[8];  // of the sides, and its product with the corner
        float slack[8], doubtful[8], range_slack[8];  // `doubtful` is −3 `slack`
      } of[2];
    } triangle;
  };
  Meetings meetings;
};

inline void store(float* to, F8 x) { *reinterpret_cast<F8*>(to) = x; }

inline size_t ray_at(const PacketQuery& s, int place) { return s.batch->first + s.number[place]; }

inline void set_centre(Frame& f, const double centre[3], float spread) {
  for (int a = 0; a < 3; ++a) {
    f.high[a] = float(centre[a]);
    f.low[a] = float(centre[a] - double(f.high[a]));
    const float pad = __builtin_fabsf(f.high[a]) * 2.5e-7f + spread * 3e-7f;
    f.lower[a] = f.high[a] + pad;
    f.upper[a] = f.high[a] - pad;
  }
}

// Updates the reaches after the groups of `sets` have found something.
inline void update_reach(Found& found, unsigned sets = ~0u) {
  F8 farthest{};
  for (int set = 0; set < kSets; ++set) {
    if (sets >> set & 1) found.reach[set] = greatest_of_groups(found.high + 8 * set);
    farthest = greater(farthest, found.reach[set]);
  }
  found.farthest = greatest(farthest);
}

// Notes that lanes `maybe` of group g may meet the element within [low, high]. Lanes `sure`
// certainly meet it, nearer than what they have found. `reach` is τσ, and `reference` is the
// element's number, or the place of a triangle.
template <Query kQuery>
inline void record(PacketQuery& s, const Frame& f, int g, uint32_t element, uint32_t reference,
                   M maybe, M sure, F low, F high, F reach) {
  Found& found = s.found;
  unsigned lanes = bits(maybe);
  if (kQuery == Query::kAll) {
    while (lanes) {
      const int k = __builtin_ctz(lanes);
      lanes &= lanes - 1;
      const int place = g * kLanes + k;
      if (place >= s.count) break;
      add_candidate(*s.batch, {uint32_t(ray_at(s, place)), f.instance, element},
                    {low[k] * f.scale, reach[k] * f.scale});
    }
    return;
  }
  const unsigned certain = bits(sure);
  if (certain) {
    found.low[g] = pick(sure, low, found.low[g]);
    found.high[g] = pick(sure, high, found.high[g]);
    found.element[g] = pick(sure, all(reference), found.element[g]);
    found.instance[g] = pick(sure, all(f.instance), found.instance[g]);
    found.exact[g] &= ~certain;
  }
  lanes &= ~certain;
  while (lanes) {
    const int k = __builtin_ctz(lanes);
    lanes &= lanes - 1;
    const int place = g * kLanes + k;
    if (place >= s.count) break;
    const unsigned bit = 1u << k;
    const uint32_t have =
        found.exact[g] & bit ? Intersection::kNone : uint32_t(found.element[g][k]);
    const size_t i = ray_at(s, place);
    if (found.element[g][k] == Intersection::kNone) s.batch->best[i] = Intersection{};
    if (!resolve_nearest(*s.view, kQuery, *s.batch, i, f.instance, element,
                         uint32_t(found.instance[g][k]), have)) {
      continue;
    }
    const float t = float(s.batch->best[i].t_m / f.scale);
    found.low[g][k] = t * 0.9999999f;
    found.high[g][k] = t * 1.0000001f;
    found.element[g][k] = element;
    found.instance[g][k] = f.instance;
    found.exact[g] |= bit;
  }
}

// The cells of the grain in which the rays of a group meet an element, mixed to 32 bits, and the
// lanes for which these are certain.
struct Cells {
  U mixed;
  M sure;
};

// Computes the cells at the ranges t, of which `error` bounds the rounding.
inline Cells cells_of(const Frame& f, const Lattice& l, int g, F t, F error) {
  Cells cells{all(0u), mask_of(~0u)};
  if (l.cells_per_m == 0) return cells;
  const Rays& r = *f.rays;
  const F slack =
      muladd(error + (absolute(t) + all(r.spread)) * 1e-6f, all(l.cells_per_m * 1.01f), all(1e-5f));
  for (int a = 0; a < 3; ++a) {
    const F at = muladd(muladd(t, r.d[a][g], r.o[a][g]), all(l.cells_per_m), all(l.part[a]));
    const F whole = floor_of(at), fraction = at - whole;
    cells.sure &= le(slack, fraction) & le(fraction, 1.0f - slack);
    cells.mixed += ((U) __builtin_convertvector(whole, I) + all(l.cell[a])) * cell_factor(a);
  }
  return cells;
}

// Moves the matter of the cells with the time (`swaying_cell`).
inline void sway(const PacketQuery& s, int g, uint32_t element, Cells& cells) {
  const U phase = ((cells.mixed ^ all(element * kPhaseFactor[0])) * kPhaseFactor[1]) >> 16;
  cells.mixed += ((s.keys.high[g] + phase) >> 16) * kTimeFactor;
}

// The random bits of the trials of a group at an element.
inline U trial_bits(const PacketQuery& s, const Frame& f, int g, uint32_t element,
                    const Cells& cells) {
  return accept_hash(all(element), s.keys.low[g] ^ all(f.salt_low) ^ cells.mixed,
                     (s.keys.high[g] & all(f.high_mask)) ^ all(f.salt_high));
}

// The random trials of a group at an element: the lanes that may accept it, and those that
// certainly do.
struct Trial {
  M maybe, sure;
};
inline Trial trial_at(const PacketQuery& s, const Frame& f, const Lattice& l, bool sways, int g,
                      uint32_t element, uint32_t accept_below, F t, F error) {
  if (accept_below == kAlways) return {mask_of(~0u), mask_of(~0u)};
  if (!f.grained) {
    const M accepted = below(accept_hash(all(element), s.keys.low[g] ^ all(f.salt_low),
                                         s.keys.high[g] ^ all(f.salt_high)),
                             all(accept_below));
    return {accepted, accepted};
  }
  Cells cells = cells_of(f, l, g, t, error);
  if (sways) sway(s, g, element, cells);
  const M accepted = below(trial_bits(s, f, g, element, cells), all(accept_below));
  return {M(accepted | ~cells.sure), M(accepted & cells.sure)};
}

}  // namespace
}  // namespace underbrush::trace
