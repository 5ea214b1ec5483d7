// This file is included by kernel_*.cpp, once for each instruction set; UB_KERNELS names the table
// that it defines. The kernels must not call an inline function of a shared header, because the
// linker could keep the copy that was compiled for a larger instruction set than the machine has.
#include <immintrin.h>

#include "underbrush/trace/kernel.hpp"
// Each file uses those before it.
// clang-format off
#include "underbrush/trace/exact.inl"
#include "underbrush/trace/simd.inl"
#include "underbrush/trace/many.inl"
#include "underbrush/trace/packet_rays.inl"
#include "underbrush/trace/packet_finds.inl"
#include "underbrush/trace/packet_ellipsoids.inl"
#include "underbrush/trace/packet_triangles.inl"
#include "underbrush/trace/single.inl"
#include "underbrush/trace/packet.inl"
#include "underbrush/trace/packet_trace.inl"
// clang-format on

namespace underbrush::trace {
namespace {

void trace(const View& view, Ask ask, Batch& batch, const uint32_t* order, size_t count) {
  switch (ask) {
    case Ask::kAccepted:
      return trace_all<Ask::kAccepted>(view, batch, order, count);
    case Ask::kSurface:
      return trace_all<Ask::kSurface>(view, batch, order, count);
    case Ask::kAll:
      return trace_all<Ask::kAll>(view, batch, order, count);
  }
}

}  // namespace

extern const Kernels UB_KERNELS;
const Kernels UB_KERNELS = {UB_KERNELS_NAME, unfold, trace, meet_many};

}  // namespace underbrush::trace
