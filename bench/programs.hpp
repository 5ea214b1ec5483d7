/// \file
/// The benchmarks, which are one program: its name says which of them runs.
#pragma once

namespace underbrush::bench {

/// Takes the arguments of a program, and returns its exit status.
using Program = int(int argc, char** argv);

Program bench_echoes, bench_fitters, bench_fmu, bench_log_formats, bench_octree, bench_perception,
    bench_pipeline, bench_trace, bench_triangles, bench_waveform;

}  // namespace underbrush::bench
