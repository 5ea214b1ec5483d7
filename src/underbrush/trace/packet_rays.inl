// Included by kernel.inl: 64 rays as columns, the frustum around them, their change of frame.
namespace underbrush::trace {
namespace {

// The rays in one frame, relative to a common centre.
struct alignas(64) Rays {
  F d[3][kGroups], o[3][kGroups], inverse[3][kGroups];
  F start[3][kGroups];  // −o·inverse
  double centre[3];
  float plane[5][3];  // outward normals of the frustum's sides, then its axis
  float side[4];      // a point p is outside of side i where plane[i]·p > side[i]
  float depth,
      behind;    // along the axis: a point is reached from `depth` on; nothing before `behind`
  float spread;  // greatest |o|
  bool mixed;    // signs of the directions differ
  bool negative[3];
};

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
  const float h =
      1 / __builtin_sqrtf(axis[1] * axis[1] + (steep ? axis[2] * axis[2] : axis[0] * axis[0]));
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

// The rays in the frame of a rotated or scaled instance.
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

}  // namespace
}  // namespace underbrush::trace
