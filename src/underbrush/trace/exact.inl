// The arithmetic of the ray model, for one ray (D = double) or for several at once (D a vector of
// doubles). Both do the same operations in the same order and so give the same bits, as long as the
// compiler does not contract them. element_math.cpp and kernel_table.inl include this file.
#pragma once
#include <cstdint>

namespace underbrush::trace {
namespace {

/// The closest approach by [deschaud12] eq. 1–3. `s` is Σ (xx xy xz yy yz zz).
template <class D>
struct Approach {
  D t, sigma2, delta2;
};

template <class D>
inline D dot(const D a[3], const D b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class D>
inline Approach<D> approach_of(const D o[3], const D d[3], const D mean[3], const D s[6]) {
  // The cofactors give Σ⁻¹ up to the factor 1/det.
  const D i00 = s[3] * s[5] - s[4] * s[4], i01 = s[2] * s[4] - s[1] * s[5],
          i02 = s[1] * s[4] - s[2] * s[3];
  const D i11 = s[0] * s[5] - s[2] * s[2], i12 = s[1] * s[2] - s[0] * s[4],
          i22 = s[0] * s[3] - s[1] * s[1];
  const D det = s[0] * i00 + s[1] * i01 + s[2] * i02;
  // Positions are relative to the foot point of the mean on the ray, so that far means lose no
  // digits.
  const D to_mean[3] = {mean[0] - o[0], mean[1] - o[1], mean[2] - o[2]};
  const D t0 = dot(to_mean, d);
  const D q[3] = {to_mean[0] - t0 * d[0], to_mean[1] - t0 * d[1], to_mean[2] - t0 * d[2]};
  const D dw[3] = {i00 * d[0] + i01 * d[1] + i02 * d[2], i01 * d[0] + i11 * d[1] + i12 * d[2],
                   i02 * d[0] + i12 * d[1] + i22 * d[2]};
  const D dd = dot(dw, d), step = dot(dw, q) / dd;
  const D r[3] = {q[0] - step * d[0], q[1] - step * d[1], q[2] - step * d[2]};
  const D rw[3] = {i00 * r[0] + i01 * r[1] + i02 * r[2], i01 * r[0] + i11 * r[1] + i12 * r[2],
                   i02 * r[0] + i12 * r[1] + i22 * r[2]};
  return {t0 + step, det / dd, dot(rw, r) / det};
}

/// Computes eˣ = power · (1 + rest) for x ≤ 0 to about 1e-16: x = k ln 2 + r, power = 2ᵏ, and rest
/// = eʳ − 1 by its series.
template <class D>
struct Exponential {
  D power, rest;

  explicit Exponential(D x) {
    typedef int64_t L __attribute__((vector_size(sizeof(D))));
    constexpr double kRound = 6755399441055744.0;  // adding it rounds to an integer in the low bits
    x = x < -700.0 ? D{} - 700.0 : x;
    const D rounded = x * 1.4426950408889634 + kRound, k = rounded - kRound;
    const D r = (x - k * 0.69314718036912382) - k * 1.9082149292705877e-10;
    D series = r * (1.0 / 6227020800.0) + 1.0 / 479001600.0;
    for (const double term :
         {1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0,
          1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0}) {
      series = series * r + term;
    }
    power = __builtin_bit_cast(D, (__builtin_bit_cast(L, rounded) + 1023) << 52);
    rest = series * r;
  }
  D value() const { return power + power * rest; }
  D less_one() const { return power * rest + (power - 1.0); }
};

/// Computes p = 1 − exp(−κ √(2π) σ e^{−δ²/2}), where κ is elements::Ellipsoid::density_per_m times
/// 2 G of the leaf angles for the ray's direction.
template <class D>
inline D opacity_of(const D& density, const D& sigma, const D& delta2) {
  const D depth = 2.5066282746310002 * sigma * Exponential<D>(-0.5 * delta2).value();
  return -Exponential<D>(-density * depth).less_one();
}

/// A triangle in the sheared frame of a ray, in which the ray runs along the third axis through the
/// origin (Woop, Benthin & Wald 2013). The third axis is that of the direction's largest component,
/// and x and y follow it in cyclic order. A vertex has the same place there in all triangles that
/// share it.
template <class D>
struct Sheared {
  D x[3], y[3];
};

/// Computes the sheared triangle. `d`, `o` and `corner[v]` have their components in the order x, y,
/// z of the sheared frame.
template <class D>
inline Sheared<D> shear(const D o[3], const D d[3], const D corner[3][3]) {
  const D inverse = 1.0 / d[2], sx = d[0] * inverse, sy = d[1] * inverse;
  Sheared<D> s;
  for (int v = 0; v < 3; ++v) {
    const D z = corner[v][2] - o[2];
    s.x[v] = corner[v][0] - o[0] - sx * z;
    s.y[v] = corner[v][1] - o[1] - sy * z;
  }
  return s;
}

/// Computes the normal (b − a) × (c − a) of a triangle, whose length is twice the area.
template <class D>
inline void normal_of(const D a[3], const D b[3], const D c[3], D normal[3]) {
  const D u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const D v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    normal[k] = u[i] * v[j] - u[j] * v[i];
  }
}

/// Computes the range t at which a ray meets the plane through `corner`: n·(o + t d − corner) = 0.
/// `along` is n·d.
template <class D>
inline D range_to_plane(const D o[3], const D corner[3], const D normal[3], const D& along) {
  const D to_corner[3] = {corner[0] - o[0], corner[1] - o[1], corner[2] - o[2]};
  return dot(normal, to_corner) / along;
}

/// Computes σ² of the range at a rough triangle: σ² = σ_range² + h² / cos²θ, with |cos θ| at least
/// 0.01. `along` is n·d.
template <class D>
inline D rough_sigma2(const D& sigma, const D& roughness, const D normal[3], const D& along) {
  const D area2 = dot(normal, normal), cos2 = along * along, least = 1e-4 * area2;
  return sigma * sigma + roughness * roughness * area2 / (cos2 > least ? cos2 : least);
}

}  // namespace
}  // namespace underbrush::trace
