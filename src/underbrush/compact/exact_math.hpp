/// \file
/// Arithmetic whose results are the same bits on every machine: predictions that a reader repeats
/// must equal the writer's, so sines are not those of the system's library.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>

namespace underbrush::compact {

/// A sine and the cosine of the same angle.
struct SineCosine {
  double sine, cosine;
};

/// Returns sine and cosine of x (rad) to about 1e-15, for |x| < 1e5.
inline SineCosine sine_cosine(double x) {
  constexpr double kShift = 0x1.8p52;
  const double shifted = x * 0x1.45f306dc9c883p-1 + kShift;  // 2/π
  const double turns = shifted - kShift;
  const double r =
      (x - turns * 0x1.921fb544p0) - turns * 0x1.0b4611a626331p-34;  // π/2 in two parts
  const double q = r * r;
  // Taylor's series up to |r| = π/4.
  const double sine =
      r + r * q *
              (-1.0 / 6 +
               q * (1.0 / 120 + q * (-1.0 / 5040 +
                                     q * (1.0 / 362880 + q * (-1.0 / 39916800 +
                                                              q * (1.0 / 6227020800 +
                                                                   q * (-1.0 / 1307674368000)))))));
  const double cosine =
      1 - q * 0.5 +
      q * q *
          (1.0 / 24 +
           q * (-1.0 / 720 +
                q * (1.0 / 40320 + q * (-1.0 / 3628800 + q * (1.0 / 479001600 +
                                                              q * (-1.0 / 87178291200 +
                                                                   q * (1.0 / 20922789888000)))))));
  const uint64_t quadrant = std::bit_cast<uint64_t>(shifted) & 3;
  const double a = quadrant & 1 ? cosine : sine, b = quadrant & 1 ? sine : cosine;
  return {quadrant & 2 ? -a : a, (quadrant + 1) & 2 ? -b : b};
}

/// Numbers whose order is that of the floating-point values with these bits.
inline uint32_t ordered(float x) {
  const auto bits = std::bit_cast<uint32_t>(x);
  return bits ^ (uint32_t(int32_t(bits) >> 31) | 0x80000000u);
}
/// The overload for double precision.
inline uint64_t ordered(double x) {
  const auto bits = std::bit_cast<uint64_t>(x);
  return bits ^ (uint64_t(int64_t(bits) >> 63) | 0x8000000000000000ull);
}
/// The value of such a number.
inline float from_ordered(uint32_t n) {
  return std::bit_cast<float>(n ^ (((n >> 31) - 1) | 0x80000000u));
}
/// The overload for double precision.
inline double from_ordered(uint64_t n) {
  return std::bit_cast<double>(n ^ (((n >> 63) - 1) | 0x8000000000000000ull));
}

}  // namespace underbrush::compact
