// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/frame_exposure.h"

#include <cstdint>
#include <utility>

namespace glint {
namespace {

/// One channel of a frame, as frame_radiance() takes it: it divides by their number.
FrameFactors channel_alone(const FrameFactors& factors, int channel, int channels) {
  FrameFactors alone;
  for (const Colour& factor : factors) {
    Colour kept = Colour::Zero();
    kept[channel] = channels * factor[channel];
    alone.push_back(kept);
  }
  return alone;
}

/// Number of a channel's noise: no two channels of a scan share one.
int noise_index(int frame, std::size_t channel, std::size_t channels) {
  return static_cast<int>(channels) * frame + static_cast<int>(channel);
}

}  // namespace

std::vector<ImageF> channel_radiances(const PathPicture& picture,
                                      const FrameFactors& factors,
                                      std::optional<std::size_t> without,
                                      const Spans& where) {
  const int channels = static_cast<int>(picture.sums.num_channels());
  std::vector<ImageF> radiance;
  for (int c = 0; c < channels; ++c) {
    radiance.push_back(
        frame_radiance(picture, channel_alone(factors, c, channels), without, where));
  }
  return radiance;
}

std::vector<ImageF> expose_channels(const Sensor& sensor,
                                    std::span<const ImageF> radiance,
                                    int frame,
                                    const Spans& where) {
  std::vector<ImageF> grey;
  for (std::size_t c = 0; c < radiance.size(); ++c) {
    const int index = noise_index(frame, c, radiance.size());
    ImageF& of_channel = grey.emplace_back(radiance[c].width(), radiance[c].height());
    if (where.empty()) {
      sensor.expose(radiance[c], index, of_channel);
    } else {
      sensor.expose(radiance[c], index, where, of_channel);
    }
  }
  return grey;
}

ImageF mean_of_channels(std::span<const ImageF> channels) {
  if (channels.size() == 1) {
    return channels[0];
  }
  ImageF mean(channels[0].width(), channels[0].height());
  for (const ImageF& channel : channels) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean.values()[i] += channel.values()[i] / static_cast<float>(channels.size());
    }
  }
  return mean;
}

namespace {

/// Whether one of the channels is at full scale.
bool is_clipped(const std::vector<ImageF>& channels, std::size_t pixel) {
  unsigned clipped = 0;
  for (const ImageF& channel : channels) {
    clipped |= channel.values()[pixel] >= 1.0F ? 1U : 0U;
  }
  return clipped != 0;
}

}  // namespace

void accumulate_channels(const Sensor& sensor,
                         std::span<const ImageF> radiance,
                         int frame,
                         ScanSums& sums,
                         ImageF* grey,
                         const Spans& where) {
  if (radiance.size() == 1 && where.empty()) {
    sensor.accumulate(radiance[0], frame, sums, grey);
    return;
  }
  if (radiance.size() == 1) {
    sensor.accumulate(radiance[0], frame, where, sums, grey);
    return;
  }
  const std::vector<ImageF> channels = expose_channels(sensor, radiance, frame, where);
  ImageF mean = mean_of_channels(channels);
  if (sums.frames == 0) {
    sums = ScanSums(mean.width(), mean.height());
  }
  for (std::size_t i = 0; i < mean.size(); ++i) {
    sums.sum.values()[i] += static_cast<double>(mean.values()[i]);
    std::uint16_t& clipped = sums.clipped_frames.values()[i];
    clipped = static_cast<std::uint16_t>(clipped + (is_clipped(channels, i) ? 1U : 0U));
  }
  ++sums.frames;
  if (grey != nullptr) {
    *grey = std::move(mean);
  }
}

}  // namespace glint
