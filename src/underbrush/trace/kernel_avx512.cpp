#define UB_KERNELS kKernelsAvx512
#define UB_KERNELS_NAME "avx512"
#include "underbrush/trace/kernel.inl"
