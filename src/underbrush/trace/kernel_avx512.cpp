#include "underbrush/trace/kernel_table.inl"

namespace underbrush::trace {

constinit const Kernels kKernelsAvx512 = kernels_named("avx512");

}  // namespace underbrush::trace
