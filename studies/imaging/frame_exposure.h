// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a sensor makes of a frame: each channel of a colour sensor has noise and clips by itself.
// Scores, written pictures and simulated lines all expose here, so that they agree.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "simulator/sensor/sensor.h"
#include "studies/imaging/path_picture.h"

namespace glint {

/// Radiance of each channel of a frame, as frame_radiance() gives their mean.
/// @param without  a batch that is left out; empty: all samples
/// @param where    pixels that are wanted, all others are 0; empty: all
std::vector<ImageF> channel_radiances(const PathPicture& picture,
                                      const FrameFactors& factors,
                                      std::optional<std::size_t> without = {},
                                      const Spans& where = {});

/// Grey values of each channel.
/// @param radiance  of each channel
/// @param where     pixels that are wanted, all others are 0; empty: all
std::vector<ImageF> expose_channels(const Sensor& sensor,
                                    std::span<const ImageF> radiance,
                                    int frame,
                                    const Spans& where = {});

/// Grey values of a frame: their mean. @param channels  one or more
ImageF mean_of_channels(std::span<const ImageF> channels);

/// Exposes a frame and adds it to the sums: the mean of its channels, and one more clipped frame
/// where one of them is at full scale.
/// @param radiance  of each channel
/// @param grey      set to the frame's grey values; nullptr: not wanted
/// @param where     pixels that are wanted, the sums of all others are 0; empty: all
void accumulate_channels(const Sensor& sensor,
                         std::span<const ImageF> radiance,
                         int frame,
                         ScanSums& sums,
                         ImageF* grey = nullptr,
                         const Spans& where = {});

}  // namespace glint
