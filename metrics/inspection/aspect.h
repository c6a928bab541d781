// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "core/image/image.h"
#include "core/thread_pool.h"

namespace glint {

/// The mean of a sequence: integers divided by the largest code of their type.
/// @param frames  at least one, all of one size @throws ConfigError otherwise, or for NaN
ImageF aspect_of(std::span<const Image<std::uint8_t>> frames, ThreadPool& pool);
ImageF aspect_of(std::span<const Image<std::uint16_t>> frames, ThreadPool& pool);
ImageF aspect_of(std::span<const ImageF> frames, ThreadPool& pool);

/// aspect_of(), 0 outside the mask.
/// @param mask    of the frames' size
/// @param aspect  of that size; anything may be in it
/// @throws ConfigError as aspect_of(), and for frames of another size than the mask
void masked_aspect(std::span<const Image<std::uint8_t>> frames,
                   const Mask& mask,
                   ThreadPool& pool,
                   ImageF& aspect);

}  // namespace glint
