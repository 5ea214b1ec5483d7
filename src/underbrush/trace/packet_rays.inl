// A packet of rays in columns, the slopes that bound it, and its transformation between frames.
// kernel_*.cpp use this file.
#pragma once
#include <cmath>
#include <cstdint>

#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/many.inl"
#include "underbrush/trace/simd.inl"
#include "underbrush/trace/simd_double.inl"

namespace underbrush::trace {
namespace {

// The rays in one frame, relative to a common centre.
struct alignas(64) Rays {
  F d[3][kGroups], o[3][kGroups], inverse[3][kGroups];
  F start[3][kGroups];   // −o·inverse
  F moment[3][kGroups];  // o × d
  double centre[3];
  // The three axes point across, up and along the rays. The slopes of a ray are the components of
  // its direction across and up, divided by the component along.
  float axis[3][3];
  float half_axis[3][3], half_extent[3][3];  // half of each axis, and its absolute value
  float o_least[3], o_most[3];               // bounds of o along the axes
  F8 tile[kSets][4];  // of each group: slope across from, to; slope up from, to
  float around[4];    // the same of all groups
  float spread;       // greatest |o|
  bool mixed;         // whether the signs of the directions differ
  // The edges of a box that the rays meet first and last, of lo x y z, hi x y z; if they are mixed,
  // lo and hi.
  ptrdiff_t first_edge[3], last_edge[3];
};

// Sets the axes by the mean of the directions. Gives false if that is zero.
inline bool set_axes(Rays& r) {
  F sum[3];
  for (int a = 0; a < 3; ++a) {
    sum[a] = r.d[a][0];
    for (int g = 1; g < kGroups; ++g) sum[a] += r.d[a][g];
  }
  float *u = r.axis[0], *v = r.axis[1], *w = r.axis[2], norm2 = 0;
  for (int a = 0; a < 3; ++a) {
    w[a] = 0;
    for (int k = 0; k < kLanes; ++k) w[a] += sum[a][k];
    norm2 += w[a] * w[a];
  }
  if (!(norm2 > 1)) return false;
  const float inverse = 1 / __builtin_sqrtf(norm2);
  for (int a = 0; a < 3; ++a) w[a] *= inverse;
  const bool steep = __builtin_fabsf(w[2]) >= 0.9f;
  const float h = 1 / __builtin_sqrtf(w[1] * w[1] + (steep ? w[2] * w[2] : w[0] * w[0]));
  u[0] = steep ? 0 : -w[1] * h;
  u[1] = steep ? -w[2] * h : w[0] * h;
  u[2] = steep ? w[1] * h : 0;
  v[0] = w[1] * u[2] - w[2] * u[1];
  v[1] = w[2] * u[0] - w[0] * u[2];
  v[2] = w[0] * u[1] - w[1] * u[0];
  return true;
}

// Computes the axes, the slopes and their bounds. Gives false if the rays spread too far for
// slopes.
inline bool enclose(Rays& r) {
  if (!set_axes(r)) return false;
  F slope[2][kGroups], w0 = all(1e30f), low[3], high[3];
  const auto along = [&](const F v[3][kGroups], int g, const float* n) {
    return muladd(v[0][g], all(n[0]), muladd(v[1][g], all(n[1]), v[2][g] * all(n[2])));
  };
  for (int a = 0; a < 3; ++a) low[a] = all(1e30f), high[a] = all(-1e30f);
  for (int g = 0; g < kGroups; ++g) {
    const F w = along(r.d, g, r.axis[2]), i = 1.0f / w;
    w0 = lesser(w0, w);
    for (int a = 0; a < 2; ++a) slope[a][g] = along(r.d, g, r.axis[a]) * i;
    for (int a = 0; a < 3; ++a) {
      const F o = along(r.o, g, r.axis[a]);
      low[a] = lesser(low[a], o);
      high[a] = greater(high[a], o);
    }
  }
  if (!(least(w0) > 0.85f)) return false;
  const float slack = 4e-6f, margin = 1e-5f * r.spread;
  for (int a = 0; a < 2; ++a) {
    for (int set = 0; set < kSets; ++set) {
      r.tile[set][2 * a] = least_of_groups(slope[a] + 8 * set) - slack;
      r.tile[set][2 * a + 1] = greatest_of_groups(slope[a] + 8 * set) + slack;
    }
    F8 low_of = r.tile[0][2 * a], high_of = r.tile[0][2 * a + 1];
    for (int set = 1; set < kSets; ++set) {
      low_of = lesser(low_of, r.tile[set][2 * a]);
      high_of = greater(high_of, r.tile[set][2 * a + 1]);
    }
    r.around[2 * a] = least(low_of);
    r.around[2 * a + 1] = greatest(high_of);
  }
  for (int a = 0; a < 3; ++a) {
    r.o_least[a] = least(low[a]) - margin;
    r.o_most[a] = greatest(high[a]) + margin;
  }
  return true;
}

// Bounds of eight boxes or elements along the axes, relative to the centre, as slopes that the rays
// see.
struct alignas(32) SlopeBounds {
  float across_from[8], across_to[8], up_from[8], up_to[8], depth[8];
};

inline void bound_slopes(const Rays& r, const F8 from[3], const F8 to[3], SlopeBounds& out) {
  const F8 near_by = from[2] - all8(r.o_most[2]), far_away = to[2] - all8(r.o_least[2]);
  const F8 tiny = all8(1e-30f);
  const F8 by_near = 1.0f / greater(near_by, tiny), by_far = 1.0f / greater(far_away, tiny);
  float* edge[4] = {out.across_from, out.across_to, out.up_from, out.up_to};
  for (int a = 0; a < 2; ++a) {
    const F8 low = from[a] - all8(r.o_most[a]), high = to[a] - all8(r.o_least[a]);
    *reinterpret_cast<F8*>(edge[2 * a]) = lesser(low * by_near, low * by_far);
    *reinterpret_cast<F8*>(edge[2 * a + 1]) = greater(high * by_near, high * by_far);
  }
  *reinterpret_cast<F8*>(out.depth) = pick(le(F8{}, far_away), near_by, all8(INFINITY));
}

// For each of eight boxes or elements, the groups of rays that may meet it, as bits.
struct Meetings {
  unsigned children;  // the boxes or elements that any group may meet
  uint16_t any[8];    // the groups; set for those of `children`
  uint16_t whole[8];  // if asked for: those among them whose rays all point at the bounds
};
static_assert(kGroups <= 16);

// Finds which of `groups` may meet what. `reach` is how far each group looks.
template <bool kWhole>
inline void find_meetings(const Rays& r, const F8 reach[kSets], const SlopeBounds& out,
                          unsigned groups, Meetings& to) {
  const F8 across_from = load8(out.across_from), across_to = load8(out.across_to),
           up_from = load8(out.up_from), up_to = load8(out.up_to);
  to.children = 0;
  const unsigned around =
      kWhole ? bits(le(across_from, all8(r.around[0])) & le(all8(r.around[1]), across_to) &
                    le(up_from, all8(r.around[2])) & le(all8(r.around[3]), up_to))
             : 0;
  for (unsigned left = bits(le(all8(r.around[0]), across_to) & le(across_from, all8(r.around[1])) &
                            le(all8(r.around[2]), up_to) & le(up_from, all8(r.around[3])));
       left; left &= left - 1) {
    const int k = __builtin_ctz(left);
    const F8 depth = all8(out.depth[k]);
    unsigned any = 0, whole = 0;
    if (kWhole && around >> k & 1) {
      for (int set = 0; set < kSets; ++set) any |= bits(le(depth, reach[set])) << (8 * set);
      whole = any;
    } else {
      const F8 across_0 = all8(out.across_from[k]), across_1 = all8(out.across_to[k]),
               up_0 = all8(out.up_from[k]), up_1 = all8(out.up_to[k]);
      for (int set = 0; set < kSets; ++set) {
        const F8* tile = r.tile[set];
        any |= bits(le(tile[0], across_1) & le(across_0, tile[1]) & le(tile[2], up_1) &
                    le(up_0, tile[3]) & le(depth, reach[set]))
               << (8 * set);
        if (kWhole) {
          whole |= bits(le(across_0, tile[0]) & le(tile[1], across_1) & le(up_0, tile[2]) &
                        le(tile[3], up_1))
                   << (8 * set);
        }
      }
    }
    any &= groups;
    to.any[k] = uint16_t(any);
    if (kWhole) to.whole[k] = uint16_t(whole & any);
    to.children |= unsigned(any != 0) << k;
  }
}

// Calls visit(k, g) for every box or element k and every group g that may meet it.
template <class Visit>
__attribute__((always_inline)) inline void for_each(const Meetings& meetings, Visit visit) {
  for (unsigned left = meetings.children; left; left &= left - 1) {
    const unsigned k = unsigned(__builtin_ctz(left));
    for (unsigned groups = meetings.any[k]; groups; groups &= groups - 1) {
      visit(k, unsigned(__builtin_ctz(groups)));
    }
  }
}

// Computes what follows from the directions and axes.
inline void finish(Rays& r) {
  for (int p = 0; p < 3; ++p) {
    for (int a = 0; a < 3; ++a) {
      r.half_axis[p][a] = 0.5f * r.axis[p][a];
      r.half_extent[p][a] = __builtin_fabsf(r.half_axis[p][a]);
    }
  }
  r.mixed = false;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    for (int g = 0; g < kGroups; ++g) {
      r.moment[a][g] = muladd(r.o[b][g], r.d[c][g], -(r.o[c][g] * r.d[b][g]));
    }
    unsigned any = 0, every = ~0u;
    for (int g = 0; g < kGroups; ++g) {
      const F d = r.d[a][g];
      const F safe = flip(greater(absolute(d), all(1e-20f)), sign_of(d));
      r.inverse[a][g] = 1.0f / safe;
      r.start[a][g] = -r.o[a][g] * r.inverse[a][g];
      const unsigned below_zero = bits(le(r.inverse[a][g], all(0.0f)));
      any |= below_zero;
      every &= below_zero;
    }
    const unsigned full = kLanes == 16 ? 0xffffu : 0xffu;
    r.first_edge[a] = any != 0 ? a + 3 : a;
    r.mixed |= any != 0 && every != full;
  }
  for (int a = 0; a < 3; ++a) {
    if (r.mixed) r.first_edge[a] = a;
    r.last_edge[a] = 2 * a + 3 - r.first_edge[a];
  }
}

// Transforms the rays into the frame of a rotated or scaled instance.
inline void rotate(const Rays& world, const Placement& p, Rays& local) {
  F m[9];
  for (int k = 0; k < 9; ++k) m[k] = all(float(p.rotation[k]));
  const F shrink = all(float(1 / p.scale));
  for (int g = 0; g < kGroups; ++g) {
    for (int a = 0; a < 3; ++a) {
      const F* row = m + 3 * a;
      local.d[a][g] =
          muladd(row[0], world.d[0][g], muladd(row[1], world.d[1][g], row[2] * world.d[2][g]));
      local.o[a][g] = shrink * muladd(row[0], world.o[0][g],
                                      muladd(row[1], world.o[1][g], row[2] * world.o[2][g]));
    }
  }
  const float s = float(1 / p.scale), margin = s * 1e-6f * world.spread;
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < 3; ++a) {
      local.axis[i][a] = float(p.rotation[3 * a]) * world.axis[i][0] +
                         float(p.rotation[3 * a + 1]) * world.axis[i][1] +
                         float(p.rotation[3 * a + 2]) * world.axis[i][2];
    }
    local.o_least[i] = s * world.o_least[i] - margin;
    local.o_most[i] = s * world.o_most[i] + margin;
  }
  __builtin_memcpy(local.tile, world.tile, sizeof(local.tile));
  __builtin_memcpy(local.around, world.around, sizeof(local.around));
  local.spread = s * world.spread * 1.000001f;
  finish(local);
}

// Computes the angle of (x, y) in quarter turns from −2 to 2, to about 0.001.
inline F8 quarter_turns(F8 x, F8 y) {
  const F8 sum = greater(absolute(x) + absolute(y), all8(1e-20f));
  const F8 from_diagonal = 1.0f - 2.0f * absolute(x) / sum, square = from_diagonal * from_diagonal;
  const F8 atan = muladd(muladd(square, all8(0.0793f), all8(-0.2887f)), square, all8(0.9953f));
  const F8 first = muladd(atan * float(M_2_PI), from_diagonal, all8(0.5f));
  const F8 half = pick(le(F8{}, x), first, 2.0f - first);
  return (F8)((U8)half ^ ((U8)y & 0x80000000u));
}

inline void convert_rays(const View& view, const Ray* rays, const uint64_t* keys, size_t count,
                         FloatRays& out) {
  for (int a = 0; a < 3; ++a) out.centre[a] = rays[0].origin.data()[a] - view.origin[a];
  const D centre{view.origin[0] + out.centre[0], view.origin[1] + out.centre[1],
                 view.origin[2] + out.centre[2], 0};
#pragma GCC unroll 4
  for (size_t i = 0; i < count; ++i) {
    const double* from = rays[i].origin.data();
    const D o_d = *reinterpret_cast<const D4*>(from) - centre;
    *reinterpret_cast<F4*>(out.row[i]) = to_float(o_d);
    out.row[i][4] = float(from[4]);
    out.row[i][5] = float(from[5]);
    const uint64_t key = keys ? keys[i] : 0;
    __builtin_memcpy(&out.row[i][6], &key, 8);
  }
  for (size_t i = count; i % 8; ++i) __builtin_memcpy(out.row[i], out.row[count - 1], 32);
  F8 low = all8(INFINITY), high = -low, sin_elevation_low = low, sin_elevation_high = high,
     far2 = all8(0.0f);
  float first = 0;
  for (size_t i = 0; i < count; i += 8) {
    F8 x[8];
    for (size_t k = 0; k < 8; ++k) x[k] = load8(out.row[i + k]);
    transpose(x);
    F8 turn = quarter_turns(x[3], x[4]);
    if (i == 0) first = turn[0];
    turn -= first;
    turn = pick(le(turn, all8(-2.0f)), turn + 4.0f, turn);
    turn = pick(le(all8(2.0f), turn), turn - 4.0f, turn);
    *reinterpret_cast<F8*>(&out.azimuth[i]) = turn;
    *reinterpret_cast<F8*>(&out.sin_elevation[i]) = x[5];
    low = lesser(low, turn);
    high = greater(high, turn);
    sin_elevation_low = lesser(sin_elevation_low, x[5]);
    sin_elevation_high = greater(sin_elevation_high, x[5]);
    far2 = greater(far2, muladd(x[0], x[0], muladd(x[1], x[1], x[2] * x[2])));
  }
  out.azimuth_low = least(low);
  out.azimuth_high = greatest(high);
  out.sin_elevation_low = least(sin_elevation_low);
  out.sin_elevation_high = greatest(sin_elevation_high);
  out.spread = __builtin_sqrtf(greatest(far2)) * 1.00001f;
}

}  // namespace
}  // namespace underbrush::trace
