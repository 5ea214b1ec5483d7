// Vectors of eight numbers. Each source file that uses this one has its own copies, for its
// instruction sets. All give the same bits: there is no fused multiplication and no approximate
// operation. Roots become vectors only with -fno-math-errno and -fno-trapping-math.
#pragma once
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#define UNDERBRUSH_INLINE inline __attribute__((always_inline))

namespace underbrush {
namespace {

constexpr size_t kLanes = 8;
typedef float F __attribute__((vector_size(4 * kLanes)));
typedef int32_t I __attribute__((vector_size(4 * kLanes)));
typedef double D __attribute__((vector_size(8 * kLanes)));
typedef int64_t L __attribute__((vector_size(8 * kLanes)));

UNDERBRUSH_INLINE F all(float x) { return F{x, x, x, x, x, x, x, x}; }
UNDERBRUSH_INLINE F pick(I mask, F yes, F no) { return (F)((mask & (I)yes) | (~mask & (I)no)); }
UNDERBRUSH_INLINE I pick(I mask, I yes, I no) { return (mask & yes) | (~mask & no); }
UNDERBRUSH_INLINE F lesser(F a, F b) { return pick(a < b, a, b); }
UNDERBRUSH_INLINE F greater(F a, F b) { return pick(a > b, a, b); }

UNDERBRUSH_INLINE F load(const float* from) {
  F f;
  __builtin_memcpy(&f, from, sizeof f);
  return f;
}
UNDERBRUSH_INLINE void store(float* to, F x) { __builtin_memcpy(to, &x, sizeof x); }

UNDERBRUSH_INLINE F root(F a) {
  F r;
  for (size_t k = 0; k < kLanes; ++k) r[k] = __builtin_sqrtf(a[k]);
  return r;
}

// Computes eˣ for x ≤ 0 with a relative error of about 1e-6.
UNDERBRUSH_INLINE F exp_below_zero(F x) {
  x = greater(x, all(-80));
  const F rounded = x * 1.44269504f + 12582912.0f, k = rounded - 12582912.0f;
  const F r = (x - k * 0.693359375f) + k * 2.12194440e-4f;
  F series = all(1.0f / 720);
  for (const float term : {1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) {
    series = series * r + term;
  }
  return (F)((I)series + ((I)rounded << 23));
}

}  // namespace
}  // namespace underbrush
