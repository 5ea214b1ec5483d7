// Included by kernel.inl: a packet's rays against the blocks of leaves. A frustum test of eight
// elements first; what is left meets the rays, kLanes at a time.
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
    const F8 w0 = n[0] * r0, w1 = (n[1] - u01 * w0) * r1, w2 = (n[2] - u02 * w0 - u12 * w1) * r2;
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

}  // namespace
}  // namespace underbrush::trace
