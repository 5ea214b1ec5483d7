// The table of the kernels, for kernel_*.cpp of each instruction set. The kernels must not call an
// inline function of a shared header, because the linker could keep the copy that was compiled for
// a larger instruction set than the machine has.
#pragma once
#include "underbrush/trace/kernel.hpp"
#include "underbrush/trace/many.inl"
#include "underbrush/trace/packet_rays.inl"
#include "underbrush/trace/packet_trace.inl"

namespace underbrush::trace {
namespace {

[[maybe_unused]] void trace(const View& view, Query query, Batch& batch, const uint32_t* order,
                            size_t count) {
  switch (query) {
    case Query::kAccepted:
      return trace_all<Query::kAccepted>(view, batch, order, count);
    case Query::kSurface:
      return trace_all<Query::kSurface>(view, batch, order, count);
    case Query::kAll:
      return trace_all<Query::kAll>(view, batch, order, count);
  }
}

// The kernels under the name of their instruction set.
constexpr Kernels kernels_named(const char* name) {
  return {name, convert_rays, trace, intersect_many, answer_known};
}

}  // namespace
}  // namespace underbrush::trace
