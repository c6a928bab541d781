// SPDX-License-Identifier: GPL-3.0-or-later
//
// How kernels are built for several instruction sets in one program. Kernels stand in files that
// know no Eigen, whose types change their layout with the instruction set
// (docs/decisions/0002-bit-identical-results.md).
#pragma once

/// A function that is compiled three times; the machine's best version is chosen when the program
/// starts. The versions give different bits only where an operation's own rounding differs.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#define GLINT_WIDE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else  // a thread sanitizer cannot run in the resolvers that choose a version before main()
#define GLINT_WIDE
#endif

/// For what GLINT_WIDE functions call: else it would be compiled for the narrowest set.
#define GLINT_INLINE inline __attribute__((always_inline))
