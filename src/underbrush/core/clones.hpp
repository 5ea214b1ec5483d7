/// \file
/// Loops compiled for several instruction sets, chosen when the program starts. They give the same
/// bits: no operation is reordered or fused.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define UNDERBRUSH_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define UNDERBRUSH_CLONES
#endif
