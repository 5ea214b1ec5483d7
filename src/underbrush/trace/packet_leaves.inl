// Included by kernel.inl: a packet's rays against the blocks of leaves. A frustum test of eight
// elements first; what is left meets the rays, kLanes at a time.
namespace underbrush::trace {
namespace {

// What a packet's rays have found so far. The range of the element held for a ray is certain to lie
// in [low, high]; its rounding is what separates them.
struct Found {
  F low[kGroups], high[kGroups];
  U element[kGroups], instance[kGroups];
  unsigned exact[kGroups];  // lanes whose find stands in Batch::best
  F8 reach;                 // of each group the greatest of high
  float farthest;           // of all
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
  float scale, half_tau2;
  float t_min, t_max;  // ranges that may count
};

struct Search {
  const View* view;
  Batch* batch;
  const uint32_t* number;  // of the rays, counted from the batch's first
  int count;               // the other places repeat the last ray
  Keys keys;
  Found found;
};

// Eight things that a packet has come to: a node's boxes or a block's elements.
struct alignas(32) Look {
  Outlines seen;
  union {
    float edge[6][8];  // of boxes: lo x y z, hi x y z, relative to the centre
    struct {
      float mean[3][8], slack[8], size[8];
    } ellipsoid;
    struct {
      float corner[3][8], side1[3][8], side2[3][8], slack[8], range_slack[8];
    } triangle;
  };
  uint64_t pairs;
};

inline void store(float* to, F8 x) { *reinterpret_cast<F8*>(to) = x; }

inline size_t ray_at(const Search& s, int place) { return s.batch->first + s.number[place]; }

inline void set_centre(Frame& f, const double centre[3], float spread) {
  for (int a = 0; a < 3; ++a) {
    f.high[a] = float(centre[a]);
    f.low[a] = float(centre[a] - double(f.high[a]));
    const float pad = __builtin_fabsf(f.high[a]) * 2.5e-7f + spread * 3e-7f;
    f.lower[a] = f.high[a] + pad;
    f.upper[a] = f.high[a] - pad;
  }
}

inline void remember(Found& found) {
  found.reach = greatest_of_groups(found.high);
  found.farthest = greatest(found.reach);
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
      if (place >= s.count) break;
      add_candidate(*s.batch, ray_at(s, place), f.instance, element);
    }
    return;
  }
  const unsigned certain = bits(sure);
  if (certain) {
    found.low[g] = pick(sure, low, found.low[g]);
    found.high[g] = pick(sure, high, found.high[g]);
    found.element[g] = pick(sure, all(element), found.element[g]);
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
    const uint32_t have = found.exact[g] & bit ? Met::kNone : uint32_t(found.element[g][k]);
    const size_t i = ray_at(s, place);
    if (found.element[g][k] == Met::kNone) s.batch->best[i] = Met{};
    if (!settle_nearest(*s.view, kAsk, *s.batch, i, f.instance, element,
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

inline M accepted(const Search& s, const Frame& f, int g, uint32_t element, uint32_t accept_below) {
  const M always = mask_of(accept_below == 0xffffffffu ? ~0u : 0);
  return always |
         below(accept_hash(all(element), s.keys.low[g] ^ f.salt_low, s.keys.high[g] ^ f.salt_high),
               all(accept_below));
}

// Lanes that may accept an ellipsoid of path-length opacity, and those that do beyond doubt. `m2`
// is δ²/τ² and `m2_error` a bound on its error, `reach_error` one on that of `reach` = τσ,
// relative.
struct Trial {
  M maybe, sure;
};
inline Trial path_length_trial(const Search& s, const Frame& f, int g, uint32_t element,
                               float depth, F reach, F reach_error, F m2, F m2_error) {
  const F one = all(1.0f), slack = all(1e-6f);
  const F x = all(depth) * reach * exp_below_zero(-all(f.half_tau2) * greater(m2, all(0.0f)));
  const F error = muladd(all(f.half_tau2), m2_error, reach_error) + 1e-5f;
  const F low = one - exp_below_zero(-x * greater(one - error, all(0.0f)));
  const F high =
      pick(le(error, one), one - exp_below_zero(-x * muladd(all(2.0f), error, one)), one);
  const U hash =
      accept_hash(all(element), s.keys.low[g] ^ f.salt_low, s.keys.high[g] ^ f.salt_high);
  const F trial = __builtin_convertvector((I)(hash >> 8), F) * 0x1p-24f;
  return {le(trial, high + slack), le(trial + 2.0f * slack, low)};
}

inline void look_at(const Search& s, const Frame& f, const EllipsoidBlock& b, unsigned groups,
                    Look& look) {
  const Rays& r = *f.rays;
  F8 m[3];
  for (int a = 0; a < 3; ++a) m[a] = (load8(b.mean[a]) - f.high[a]) - f.low[a];
  const F8 u00 = load8(b.u[0]), u01 = load8(b.u[1]), u02 = load8(b.u[2]);
  const F8 u11 = load8(b.u[3]), u12 = load8(b.u[4]), u22 = load8(b.u[5]);
  // The support along a direction n is |U⁻ᵀ n|.
  const F8 r0 = 1.0f / u00, r1 = 1.0f / u11, r2 = 1.0f / u22;
  const F8 away = root(muladd(m[0], m[0], muladd(m[1], m[1], m[2] * m[2]))) + r.spread;
  F8 from[3], to[3];
  for (int p = 0; p < 3; ++p) {
    const float* n = r.axis[p];
    const F8 w0 = n[0] * r0, w1 = (n[1] - u01 * w0) * r1, w2 = (n[2] - u02 * w0 - u12 * w1) * r2;
    const F8 support = root(muladd(w0, w0, muladd(w1, w1, w2 * w2)));
    const F8 at = muladd(m[0], all8(n[0]), muladd(m[1], all8(n[1]), m[2] * n[2]));
    const F8 half = muladd(support, all8(1.005f), away * 1e-6f);
    from[p] = at - half;
    to[p] = at + half;
  }
  outline(r, from, to, look.seen);
  look.pairs = pairs_of(r, s.found.reach, look.seen) & groups * kEachByte;
  // Bounds on the rounding: of the Mahalanobis distance, and per unit of range.
  const F8 size =
      absolute(u00) + absolute(u01) + absolute(u02) + absolute(u11) + absolute(u12) + absolute(u22);
  store(look.ellipsoid.slack, muladd(away, size * 6e-7f, all8(4e-4f)));
  store(look.ellipsoid.size, size * 1e-6f);
  for (int a = 0; a < 3; ++a) store(look.ellipsoid.mean[a], m[a]);
}

// What the packet meets of a block; true if something was found.
template <Ask kAsk>
inline bool visit(Search& s, const Frame& f, const EllipsoidBlock& b, uint32_t kind,
                  const Look& look) {
  const Rays& r = *f.rays;
  const auto& [mean, slack, size_of] = look.ellipsoid;
  M maybe[64];
  F met[64][4];
  uint8_t pair_of[64];
  int count = 0;
  bool any = false;
  for (uint64_t left = look.pairs; left; left &= left - 1) {
    const int pair = __builtin_ctzll(left), j = pair / 8, g = pair % 8;
    const float outer = 1 + slack[j];
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
    maybe[count] = le((c - outer * outer) * a, hh * 1.00001f);
    met[count][0] = a;
    met[count][1] = h;
    met[count][2] = c;
    met[count][3] = t0;
    pair_of[count] = uint8_t(pair);
    count += bits(maybe[count]) != 0;
  }
  for (int k = 0; k < count; ++k) {
    const int pair = pair_of[k], j = pair / 8, g = pair % 8;
    const float inner = slack[j] < 1 ? 1 - slack[j] : 0;
    const F a = met[k][0], h = met[k][1], c = met[k][2], t0 = met[k][3], hh = h * h;
    const F i = 1.0f / a, step = h * i, t = t0 + step, reach = root(i);
    const F error = reach * muladd(all(size_of[j]), absolute(step) + reach, all(slack[j])) +
                    (absolute(t0) + absolute(step)) * 6e-7f;
    const F low = t - error, high = t + error;
    M found = maybe[k] & le(all(f.t_min), high) &
              le(low, kAsk == Ask::kAll ? all(f.t_max) : s.found.high[g]);
    M sure = found;
    if (kAsk == Ask::kAccepted && kind == kPathLength) {
      const F m2 = c - hh * i,
              m2_error = muladd(hh * i, all(1e-5f), all(slack[j] * (2 + slack[j])));
      const Trial trial = path_length_trial(s, f, g, b.element[j], b.depth[j], reach,
                                            all(size_of[j]) * reach, m2, m2_error);
      found &= trial.maybe;
      sure &= trial.sure;
    } else if (kAsk == Ask::kAccepted) {
      found &= accepted(s, f, g, b.element[j], b.accept_below[j]);
      sure = kind == kCareful ? mask_of(0) : found;
    }
    if (!bits(found)) continue;
    if (kAsk == Ask::kAccepted) {
      sure &= le((c - inner * inner) * a, hh * 0.99999f) & le(high, s.found.low[g]) &
              le(all(f.t_min), low);
    }
    keep<kAsk>(s, f, g, b.element[j], found, sure, low, high);
    any = true;
  }
  return any;
}

inline void look_at(const Search& s, const Frame& f, const TriangleBlock& b, unsigned groups,
                    Look& look) {
  const Rays& r = *f.rays;
  F8 v[3], e1[3], e2[3];
  for (int a = 0; a < 3; ++a) {
    const F8 corner = load8(b.corner[0][a]);
    v[a] = (corner - f.high[a]) - f.low[a];
    e1[a] = load8(b.corner[1][a]) - corner;
    e2[a] = load8(b.corner[2][a]) - corner;
  }
  const F8 l1 = root(muladd(e1[0], e1[0], muladd(e1[1], e1[1], e1[2] * e1[2])));
  const F8 l2 = root(muladd(e2[0], e2[0], muladd(e2[1], e2[1], e2[2] * e2[2])));
  const F8 away = root(muladd(v[0], v[0], muladd(v[1], v[1], v[2] * v[2]))) + r.spread;
  F8 from[3], to[3];
  for (int p = 0; p < 3; ++p) {
    const float* n = r.axis[p];
    const F8 at = muladd(v[0], all8(n[0]), muladd(v[1], all8(n[1]), v[2] * n[2]));
    const F8 along1 = muladd(e1[0], all8(n[0]), muladd(e1[1], all8(n[1]), e1[2] * n[2]));
    const F8 along2 = muladd(e2[0], all8(n[0]), muladd(e2[1], all8(n[1]), e2[2] * n[2]));
    const F8 pad = (away + l1 + l2) * 1e-6f;
    from[p] = at + lesser(F8{}, lesser(along1, along2)) - pad;
    to[p] = at + greater(F8{}, greater(along1, along2)) + pad;
  }
  outline(r, from, to, look.seen);
  look.pairs = pairs_of(r, s.found.reach, look.seen) & groups * kEachByte;
  store(look.triangle.slack, (away + l1 + l2) * (l1 + l2) * 8e-7f);
  store(look.triangle.range_slack, (away + l1 + l2) * l1 * l2 * 1e-6f);
  for (int a = 0; a < 3; ++a) {
    store(look.triangle.corner[a], v[a]);
    store(look.triangle.side1[a], e1[a]);
    store(look.triangle.side2[a], e2[a]);
  }
}

template <Ask kAsk>
inline bool visit(Search& s, const Frame& f, const TriangleBlock& b, const Look& look) {
  const Rays& r = *f.rays;
  const auto& [corner, side1, side2, slack, range_slack] = look.triangle;
  M maybe[64];
  F met[64][3];
  uint8_t pair_of[64];
  int count = 0;
  bool any = false;
  for (uint64_t left = look.pairs; left; left &= left - 1) {
    const int pair = __builtin_ctzll(left), j = pair / 8, g = pair % 8;
    const F e1x = all(side1[0][j]), e1y = all(side1[1][j]), e1z = all(side1[2][j]);
    const F e2x = all(side2[0][j]), e2y = all(side2[1][j]), e2z = all(side2[2][j]);
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
    const F least_weight = lesser(x, lesser(y, det - x - y));
    maybe[count] = le(all(-3 * slack[j]), least_weight);
    const F t = flip(muladd(e2x, qx, muladd(e2y, qy, e2z * qz)), sign);
    met[count][0] = det;
    met[count][1] = t;
    met[count][2] = least_weight;
    pair_of[count] = uint8_t(pair);
    count += bits(maybe[count]) != 0;
  }
  for (int k = 0; k < count; ++k) {
    const int pair = pair_of[k], j = pair / 8, g = pair % 8;
    const F det = met[k][0], least_weight = met[k][2], doubtful = all(3 * slack[j]);
    const F i = 1.0f / greater(det, all(slack[j]));
    const F t = met[k][1] * i;
    const F error = muladd(all(range_slack[j]), i, absolute(t) * 6e-7f);
    const F low = t - error, high = t + error;
    const F limit = kAsk == Ask::kAll ? all(f.t_max) : s.found.high[g];
    M found = maybe[k] & (M(le(all(f.t_min), high) & le(low, limit)) | le(det, doubtful));
    if (kAsk == Ask::kAccepted) found &= accepted(s, f, g, b.element[j], b.accept_below[j]);
    if (!bits(found)) continue;
    M sure = found;
    if (kAsk != Ask::kAll) {
      sure = found & le(all(slack[j]), least_weight) & le(high, s.found.low[g]) &
             le(all(f.t_min), low);
    }
    keep<kAsk>(s, f, g, b.element[j], found, sure, low, high);
    any = true;
  }
  return any;
}

}  // namespace
}  // namespace underbrush::trace
