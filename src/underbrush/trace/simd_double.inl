// Vectors of four doubles for one instruction set. kernel_*.cpp use this file.
#pragma once
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

namespace underbrush::trace {
namespace {

constexpr size_t kFour = 4;
typedef double D __attribute__((vector_size(32)));
typedef int64_t L __attribute__((vector_size(32)));
typedef double D2 __attribute__((vector_size(16), aligned(8), may_alias));
typedef double D4 __attribute__((vector_size(32), aligned(8), may_alias));
typedef float F4 __attribute__((vector_size(16), aligned(4), may_alias));

inline D absolute(D a) { return (D)((L)a & 0x7fffffffffffffff); }

#if defined(__AVX2__)
inline D joined(__m128d low, __m128d high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3);
}
inline D every(double a) { return _mm256_set1_pd(a); }
// GCC 12 would convert the halves by way of memory.
inline D to_double(F4 a) { return _mm256_cvtps_pd(a); }
inline F4 to_float(D a) { return _mm256_cvtpd_ps(a); }
inline D square_root(D a) { return _mm256_sqrt_pd(a); }
inline L le(D a, D b) { return a <= b; }
inline L less(D a, D b) { return a < b; }
inline D pick(L mask, D yes, D no) { return mask ? yes : no; }
inline unsigned bits(L mask) { return unsigned(_mm256_movemask_pd((__m256d)mask)); }
// The first lanes of the halves of a and b by turns, and the second ones.
inline D first_lanes(D a, D b) { return _mm256_unpacklo_pd(a, b); }
inline D second_lanes(D a, D b) { return _mm256_unpackhi_pd(a, b); }
inline D lower_halves(D a, D b) { return __builtin_shufflevector(a, b, 0, 1, 4, 5); }
inline D upper_halves(D a, D b) { return __builtin_shufflevector(a, b, 2, 3, 6, 7); }
#else
// GCC 12 would take the lanes one after the other.
struct DoubleHalves {
  __m128d low, high;
};
inline DoubleHalves halves_of(D a) { return __builtin_bit_cast(DoubleHalves, a); }
inline D joined(__m128d low, __m128d high) {
  return __builtin_bit_cast(D, DoubleHalves{low, high});
}
template <class Op>
inline D by_halves(D a, D b, Op op) {
  const DoubleHalves x = halves_of(a), y = halves_of(b);
  return joined(op(x.low, y.low), op(x.high, y.high));
}
inline D every(double a) { return joined(_mm_set1_pd(a), _mm_set1_pd(a)); }
inline D to_double(F4 a) { return joined(_mm_cvtps_pd(a), _mm_cvtps_pd(_mm_movehl_ps(a, a))); }
inline F4 to_float(D a) {
  return _mm_movelh_ps(_mm_cvtpd_ps(halves_of(a).low), _mm_cvtpd_ps(halves_of(a).high));
}
inline D square_root(D a) {
  return by_halves(a, a, [](__m128d x, __m128d) { return _mm_sqrt_pd(x); });
}
inline L le(D a, D b) {
  return (L)by_halves(a, b, [](__m128d x, __m128d y) { return _mm_cmple_pd(x, y); });
}
inline L less(D a, D b) {
  return (L)by_halves(a, b, [](__m128d x, __m128d y) { return _mm_cmplt_pd(x, y); });
}
inline D pick(L mask, D yes, D no) { return (D)(((L)yes & mask) | ((L)no & ~mask)); }
inline unsigned bits(L mask) {
  const DoubleHalves of = halves_of((D)mask);
  return unsigned(_mm_movemask_pd(of.low) | _mm_movemask_pd(of.high) << 2);
}
inline D first_lanes(D a, D b) {
  return by_halves(a, b, [](__m128d x, __m128d y) { return _mm_unpacklo_pd(x, y); });
}
inline D second_lanes(D a, D b) {
  return by_halves(a, b, [](__m128d x, __m128d y) { return _mm_unpackhi_pd(x, y); });
}
inline D lower_halves(D a, D b) { return joined(halves_of(a).low, halves_of(b).low); }
inline D upper_halves(D a, D b) { return joined(halves_of(a).high, halves_of(b).high); }
#endif

// Transposes rows to columns or columns to rows.
inline void transpose(D x[4]) {
  const D a = first_lanes(x[0], x[1]), b = second_lanes(x[0], x[1]);
  const D c = first_lanes(x[2], x[3]), d = second_lanes(x[2], x[3]);
  x[0] = lower_halves(a, c);
  x[1] = lower_halves(b, d);
  x[2] = upper_halves(a, c);
  x[3] = upper_halves(b, d);
}

}  // namespace
}  // namespace underbrush::trace
