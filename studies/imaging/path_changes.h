// SPDX-License-Identifier: GPL-3.0-or-later
//
// What defects add to a path-traced picture: the part with them less the part without, both
// rendered twice with the same random numbers.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/image/image.h"
#include "studies/imaging/line_store.h"

namespace glint {

/// A picture rendered twice, with half of the samples each.
using Halves = std::array<PathBatch, 2>;

/// In the pixels that were rendered with the defects and differ.
RenderedChanges changes_between(const Halves& without, const Halves& with);

/// What defects add to the channels of the frames, in the pixels that were rendered.
struct FrameChanges {
  std::vector<std::size_t> pixels;
  std::vector<std::array<float, 2>> values;  ///< channel by channel, of both halves
  std::vector<float> gains;                  ///< of each pixel: the part that is no noise
};

/// @param channel_weights  of each channel of each frame: the factors of all rendered ones
FrameChanges frame_changes(const RenderedChanges& rendered,
                           const std::vector<std::vector<float>>& channel_weights,
                           int width_px,
                           int height_px);

/// Adds both halves' mean, times the gains, to the radiance of one channel, which stays >= 0.
/// @param index  of the channel among those of all frames
void add_changes(const FrameChanges& changes, std::size_t index, ImageF& radiance);

/// Over all channels of all frames, without the gains, for each half; empty without changes.
std::vector<ImageF> mean_changes(const FrameChanges& changes, int width_px, int height_px);

}  // namespace glint
