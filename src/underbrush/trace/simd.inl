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
inline F8 all8(float x) { return F8{x, x, x, x, x, x, x, x}; }
inline I8 every8() {
  const I8 none{};
  return none - 1;
}
inline F8 absolute(F8 a) { return (F8)((I8)a & 0x7fffffff); }

#if defined(__AVX2__)
inline F8 lesser(F8 a, F8 b) { return _mm256_min_ps(a, b); }
inline F8 greater(F8 a, F8 b) { return _mm256_max_ps(a, b); }
inline F8 muladd(F8 a, F8 b, F8 c) { return _mm256_fmadd_ps(a, b, c); }
inline F8 minus_product(F8 c, F8 a, F8 b) { return _mm256_fnmadd_ps(a, b, c); }
inline F8 root(F8 a) { return _mm256_sqrt_ps(a); }
inline unsigned bits(I8 mask) { return unsigned(_mm256_movemask_ps((__m256)mask)); }
#else
inline F8 lesser(F8 a, F8 b) { return a < b ? a : b; }
inline F8 greater(F8 a, F8 b) { return a > b ? a : b; }
inline F8 muladd(F8 a, F8 b, F8 c) { return a * b + c; }
inline F8 minus_product(F8 c, F8 a, F8 b) { return c - a * b; }
inline F8 root(F8 a) {
  F8 r;
  for (int k = 0; k < 8; k += 4) {
    _mm_storeu_ps((float*)&r + k, _mm_sqrt_ps(_mm_loadu_ps((const float*)&a + k)));
  }
  return r;
}
inline unsigned bits(I8 mask) {
  const __m128 low = _mm_loadu_ps(reinterpret_cast<const float*>(&mask));
  const __m128 high = _mm_loadu_ps(reinterpret_cast<const float*>(&mask) + 4);
  return unsigned(_mm_movemask_ps(low) | _mm_movemask_ps(high) << 4);
}
#endif

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
inline M le(F a, F b) { return a <= b; }
#if defined(__AVX2__)
inline M below(U a, U b) {
  return ~(M)(U)_mm256_cmpeq_epi32(_mm256_max_epu32((__m256i)a, (__m256i)b), (__m256i)a);
}
#else
inline M below(U a, U b) { return (M)(a < b); }
#endif
inline M equal(U a, U b) { return (M)(a == b); }
inline M mask_of(unsigned lanes) {
  const I8 bit{1, 2, 4, 8, 16, 32, 64, 128};
  return (bit & int32_t(lanes)) != 0;
}
inline F pick(M m, F yes, F no) { return m ? yes : no; }
inline U pick(M m, U yes, U no) { return m ? yes : no; }
inline F all(float x) { return all8(x); }
inline U all(uint32_t x) { return U{x, x, x, x, x, x, x, x}; }
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

// Reduces eight values to one by `pick(a, b)`.
template <class Pick>
inline float of_lanes(F8 v, Pick pick) {
  v = pick(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
  v = pick(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5));
  return pick(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6))[0];
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
    a[k] = __builtin_shufflevector(x[k], x[k + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    a[k + 1] = __builtin_shufflevector(x[k], x[k + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (int k = 0; k < 8; k += 4) {
    for (int j = 0; j < 2; ++j) {
      b[k + 2 * j] = __builtin_shufflevector(a[k + j], a[k + 2 + j], 0, 1, 8, 9, 4, 5, 12, 13);
      b[k + 2 * j + 1] =
          __builtin_shufflevector(a[k + j], a[k + 2 + j], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (int k = 0; k < 4; ++k) {
    x[k] = __builtin_shufflevector(b[k], b[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    x[k + 4] = __builtin_shufflevector(b[k], b[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
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
  F8 two[4];
  for (int k = 0; k < 4; ++k) {
    const F8 a = each[2 * k], b = each[2 * k + 1];
    two[k] = pick(__builtin_shufflevector(a, b, 0, 2, 8, 10, 4, 6, 12, 14),
                  __builtin_shufflevector(a, b, 1, 3, 9, 11, 5, 7, 13, 15));
  }
  F8 four[2];
  for (int k = 0; k < 2; ++k) {
    const F8 a = two[2 * k], b = two[2 * k + 1];
    four[k] = pick(__builtin_shufflevector(a, b, 0, 2, 8, 10, 4, 6, 12, 14),
                   __builtin_shufflevector(a, b, 1, 3, 9, 11, 5, 7, 13, 15));
  }
  return pick(__builtin_shufflevector(four[0], four[1], 0, 1, 2, 3, 8, 9, 10, 11),
              __builtin_shufflevector(four[0], four[1], 4, 5, 6, 7, 12, 13, 14, 15));
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
