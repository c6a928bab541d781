// SPDX-License-Identifier: GPL-3.0-or-later
//
// Takes the noise of rendering off a picture of a part, of which two independent renderings are
// known: what both agree on stays, the rest is replaced by what the surface around it shows.
// docs/theory/simulated_line.md
#pragma once

#include <array>
#include <span>

#include "core/image/image.h"
#include "core/thread_pool.h"
#include "simulator/render/path_tracing/film.h"

namespace glint {

/// Two independent renderings of the same picture.
using RenderedTwice = std::array<ImageF, 2>;

/// How much of what two renderings show in some pixels is in both, 0 to 1. The product of two
/// independent renderings is free of noise on average; what it still scatters by counts as none.
/// @param product  sum of their products
/// @param square   sum of the squares of their means
/// @param count    of the numbers that were summed
double agreed_share(double product, double square, double count);

/// Smooths both renderings of each picture alike. At each pixel a polynomial of second degree is
/// fitted to those pixels of its 13 x 13 neighbourhood that show the same surface (near in depth,
/// normals within 14 degrees); of what it leaves over, the share that both renderings agree on in
/// the 9 x 9 pixels around is added again. Pixels that do not lie wholly on the part are left
/// alone. The same bytes for any number of threads.
/// @param surface   of the same view
/// @param coverage  of the same view
void smooth(const SurfaceImages& surface,
            const CoverageImages& coverage,
            std::span<RenderedTwice> pictures,
            ThreadPool& pool);

}  // namespace glint
