#include "underbrush/trace/kernel_table.inl"

namespace underbrush::trace {

constinit const Kernels kKernelsBase = kernels_named("sse2");

}  // namespace underbrush::trace
