// Vectors of eight numbers. pass_kernel_*.cpp use this file, each for one instruction set.
#pragma once
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace underbrush::fit {
namespace {

constexpr size_t kLanes = 8;
typedef float F __attribute__((vector_size(32)));
typedef int32_t I __attribute__((vector_size(32)));
typedef double D __attribute__((vector_size(64)));
typedef int64_t L __attribute__((vector_size(64)));

inline F all(float x) { return F{x, x, x, x, x, x, x, x}; }
inline F pick(I mask, F yes, F no) { return (F)((mask & (I)yes) | (~mask & (I)no)); }

inline F root(F a) {
#if defined(__AVX2__)
  return (F)_mm256_sqrt_ps((__m256)a);
#elif defined(__SSE2__)
  __m128 half[2];
  __builtin_memcpy(half, &a, sizeof a);
  for (__m128& h : half) h = _mm_sqrt_ps(h);
  F r;
  __builtin_memcpy(&r, half, sizeof r);
  return r;
#else
  F r;
  for (size_t k = 0; k < kLanes; ++k) r[k] = __builtin_sqrtf(a[k]);
  return r;
#endif
}

// Computes eˣ for x ≤ 0 with a relative error of about 1e-6.
inline F exp_below_zero(F x) {
  x = pick(x > all(-80.0f), x, all(-80.0f));
  const F rounded = x * 1.44269504f + 12582912.0f, k = rounded - 12582912.0f;
  const F r = (x - k * 0.693359375f) + k * 2.12194440e-4f;
  F series = all(1.0f / 720);
  for (const float term : {1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) {
    series = series * r + term;
  }
  return (F)((I)series + ((I)rounded << 23));
}

// 1 − e^{−a}, without cancellation.
inline F opacity(F depth, F through) {
  const F series = depth * (1.0f - depth * (0.5f - depth * (1.0f / 6)));
  return pick(depth < all(0.02f), series, 1.0f - through);
}

inline F load(const float* from) {
  F f;
  __builtin_memcpy(&f, from, sizeof f);
  return f;
}

inline void store(float* to, F x) { __builtin_memcpy(to, &x, sizeof x); }

// Transposes eight rows of eight numbers.
inline void transpose(L x[8]) {
  L a[8], b[8];
  for (int k = 0; k < 8; k += 2) {
    a[k] = __builtin_shufflevector(x[k], x[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    a[k + 1] = __builtin_shufflevector(x[k], x[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int k = 0; k < 8; k += 4) {
    for (int j = 0; j < 2; ++j) {
      b[k + j] = __builtin_shufflevector(a[k + j], a[k + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      b[k + j + 2] = __builtin_shufflevector(a[k + j], a[k + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (int j = 0; j < 4; ++j) {
    x[j] = __builtin_shufflevector(b[j], b[j + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    x[j + 4] = __builtin_shufflevector(b[j], b[j + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

}  // namespace
}  // namespace underbrush::fit
