#include "underbrush/trace/kernel.inl"

namespace underbrush::trace {

constinit const Kernels kKernelsAvx2 = kernels_named("avx2");

}  // namespace underbrush::trace
