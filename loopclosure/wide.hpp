// Loops over plain arrays that the compiler turns into vector instructions.
#pragma once

// Put before a function, builds it for AVX2 as well, which is taken where the processor has it.
// AVX2 brings no fused multiply-add, so that both give the same bytes.
#if defined(__x86_64__)
#define GROUNDLOOP_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define GROUNDLOOP_WIDE
#endif
