// Included by kernel.inl: 64 rays through the tree together. A frustum around them decides on nodes
// and elements first, eight at a time; what is left meets the rays, kLanes at a time.
namespace underbrush::trace {
namespace {

// What a packet's rays have found so far. The range of the element held for a ray is certain to lie
// in [low, high]; its rounding is what separates them.
struct Found {
  F low[kGroups], high[kGroups];
  U element[kGroups], instance[kGroups];
  uint64_t exact = 0;  // rays whose find stands in Batch::best
  float farthest;      // greatest of high
};

// The rays in one frame, relative to a common centre.
struct alignas(64) Rays {
  F d[3][kGroups], o[3][kGroups], inverse[3][kGroups];
  F start[3][kGroups];  // −o·inverse
  double centre[3];
  float plane[5][3];    // outward normals of the frustum's sides, then its axis
  float side[4];        // a point p is outside of side i where plane[i]·p > side[i]
  float depth, behind;  // along the axis: a point is reached from `depth` on; nothing before `behind`
  float spread;         // greatest |o|
  bool mixed;           // signs of the directions differ
  bool negative[3];
};

struct Keys {
  U low[kGroups], high[kGroups];
};

// A frame to search: rays, the float halves of the centre, and whose elements they are.
struct Frame {
  const Rays* rays;
  const Node* nodes;
  const EllipsoidBlock* ellipsoids;
  const TriangleBlock* triangles;
  float high[3], low[3];
  float lower[3], upper[3];  // the centre, moved so that boxes come out too large
  uint32_t instance, salt_low, salt_high;
  float scale;
  float t_min, t_max;  // ranges that may count
};

struct Search {
  const View* view;
  Batch* batch;
  Keys keys;
  Found found;
};

inline void set_centre(Frame& f, const double centre[3], float spread) {
  for (int a = 0; a < 3; ++a) {
    f.high[a] = float(centre[a]);
    f.low[a] = float(centre[a] - double(f.high[a]));
    const float pad = __builtin_fabsf(f.high[a]) * 2.5e-7f + spread * 3e-7f;
    f.lower[a] = f.high[a] + pad;
    f.upper[a] = f.high[a] - pad;
  }
}

// The frustum around the rays; false if they spread too far for one.
inline bool enclose(Rays& r) {
  F sum[3];
  for (int a = 0; a < 3; ++a) {
    sum[a] = r.d[a][0];
    for (int g = 1; g < kGroups; ++g) sum[a] += r.d[a][g];
  }
  float axis[3], norm2 = 0;
  for (int a = 0; a < 3; ++a) {
    axis[a] = 0;
    for (int k = 0; k < kLanes; ++k) axis[a] += sum[a][k];
    norm2 += axis[a] * axis[a];
  }
  if (!(norm2 > 1)) return false;
  const float inverse = 1 / __builtin_sqrtf(norm2);
  for (float& x : axis) x *= inverse;
  float u[3], v[3];
  const bool steep = __builtin_fabsf(axis[2]) >= 0.9f;
  const float h = 1 / __builtin_sqrtf(axis[1] * axis[1] + (steep ? axis[2] * axis[2]
                                                                 : axis[0] * axis[0]));
  u[0] = steep ? 0 : -axis[1] * h;
  u[1] = steep ? -axis[2] * h : axis[0] * h;
  u[2] = steep ? axis[1] * h : 0;
  v[0] = axis[1] * u[2] - axis[2] * u[1];
  v[1] = axis[2] * u[0] - axis[0] * u[2];
  v[2] = axis[0] * u[1] - axis[1] * u[0];
  F x0 = all(1e30f), x1 = all(-1e30f), y0 = x0, y1 = x1, w0 = x0;
  for (int g = 0; g < kGroups; ++g) {
    const auto along = [&](const float* n) {
      return muladd(r.d[0][g], all(n[0]), muladd(r.d[1][g], all(n[1]), r.d[2][g] * all(n[2])));
    };
    const F w = along(axis), i = 1.0f / w, x = along(u) * i, y = along(v) * i;
    w0 = lesser(w0, w);
    x0 = lesser(x0, x);
    x1 = greater(x1, x);
    y0 = lesser(y0, y);
    y1 = greater(y1, y);
  }
  if (!(least(w0) > 0.85f)) return false;
  const float slack = 2e-6f;
  const float edge[4] = {greatest(x1) + slack, least(x0) - slack, greatest(y1) + slack,
                         least(y0) - slack};
  for (int a = 0; a < 3; ++a) {
    r.plane[0][a] = u[a] - edge[0] * axis[a];
    r.plane[1][a] = edge[1] * axis[a] - u[a];
    r.plane[2][a] = v[a] - edge[2] * axis[a];
    r.plane[3][a] = edge[3] * axis[a] - v[a];
    r.plane[4][a] = axis[a];
  }
  F most[5], nearest = all(1e30f);
  for (int p = 0; p < 5; ++p) {
    most[p] = all(-1e30f);
    for (int g = 0; g < kGroups; ++g) {
      const F at = muladd(r.o[0][g], all(r.plane[p][0]),
                          muladd(r.o[1][g], all(r.plane[p][1]), r.o[2][g] * all(r.plane[p][2])));
      most[p] = greater(most[p], at);
      if (p == 4) nearest = lesser(nearest, at);
    }
  }
  const float margin = 1e-4f + 1e-5f * r.spread;
  for (int p = 0; p < 4; ++p) r.side[p] = greatest(most[p]) + margin;
  r.depth = greatest(most[4]) + margin;
  r.behind = least(nearest) - margin;
  return true;
}

// Reciprocals and signs, from d.
inline void finish(Rays& r) {
  r.mixed = false;
  for (int a = 0; a < 3; ++a) {
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
    r.negative[a] = any != 0;
    r.mixed |= any != 0 && every != full;
  }
}

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

inline void remember(Found& found) {
  F most = found.high[0];
  for (int g = 1; g < kGroups; ++g) most = greater(most, found.high[g]);
  found.farthest = greatest(most);
}

// Lanes `maybe` of group g meet the element within [low, high]; `sure` of them beyond doubt, and
// nearer than what they have.
template <Ask kAsk>
inline void keep(Search& s, const Frame& f, int g, uint32_t element, M maybe, M sure, F low,
                 F high) {
  Found& found = s.found;
  unsigned lanes = bits(maybe);
  if (kAsk == Ask::kAll) {
    while (lanes) {
      const int k = __builtin_ctz(lanes);
      lanes &= lanes - 1;
      const int place = g * kLanes + k;
      if (place >= s.batch->count) break;
      add_candidate(*s.batch, s.batch->ray(place), f.instance, element);
    }
    return;
  }
  const unsigned certain = bits(sure);
  if (certain) {
    found.low[g] = pick(sure, low, found.low[g]);
    found.high[g] = pick(sure, high, found.high[g]);
    found.element[g] = pick(sure, all(element), found.element[g]);
    found.instance[g] = pick(sure, all(f.instance), found.instance[g]);
    found.exact &= ~(uint64_t(certain) << (g * kLanes));
  }
  lanes &= ~certain;
  while (lanes) {
    const int k = __builtin_ctz(lanes);
    lanes &= lanes - 1;
    const int ray = g * kLanes + k;
    const uint64_t bit = uint64_t(1) << ray;
    const uint32_t have = found.exact & bit ? Met::kNone : uint32_t(found.element[g][k]);
    const size_t i = s.batch->ray(ray);
    if (!settle_nearest(*s.view, kAsk, *s.batch, i, f.instance, element,
                        uint32_t(found.instance[g][k]), have)) {
      continue;
    }
    const float t = float(s.batch->best[i].t_m / f.scale);
    found.low[g][k] = t * 0.9999999f;
    found.high[g][k] = t * 1.0000001f;
    found.element[g][k] = element;
    found.instance[g][k] = f.instance;
    found.exact |= bit;
  }
}

template <Ask kAsk>
inline M accepted(const Search& s, const Frame& f, int g, uint32_t element, uint32_t accept_below) {
  if (accept_below == 0xffffffffu) return mask_of(~0u);
  return below(accept_hash(all(element), s.keys.low[g] ^ f.salt_low, s.keys.high[g] ^ f.salt_high),
               all(accept_below));
}

// One block of ellipsoids; true if something was found.
template <Ask kAsk>
inline bool visit_ellipsoids(Search& s, const Frame& f, const EllipsoidBlock& b, unsigned groups,
                             bool careful) {
  const Rays& r = *f.rays;
  F8 m[3];
  for (int a = 0; a < 3; ++a) m[a] = (load8(b.mean[a]) - f.high[a]) - f.low[a];
  const F8 u00 = load8(b.u[0]), u01 = load8(b.u[1]), u02 = load8(b.u[2]);
  const F8 u11 = load8(b.u[3]), u12 = load8(b.u[4]), u22 = load8(b.u[5]);
  // Outside of the frustum: further from a side than the ellipsoid's support |U⁻ᵀ n|.
  const F8 r0 = 1.0f / u00, r1 = 1.0f / u11, r2 = 1.0f / u22;
  I8 inside = every8();
  for (int p = 0; p < 4; ++p) {
    const float* n = r.plane[p];
    const F8 w0 = n[0] * r0, w1 = (n[1] - u01 * w0) * r1,
             w2 = (n[2] - u02 * w0 - u12 * w1) * r2;
    const F8 support2 = muladd(w0, w0, muladd(w1, w1, w2 * w2));
    const F8 at = muladd(m[0], all8(n[0]), muladd(m[1], all8(n[1]), m[2] * n[2])) - r.side[p];
    const F8 out = greater(at, F8{});
    inside &= out * out <= support2 * 1.01f;
  }
  unsigned left = bits(inside);
  if (!left) return false;
  // Bounds on the rounding: of the Mahalanobis distance, and per unit of range.
  const F8 size =
      absolute(u00) + absolute(u01) + absolute(u02) + absolute(u11) + absolute(u12) + absolute(u22);
  const F8 away = root(muladd(m[0], m[0], muladd(m[1], m[1], m[2] * m[2]))) + r.spread;
  alignas(32) float slack[8], size_of[8], mean[3][8];
  *reinterpret_cast<F8*>(slack) = muladd(away, size * 6e-7f, all8(4e-4f));
  *reinterpret_cast<F8*>(size_of) = size * 1e-6f;
  for (int a = 0; a < 3; ++a) *reinterpret_cast<F8*>(mean[a]) = m[a];
  bool any = false;
  while (left) {
    const int j = __builtin_ctz(left);
    left &= left - 1;
    const float outer = 1 + slack[j], inner = slack[j] < 1 ? 1 - slack[j] : 0;
    for (unsigned waiting = groups; waiting; waiting &= waiting - 1) {
      const int g = __builtin_ctz(waiting);
      const F dx = r.d[0][g], dy = r.d[1][g], dz = r.d[2][g];
      const F vx = mean[0][j] - r.o[0][g], vy = mean[1][j] - r.o[1][g], vz = mean[2][j] - r.o[2][g];
      const F t0 = muladd(vx, dx, muladd(vy, dy, vz * dz));
      const F qx = muladd(-t0, dx, vx), qy = muladd(-t0, dy, vy), qz = muladd(-t0, dz, vz);
      const F u_0 = all(b.u[0][j]), u_1 = all(b.u[1][j]), u_2 = all(b.u[2][j]);
      const F u_3 = all(b.u[3][j]), u_4 = all(b.u[4][j]), u_5 = all(b.u[5][j]);
      const F a0 = muladd(u_0, dx, muladd(u_1, dy, u_2 * dz)), a1 = muladd(u_3, dy, u_4 * dz),
              a2 = u_5 * dz;
      const F b0 = muladd(u_0, qx, muladd(u_1, qy, u_2 * qz)), b1 = muladd(u_3, qy, u_4 * qz),
              b2 = u_5 * qz;
      const F a = muladd(a0, a0, muladd(a1, a1, a2 * a2));
      const F h = muladd(a0, b0, muladd(a1, b1, a2 * b2));
      const F c = muladd(b0, b0, muladd(b1, b1, b2 * b2));
      const F hh = h * h;
      M maybe = le((c - outer * outer) * a, hh * 1.00001f);
      if (!bits(maybe)) continue;
      const F i = 1.0f / a, step = h * i, t = t0 + step, reach = root(i);
      const F error = reach * muladd(all(size_of[j]), absolute(step) + reach, all(slack[j])) +
                      (absolute(t0) + absolute(step)) * 6e-7f;
      const F low = t - error, high = t + error;
      maybe &= le(all(f.t_min), high);
      maybe &= le(low, kAsk == Ask::kAll ? all(f.t_max) : s.found.high[g]);
      if (!bits(maybe)) continue;
      M sure = maybe;
      if (kAsk == Ask::kAccepted) {
        maybe &= accepted<kAsk>(s, f, g, b.element[j], b.accept_below[j]);
        if (!bits(maybe)) continue;
        sure = careful ? mask_of(0)
                       : M(maybe & le((c - inner * inner) * a, hh * 0.99999f) &
                           le(high, s.found.low[g]) & le(all(f.t_min), low));
      }
      keep<kAsk>(s, f, g, b.element[j], maybe, sure, low, high);
      any = true;
    }
  }
  return any;
}

// One block of triangles; true if something was found.
template <Ask kAsk>
inline bool visit_triangles(Search& s, const Frame& f, const TriangleBlock& b, unsigned groups) {
  const Rays& r = *f.rays;
  F8 v[3], e1[3], e2[3];
  for (int a = 0; a < 3; ++a) {
    const F8 corner = load8(b.corner[0][a]);
    v[a] = (corner - f.high[a]) - f.low[a];
    e1[a] = load8(b.corner[1][a]) - corner;
    e2[a] = load8(b.corner[2][a]) - corner;
  }
  const F8 away = root(muladd(v[0], v[0], muladd(v[1], v[1], v[2] * v[2]))) + r.spread;
  I8 inside = every8();
  for (int p = 0; p < 4; ++p) {
    const float* n = r.plane[p];
    const F8 at = muladd(v[0], all8(n[0]), muladd(v[1], all8(n[1]), v[2] * n[2])) - r.side[p];
    const F8 along1 = muladd(e1[0], all8(n[0]), muladd(e1[1], all8(n[1]), e1[2] * n[2]));
    const F8 along2 = muladd(e2[0], all8(n[0]), muladd(e2[1], all8(n[1]), e2[2] * n[2]));
    inside &= at + lesser(F8{}, lesser(along1, along2)) <= away * 1e-6f;
  }
  unsigned left = bits(inside);
  if (!left) return false;
  const F8 l1 = root(muladd(e1[0], e1[0], muladd(e1[1], e1[1], e1[2] * e1[2])));
  const F8 l2 = root(muladd(e2[0], e2[0], muladd(e2[1], e2[1], e2[2] * e2[2])));
  alignas(32) float slack[8], range_slack[8], corner[3][8], side1[3][8], side2[3][8];
  *reinterpret_cast<F8*>(slack) = (away + l1 + l2) * (l1 + l2) * 8e-7f;
  *reinterpret_cast<F8*>(range_slack) = (away + l1 + l2) * l1 * l2 * 1e-6f;
  for (int a = 0; a < 3; ++a) {
    *reinterpret_cast<F8*>(corner[a]) = v[a];
    *reinterpret_cast<F8*>(side1[a]) = e1[a];
    *reinterpret_cast<F8*>(side2[a]) = e2[a];
  }
  bool any = false;
  while (left) {
    const int j = __builtin_ctz(left);
    left &= left - 1;
    const F e1x = all(side1[0][j]), e1y = all(side1[1][j]), e1z = all(side1[2][j]);
    const F e2x = all(side2[0][j]), e2y = all(side2[1][j]), e2z = all(side2[2][j]);
    for (unsigned waiting = groups; waiting; waiting &= waiting - 1) {
      const int g = __builtin_ctz(waiting);
      const F dx = r.d[0][g], dy = r.d[1][g], dz = r.d[2][g];
      const F sx = r.o[0][g] - corner[0][j], sy = r.o[1][g] - corner[1][j],
              sz = r.o[2][g] - corner[2][j];
      const F px = muladd(dy, e2z, -(dz * e2y)), py = muladd(dz, e2x, -(dx * e2z)),
              pz = muladd(dx, e2y, -(dy * e2x));
      const F qx = muladd(sy, e1z, -(sz * e1y)), qy = muladd(sz, e1x, -(sx * e1z)),
              qz = muladd(sx, e1y, -(sy * e1x));
      const F signed_det = muladd(e1x, px, muladd(e1y, py, e1z * pz)), sign = sign_of(signed_det);
      const F det = absolute(signed_det);
      const F x = flip(muladd(sx, px, muladd(sy, py, sz * pz)), sign);
      const F y = flip(muladd(dx, qx, muladd(dy, qy, dz * qz)), sign);
      const F rest = det - x - y;
      const F least_weight = lesser(x, lesser(y, rest));
      M maybe = le(all(-3 * slack[j]), least_weight);
      if (!bits(maybe)) continue;
      const F doubtful = all(3 * slack[j]);
      const F i = 1.0f / greater(det, all(slack[j]));
      const F t = flip(muladd(e2x, qx, muladd(e2y, qy, e2z * qz)), sign) * i;
      const F error = muladd(all(range_slack[j]), i, absolute(t) * 6e-7f);
      const F low = t - error, high = t + error;
      const F limit = kAsk == Ask::kAll ? all(f.t_max) : s.found.high[g];
      maybe &= M(le(all(f.t_min), high) & le(low, limit)) | le(det, doubtful);
      if (!bits(maybe)) continue;
      M sure = maybe;
      if (kAsk != Ask::kAll) {
        if (kAsk == Ask::kAccepted) {
          maybe &= accepted<kAsk>(s, f, g, b.element[j], b.accept_below[j]);
          if (!bits(maybe)) continue;
        }
        sure = maybe & le(all(slack[j]), least_weight) & le(high, s.found.low[g]) &
               le(all(f.t_min), low);
      }
      keep<kAsk>(s, f, g, b.element[j], maybe, sure, low, high);
      any = true;
    }
  }
  return any;
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
      return muladd(load8(edge[which[0]]), all8(normal[0]),
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

// The rays in the frame of a rotated or scaled instance.
inline void rotate(const Rays& world, const Placement& p, Rays& local) {
  F m[9];
  for (int k = 0; k < 9; ++k) m[k] = all(float(p.rotation[k]));
  const F shrink = all(float(1 / p.scale));
  for (int g = 0; g < kGroups; ++g) {
    for (int a = 0; a < 3; ++a) {
      const F* row = m + 3 * a;
      local.d[a][g] = muladd(row[0], world.d[0][g],
                             muladd(row[1], world.d[1][g], row[2] * world.d[2][g]));
      local.o[a][g] = shrink * muladd(row[0], world.o[0][g],
                                      muladd(row[1], world.o[1][g], row[2] * world.o[2][g]));
    }
  }
  finish(local);
  const float s = float(1 / p.scale);
  for (int i = 0; i < 5; ++i) {
    for (int a = 0; a < 3; ++a) {
      local.plane[i][a] = float(p.rotation[3 * a]) * world.plane[i][0] +
                          float(p.rotation[3 * a + 1]) * world.plane[i][1] +
                          float(p.rotation[3 * a + 2]) * world.plane[i][2];
    }
  }
  const float margin = s * (1e-5f + 1e-6f * world.spread);
  for (int i = 0; i < 4; ++i) local.side[i] = s * world.side[i] + margin;
  local.depth = s * world.depth + margin;
  local.behind = s * world.behind - margin;
  local.spread = s * world.spread * 1.000001f;
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

// Wraps kLanes rays at a time into columns; the rest of the last vector repeats the last ray.
inline void unfold(const View& view, const Ray* rays, size_t count, Columns& out) {
  for (int a = 0; a < 3; ++a) out.centre[a] = rays[0].origin.data()[a] - view.origin[a];
  const size_t whole = (count + kLanes - 1) / kLanes * kLanes;
  for (size_t i = 0; i < whole; ++i) {
    const Ray& ray = rays[i < count ? i : count - 1];
    for (int a = 0; a < 3; ++a) {
      out.direction[a][i] = float(ray.direction.data()[a]);
      out.offset[a][i] = float(ray.origin.data()[a] - view.origin[a] - out.centre[a]);
    }
  }
  const auto at = [](const float* p) { return *reinterpret_cast<const F*>(p); };
  F low = all(INFINITY), high = -low, up_low = low, up_high = high, far2 = all(0.0f);
  float first = 0;
  for (size_t i = 0; i < whole; i += kLanes) {
    const F x = at(&out.direction[0][i]), y = at(&out.direction[1][i]),
            z = at(&out.direction[2][i]);
    const F sum = absolute(x) + absolute(y);
    F turn = flip(1.0f - x / greater(sum, all(1e-20f)), sign_of(y));
    if (i == 0) first = turn[0];
    turn -= first;
    turn = pick(le(turn, all(-2.0f)), turn + 4.0f, turn);
    turn = pick(le(all(2.0f), turn), turn - 4.0f, turn);
    *reinterpret_cast<F*>(&out.turn[i]) = turn;
    low = lesser(low, turn);
    high = greater(high, turn);
    up_low = lesser(up_low, z);
    up_high = greater(up_high, z);
    const F ox = at(&out.offset[0][i]), oy = at(&out.offset[1][i]), oz = at(&out.offset[2][i]);
    far2 = greater(far2, muladd(ox, ox, muladd(oy, oy, oz * oz)));
  }
  out.turn_low = least(low);
  out.turn_high = greatest(high);
  out.up_low = least(up_low);
  out.up_high = greatest(up_high);
  out.spread = __builtin_sqrtf(greatest(far2)) * 1.00001f;
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
