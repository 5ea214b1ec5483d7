#include "underbrush/trace/kernel_table.inl"

namespace underbrush::trace {

constinit const Kernels kKernelsAvx2 = kernels_named("avx2");

}  // namespace underbrush::trace
