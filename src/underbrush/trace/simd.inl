// Vectors of floats for one instruction set. `F` holds kLanes rays, and `F8` the eight children of
// a node or the eight elements of a block. kernel_*.cpp use this file.
#pragma once
#include <immintrin.h>

#include <cmath>
#include <cstdint>

#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/order.hpp"

namespace underbrush::trace {
namespace {

#if defined(__AVX512F__)
constexpr int kLanes = 16;
#else
constexpr int kLanes = 8;
#endif
constexpr int kPacket = int(kPacketRays);
constexpr int kGroups = kPacket / kLanes;
constexpr int kSets = kGroups / 8;  // sets of eight groups
constexpr unsigned kEveryLane = (1u << kLanes) - 1;
constexpr unsigned kEveryGroup = (1u << kGroups) - 1;

typedef float F8 __attribute__((vector_size(32), may_alias));
typedef int32_t I8 __attribute__((vector_size(32), may_alias));
typedef uint32_t U8 __attribute__((vector_size(32), may_alias));
typedef float F __attribute__((vector_size(4 * kLanes), may_alias));
typedef int32_t I __attribute__((vector_size(4 * kLanes), may_alias));
typedef uint32_t U __attribute__((vector_size(4 * kLanes), may_alias));

inline F8 load8(const float* p) { return *reinterpret_cast<const F8*>(p); }
inline F8 absolute(F8 a) { return (F8)((I8)a & 0x7fffffff); }

#if defined(__AVX2__)
inline F8 all8(float x) { return _mm256_set1_ps(x); }
inline U8 all8(uint32_t x) { return (U8)_mm256_set1_epi32(int(x)); }
inline F8 lesser(F8 a, F8 b) { return _mm256_min_ps(a, b); }
inline F8 greater(F8 a, F8 b) { return _mm256_max_ps(a, b); }
inline F8 muladd(F8 a, F8 b, F8 c) { return _mm256_fmadd_ps(a, b, c); }
inline F8 minus_product(F8 c, F8 a, F8 b) { return _mm256_fnmadd_ps(a, b, c); }
inline F8 root(F8 a) { return _mm256_sqrt_ps(a); }
inline I8 le(F8 a, F8 b) { return a <= b; }
inline I8 equal(U8 a, U8 b) { return (I8)(a == b); }
inline I8 below(U8 a, U8 b) {
  return ~(I8)_mm256_cmpeq_epi32(_mm256_max_epu32((__m256i)a, (__m256i)b), (__m256i)a);
}
inline F8 pick(I8 m, F8 yes, F8 no) { return m ? yes : no; }
inline unsigned bits(I8 mask) { return unsigned(_mm256_movemask_ps((__m256)mask)); }
#else
// GCC 12 would take the lanes one after the other.
struct Halves {
  __m128 low, high;
};
inline F8 all8(float x) { return __builtin_bit_cast(F8, Halves{_mm_set1_ps(x), _mm_set1_ps(x)}); }
inline U8 all8(uint32_t x) {
  const __m128 of = (__m128)_mm_set1_epi32(int(x));
  return __builtin_bit_cast(U8, Halves{of, of});
}
template <class Op>
inline F8 by_halves(F8 a, F8 b, Op op) {
  const Halves x = __builtin_bit_cast(Halves, a), y = __builtin_bit_cast(Halves, b);
  return __builtin_bit_cast(F8, Halves{op(x.low, y.low), op(x.high, y.high)});
}
inline F8 lesser(F8 a, F8 b) {
  return by_halves(a, b, [](__m128 x, __m128 y) { return _mm_min_ps(x, y); });
}
inline F8 greater(F8 a, F8 b) {
  return by_halves(a, b, [](__m128 x, __m128 y) { return _mm_max_ps(x, y); });
}
inline F8 muladd(F8 a, F8 b, F8 c) { return a * b + c; }
inline F8 minus_product(F8 c, F8 a, F8 b) { return c - a * b; }
inline F8 root(F8 a) {
  return by_halves(a, a, [](__m128 x, __m128) { return _mm_sqrt_ps(x); });
}
inline I8 le(F8 a, F8 b) {
  return (I8)by_halves(a, b, [](__m128 x, __m128 y) { return _mm_cmple_ps(x, y); });
}
inline I8 equal(U8 a, U8 b) {
  return (I8)by_halves((F8)a, (F8)b, [](__m128 x, __m128 y) {
    return (__m128)_mm_cmpeq_epi32((__m128i)x, (__m128i)y);
  });
}
inline I8 below(U8 a, U8 b) {
  return (I8)by_halves((F8)(a ^ 0x80000000u), (F8)(b ^ 0x80000000u), [](__m128 x, __m128 y) {
    return (__m128)_mm_cmplt_epi32((__m128i)x, (__m128i)y);
  });
}
inline F8 pick(I8 m, F8 yes, F8 no) { return (F8)(((I8)yes & m) | ((I8)no & ~m)); }
inline unsigned bits(I8 mask) {
  const Halves of = __builtin_bit_cast(Halves, mask);
  return unsigned(_mm_movemask_ps(of.low) | _mm_movemask_ps(of.high) << 4);
}
#endif
// The lanes of a block without an element.
inline I8 no_element(const uint32_t element[8]) {
  const U8 zero{};
  return equal(*reinterpret_cast<const U8*>(element), ~zero);
}

#if defined(__AVX512F__)
typedef __mmask16 M;
inline M le(F a, F b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
inline M below(U a, U b) { return _mm512_cmplt_epu32_mask((__m512i)a, (__m512i)b); }
inline unsigned bits(M m) { return m; }
inline M equal(U a, U b) { return _mm512_cmpeq_epu32_mask((__m512i)a, (__m512i)b); }
inline M mask_of(unsigned lanes) { return M(lanes); }
inline F pick(M m, F yes, F no) { return _mm512_mask_blend_ps(m, no, yes); }
inline U pick(M m, U yes, U no) { return (U)_mm512_mask_blend_epi32(m, (__m512i)no, (__m512i)yes); }
inline F muladd(F a, F b, F c) { return _mm512_fmadd_ps(a, b, c); }
inline F minus_product(F c, F a, F b) { return _mm512_fnmadd_ps(a, b, c); }
inline F lesser(F a, F b) { return _mm512_min_ps(a, b); }
inline F greater(F a, F b) { return _mm512_max_ps(a, b); }
inline F root(F a) { return _mm512_sqrt_ps(a); }
inline F absolute(F a) { return (F)((I)a & 0x7fffffff); }
inline F all(float x) { return _mm512_set1_ps(x); }
inline U all(uint32_t x) { return (U)_mm512_set1_epi32(int(x)); }
#else
typedef I8 M;
inline M mask_of(unsigned lanes) {
  const U bit{1, 2, 4, 8, 16, 32, 64, 128};
  return equal(bit & all8(uint32_t(lanes)), bit);
}
inline U pick(M m, U yes, U no) { return (U)pick(m, (F)yes, (F)no); }
inline F all(float x) { return all8(x); }
inline U all(uint32_t x) { return all8(x); }
#endif

inline F sign_of(F a) { return (F)((U)a & 0x80000000u); }
inline F flip(F a, F sign) { return (F)((U)a ^ (U)sign); }

// Rounds down; |a| < 2³¹.
inline F floor_of(F a) {
#if defined(__AVX512F__)
  return _mm512_floor_ps(a);
#elif defined(__AVX2__)
  return _mm256_floor_ps(a);
#else
  const F whole = __builtin_convertvector(__builtin_convertvector(a, I), F);
  return pick(le(whole, a), whole, whole - 1.0f);
#endif
}

// Computes eˣ for x ≤ 0 with a relative error of about 1e-6.
inline F exp_below_zero(F x) {
  x = greater(x, all(-80.0f));
  const F rounded = muladd(x, all(1.44269504f), all(12582912.0f)), k = rounded - 12582912.0f;
  const F r = muladd(k, all(2.12194440e-4f), muladd(k, all(-0.693359375f), x));
  F series = all(1.0f / 720);
  for (const float term : {1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) {
    series = muladd(series, r, all(term));
  }
  return (F)((U)series + ((U)rounded << 23));
}

// Takes lanes i, j, k and l of each half, of which 0 to 3 are those of `a` and 4 to 7 those of `b`.
template <int i, int j, int k, int l>
inline F8 lanes_of_halves(F8 a, F8 b) {
#if defined(__AVX2__)
  constexpr auto at = [](int lane, int half) { return lane % 4 + lane / 4 * 8 + 4 * half; };
  return __builtin_shufflevector(a, b, at(i, 0), at(j, 0), at(k, 0), at(l, 0), at(i, 1), at(j, 1),
                                 at(k, 1), at(l, 1));
#else
  return by_halves(a, b,
                   [](__m128 x, __m128 y) { return __builtin_shufflevector(x, y, i, j, k, l); });
#endif
}
// The lower halves of two vectors, and the upper ones.
inline F8 lower_halves(F8 a, F8 b) {
#if defined(__AVX2__)
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
#else
  return __builtin_bit_cast(
      F8, Halves{__builtin_bit_cast(Halves, a).low, __builtin_bit_cast(Halves, b).low});
#endif
}
inline F8 upper_halves(F8 a, F8 b) {
#if defined(__AVX2__)
  return __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
#else
  return __builtin_bit_cast(
      F8, Halves{__builtin_bit_cast(Halves, a).high, __builtin_bit_cast(Halves, b).high});
#endif
}

// Reduces eight values to one by `pick(a, b)`.
template <class Pick>
inline float of_lanes(F8 v, Pick pick) {
  v = pick(v, upper_halves(v, v));
  v = pick(v, lanes_of_halves<2, 3, 0, 1>(v, v));
  return pick(v, lanes_of_halves<1, 0, 3, 2>(v, v))[0];
}
inline float greatest(F8 v) {
  return of_lanes(v, [](F8 a, F8 b) { return greater(a, b); });
}
inline float least(F8 v) {
  return of_lanes(v, [](F8 a, F8 b) { return lesser(a, b); });
}
#if defined(__AVX512F__)
inline F8 lower_half(F v) { return _mm512_castps512_ps256(v); }
inline F8 upper_half(F v) {
  return _mm256_castpd_ps(_mm512_extractf64x4_pd(_mm512_castps_pd(v), 1));
}
inline float greatest(F v) { return greatest(greater(lower_half(v), upper_half(v))); }
inline float least(F v) { return least(lesser(lower_half(v), upper_half(v))); }
#endif

// Transposes rows to columns.
inline void transpose(F8 x[8]) {
  F8 a[8], b[8];
  for (int k = 0; k < 8; k += 2) {
    a[k] = lanes_of_halves<0, 4, 1, 5>(x[k], x[k + 1]);
    a[k + 1] = lanes_of_halves<2, 6, 3, 7>(x[k], x[k + 1]);
  }
  for (int k = 0; k < 8; k += 4) {
    for (int j = 0; j < 2; ++j) {
      b[k + 2 * j] = lanes_of_halves<0, 1, 4, 5>(a[k + j], a[k + 2 + j]);
      b[k + 2 * j + 1] = lanes_of_halves<2, 3, 6, 7>(a[k + j], a[k + 2 + j]);
    }
  }
  for (int k = 0; k < 4; ++k) {
    x[k] = lower_halves(b[k], b[k + 4]);
    x[k + 4] = upper_halves(b[k], b[k + 4]);
  }
}

// Reduces the values of each of eight groups to one by `pick(a, b)`.
template <class Pick>
inline F8 of_groups(const F v[8], Pick pick) {
  F8 each[8];
  for (int g = 0; g < 8; ++g) {
    const float* from = reinterpret_cast<const float*>(v + g);
    each[g] = kLanes == 16 ? pick(load8(from), load8(from + kLanes - 8)) : load8(from);
  }
  const auto of_pairs = [&](F8 a, F8 b) {
    return pick(lanes_of_halves<0, 2, 4, 6>(a, b), lanes_of_halves<1, 3, 5, 7>(a, b));
  };
  F8 four[2];
  for (int k = 0; k < 2; ++k) {
    const F8* from = each + 4 * k;
    four[k] = of_pairs(of_pairs(from[0], from[1]), of_pairs(from[2], from[3]));
  }
  return pick(lower_halves(four[0], four[1]), upper_halves(four[0], four[1]));
}
inline F8 least_of_groups(const F v[8]) {
  return of_groups(v, [](F8 a, F8 b) { return lesser(a, b); });
}
inline F8 greatest_of_groups(const F v[8]) {
  return of_groups(v, [](F8 a, F8 b) { return greater(a, b); });
}

inline U cell_factor(int axis) { return *reinterpret_cast<const U*>(kHashFactors.cell[axis]); }

// Computes the hash `accept_bits` of core/rng.hpp.
template <class V>
inline V accept_hash(V element, V key_low, V key_high) {
  const auto factor = [](int k) { return *reinterpret_cast<const V*>(kHashFactors.trial[k]); };
  V x = element ^ key_low;
  x = (x ^ (x >> 16)) * factor(0);
  x = ((x ^ (x >> 15)) + key_high) * factor(1);
  x = (x ^ (x >> 16)) * factor(2);
  return x ^ (x >> 15);
}

}  // namespace
}  // namespace underbrush::trace
