#define UB_KERNELS kKernelsAvx2
#define UB_KERNELS_NAME "avx2"
#include "underbrush/trace/kernel.inl"
