// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many cells a test looks at: one of a kind among the fast tests, all among the slow ones,
// which define GLINT_ALL_CELLS.
#pragma once

namespace glint {

#ifdef GLINT_ALL_CELLS
inline constexpr bool kAllCells = true;
#else
inline constexpr bool kAllCells = false;
#endif

}  // namespace glint
