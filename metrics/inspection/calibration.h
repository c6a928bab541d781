// SPDX-License-Identifier: GPL-3.0-or-later
//
// The threshold that flawless pictures ask for: docs/theory/inspection.md.
#pragma once

#include <span>

#include "core/image/image.h"
#include "core/thread_pool.h"
#include "metrics/inspection/inspector.h"

namespace glint {

/// The smallest threshold from which on flawless pictures have at most so many blobs each, on
/// average: exact to the last bit of a float. At least the inspector's min_threshold().
/// @param responses  of flawless pictures, at least one
/// @throws ConfigError for none
double threshold_for(const Inspector& inspector,
                     std::span<const ImageF> responses,
                     double false_alarms_per_picture,
                     ThreadPool& pool);

}  // namespace glint
