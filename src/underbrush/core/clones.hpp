/// \file
/// `UNDERBRUSH_CLONES` compiles a function for several instruction sets and chooses one when the
/// program starts. All of them give the same bits, because no operation is reordered or fused.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define UNDERBRUSH_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define UNDERBRUSH_CLONES
#endif
