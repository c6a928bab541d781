// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/image/image.h"
#include "core/image/spans.h"
#include "core/thread_pool.h"

namespace glint {

/// Standard deviation of the values in the spans as their middle tells it: 1.4826 times the median
/// distance from the median (nearest ranks, exact), 1 sigma for Gaussian values. Up to half of the
/// pixels may be anything.
/// @param spans  at least one pixel
double robust_deviation(const ImageF& image, const Spans& spans, ThreadPool& pool);

/// The same on the calling thread alone.
double robust_deviation(const ImageF& image, const Spans& spans);

/// 1.4826 times the median size of the values, on the calling thread alone: for responses that have
/// one size and either sign everywhere, so that the median of the signed values tells nothing.
double robust_size(const ImageF& image, const Spans& spans);

}  // namespace glint
