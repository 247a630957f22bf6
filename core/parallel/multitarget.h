/// Multi-target functions: hot loops compiled for several vector units in one program.
///
/// A function marked SLUICE_MULTITARGET exists once for AVX-512, once for AVX2 and once for the oldest x86-64; the
/// loader picks the best that the machine has. What it calls in its loops must be SLUICE_ALWAYS_INLINE: a function that
/// is called rather than inlined is compiled for the oldest machine only. Sanitizers cannot instrument the dispatch, so
/// builds with them leave SLUICE_ENABLE_MULTITARGET undefined, and the mark is empty.
#pragma once

#if defined(SLUICE_ENABLE_MULTITARGET) && defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#define SLUICE_MULTITARGET __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SLUICE_MULTITARGET
#endif

#define SLUICE_ALWAYS_INLINE __attribute__((always_inline)) inline

/// The same for a lambda, written after its parameters.
#define SLUICE_INLINE_LAMBDA __attribute__((always_inline))
