#define UB_KERNELS kKernelsBase
#define UB_KERNELS_NAME "sse2"
#include "underbrush/trace/kernel.inl"
