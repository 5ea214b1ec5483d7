#include "underbrush/likelihood/pass_kernel.inl"

namespace underbrush::likelihood {

const PassKernels kPassBase{approach, add};

const PassKernels& pass_kernels() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    return kPassAvx512;
  }
  if (__builtin_cpu_supports("avx2")) return kPassAvx2;
#endif
  return kPassBase;
}

}  // namespace underbrush::likelihood
