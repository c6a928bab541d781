// SPDX-License-Identifier: GPL-3.0-or-later
//
// From radiance to grey values: Gaussian blur, electrons with Poisson and read noise, gain,
// clipping, rounding, in the order of EMVA 1288. One sweep by rows does it all, in strips narrow
// enough that the rows of the vertical blur stay in the first-level cache. Noise is addressed by
// pixel and frame instead of drawn in sequence, so any part of a picture can be exposed on its own
// and gets the same numbers. docs/theory/sensor.md. Cost: 2 (2 r + 1) products per pixel for a blur
// of radius r, with noise a quantile per pixel. Memory: a few rows.
#include "simulator/sensor/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulator/sensor/blur_kernel.h"
#include "simulator/sensor/pixel_noise.h"
#include "simulator/sensor/poisson_quantile.h"
#include "simulator/sensor/sensor_kernels.h"

namespace glint {
namespace {

namespace kernels = sensor_kernels;

constexpr double kGaussianFromElectrons = kLargestTabledMean;
constexpr std::array<int, 5> kBits = {0, 8, 10, 12, 16};

/// Rows of the vertical blur that stay in the first cache, all of them.
constexpr int kCachedRows_floats = 6144;
constexpr int kNarrowestStrip_px = 128;

/// Loops run over whole vectors where there is room behind.
constexpr int kLanes = 16;

int whole_vectors(int count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

/// Scans of a few pixels are those of a search, one candidate after the other; whole pictures are
/// taken once, and their noise would fill the memory.
bool is_small_share(const Spans& where, int width_px, int height_px) {
  constexpr std::int64_t kPartOfPicture = 4;
  std::int64_t pixels = 0;
  for (const RowSpan& span : where) {
    pixels += span.size();
  }
  return kPartOfPicture * pixels <= std::int64_t{width_px} * height_px;
}

int levels_of(const SensorSettings& settings) {
  return settings.bits == 0 ? 0 : (1 << settings.bits) - 1;
}

std::vector<float> in_float(const std::vector<double>& values) {
  std::vector<float> rounded;
  for (const double value : values) {
    rounded.push_back(static_cast<float>(value));
  }
  return rounded;
}

}  // namespace

void visit_keys(KeyVisitor& keys, SensorSettings& settings) {
  keys.number("exposure",
              settings.exposure,
              Range::between(1e-6, 1e6),
              "exposure time and aperture: factor on the collected light");
  keys.number("gain",
              settings.gain,
              Range::between(1e-6, 1e6),
              "amplification: factor on the grey values; clips at full scale");
  keys.number("blur_px",
              settings.blur_px,
              Range::between(0.0, 100.0),
              "standard deviation of the Gaussian blur, 0 for none");
  keys.integer("bits",
               settings.bits,
               Range::one_of(kBits),
               "grey values are rounded to so many bits, 0 for no rounding");
  keys.number("full_well_e",
              settings.full_well_e,
              Range::between(0.0, 1e7),
              "electrons of a pixel at full scale and gain 1, 0 for a sensor without noise");
  keys.number("read_noise_e",
              settings.read_noise_e,
              Range::between(0.0, 1e6),
              "standard deviation of the read noise in electrons");
  keys.number("dark_e",
              settings.dark_e,
              Range::between(0.0, 1e6),
              "mean dark signal of one frame in electrons");
  keys.integer("seed", settings.seed, Range::at_least(0), "seed of the sensor's noise");
  keys.numbers("wavelengths_nm",
               settings.wavelengths_nm,
               {.min = 1, .max = 3},
               Range::between(100, 20000),
               "one for a grey sensor, three for red, green, blue: where metals are looked up");
  keys.require(settings.wavelengths_nm.size() != 2,
               "wavelengths_nm",
               "has 2 numbers, must have 1 (grey) or 3 (red, green, blue)");
  keys.require(settings.full_well_e > 0.0 || settings.read_noise_e == 0.0,
               "read_noise_e",
               "is given in electrons and needs full_well_e > 0");
  keys.require(settings.full_well_e > 0.0 || settings.dark_e == 0.0,
               "dark_e",
               "is given in electrons and needs full_well_e > 0");
}

double noise_floor(const SensorSettings& settings) {
  const int levels = levels_of(settings);
  const double step = levels > 0 ? 1.0 / levels : 0.0;
  const double read = settings.full_well_e > 0.0
                          ? settings.read_noise_e * settings.gain / settings.full_well_e
                          : 0.0;
  return std::sqrt(step * step / 12.0 + read * read);
}

ImageF ScanSums::aspect() const {
  GLINT_CHECK(frames > 0, "the mean of no frames");
  ImageF mean = ImageF::uninitialized(sum.width(), sum.height());
  std::ranges::transform(sum.values(), mean.values().begin(), [this](double total) {
    return static_cast<float>(total / frames);
  });
  return mean;
}

struct Sensor::Scratch {
  std::vector<float>
      padded;  ///< a row after the vertical pass, with the blur's radius on each side
  std::vector<float> row;
  std::vector<float> grey;  ///< of the row where no frame takes it
  std::vector<const float*> low;
  std::vector<const float*> high;
  std::vector<std::uint32_t> words;
  std::vector<float> shot;
  std::vector<float> read;
  bool keeps_noise = false;  ///< for the next scan of the same pixels
};

SensorSettings without_noise(SensorSettings settings) {
  settings.full_well_e = settings.read_noise_e = settings.dark_e = 0.0;
  return settings;
}

double dark_grey(const SensorSettings& settings) {
  return settings.full_well_e > 0.0 ? settings.dark_e * settings.gain / settings.full_well_e : 0.0;
}

Sensor::Sensor(const SensorSettings& settings, int width_px, int height_px)
    : settings_(settings),
      width_px_(width_px),
      height_px_(height_px),
      whole_(whole_image(width_px, height_px)),
      weights_(in_float(blur_kernel(settings.blur_px))),
      has_negative_weights_(std::ranges::any_of(weights_, [](float w) { return w < 0.0F; })) {
  if (width_px <= 0 || height_px <= 0) {
    throw ConfigError("sensor", "the image has no pixel, width and height must be > 0");
  }
}

int Sensor::blur_reach_px(double tail) const {
  double beyond = 0.0;
  int reach = blur_radius_px();
  const auto weight_at = [&](int k) {
    return std::abs(static_cast<double>(weights_[static_cast<std::size_t>(k)]));
  };
  while (reach > 0 && beyond + weight_at(reach) < tail) {
    beyond += weight_at(reach);
    --reach;
  }
  return reach;
}

double Sensor::blur_variance_px2() const {
  double variance = 0.0;
  for (std::size_t k = 1; k < weights_.size(); ++k) {
    variance += 2.0 * static_cast<double>(weights_[k]) * static_cast<double>(k * k);
  }
  return variance;
}

/// Vertical pass into the padded row, then horizontal pass into the row. What they write behind the
/// span, up to a whole vector, is not used. There is no negative light.
void Sensor::blur_span(const ImageF& radiance, const RowSpan& span, Scratch& scratch) const {
  const int radius = blur_radius_px();
  const int low = std::max(0, span.begin - radius);
  const int high = std::min(width_px_, span.end + radius);
  kernels::TapRows taps{.centre = radiance.row(span.y) + low,
                        .low = scratch.low.data(),
                        .high = scratch.high.data(),
                        .weights = weights_.data(),
                        .radius = radius};
  if (radius == 0) {
    std::copy_n(radiance.row(span.y) + span.begin, span.size(), scratch.row.data());
    return;
  }
  for (int k = 1; k <= radius; ++k) {
    const auto at = static_cast<std::size_t>(k - 1);
    scratch.low[at] = radiance.row(std::max(span.y - k, 0)) + low;
    scratch.high[at] = radiance.row(std::min(span.y + k, height_px_ - 1)) + low;
  }
  float* image_start = scratch.padded.data() + radius;
  // The last of these rows may be the picture's.
  const int rows_left = height_px_ - std::min(span.y + radius, height_px_ - 1);
  const std::ptrdiff_t room = static_cast<std::ptrdiff_t>(rows_left) * width_px_ - low;
  const auto columns = static_cast<int>(std::min<std::ptrdiff_t>(whole_vectors(high - low), room));
  kernels::weigh_rows(taps, columns, image_start + low);
  if (low == 0) {
    std::fill_n(image_start - radius, radius, image_start[0]);
  }
  if (high == width_px_) {
    std::fill_n(image_start + width_px_, radius, image_start[width_px_ - 1]);
  }
  float* centre = image_start + span.begin;
  for (int k = 1; k <= radius; ++k) {
    const auto at = static_cast<std::size_t>(k - 1);
    scratch.low[at] = centre - k;
    scratch.high[at] = centre + k;
  }
  taps.centre = centre;
  kernels::weigh_rows(taps, whole_vectors(span.size()), scratch.row.data());
  if (has_negative_weights_) {
    kernels::cut_off_negative(span.size(), scratch.row.data());
  }
}

/// Turns the span's blurred radiance into noisy electrons.
void Sensor::add_noise(const RowSpan& span, int frame_index, Scratch& scratch) const {
  const int width = span.size();
  float* electrons = scratch.row.data();
  kernels::scale_and_shift(static_cast<float>(settings_.exposure * settings_.full_well_e),
                           static_cast<float>(settings_.dark_e),
                           width,
                           electrons);
  const std::int64_t first_pixel = std::int64_t{span.y} * width_px_ + span.begin;
  const PixelNoise noise = {.words = scratch.words.data(),
                            .shot = scratch.shot.data(),
                            .read = settings_.read_noise_e > 0.0 ? scratch.read.data() : nullptr};
  if (scratch.keeps_noise) {
    shared_noise().load(settings_.seed, frame_index, first_pixel, width, noise);
  } else {
    draw_noise(settings_.seed, frame_index, first_pixel, width, noise);
  }
  for (int x = 0; x < width; ++x) {
    if (electrons[x] < static_cast<float>(kGaussianFromElectrons)) {
      // Exact, and out of reach of the Gaussian pass: it leaves a pixel with normal 0 alone.
      const double u = (scratch.words[static_cast<std::size_t>(x)] + 0.5) * 0x1p-32;
      const double mean = std::max(static_cast<double>(electrons[x]), 0.0);
      electrons[x] = mean > 0.0 ? static_cast<float>(poisson_quantile(mean, u)) : 0.0f;
      scratch.shot[static_cast<std::size_t>(x)] = 0.0f;
    }
  }
  kernels::add_shot_noise(scratch.shot.data(), width, electrons);
  if (settings_.read_noise_e > 0.0) {
    kernels::add_scaled(
        static_cast<float>(settings_.read_noise_e), scratch.read.data(), width, electrons);
  }
}

/// Writes grey values to the frame, if there is one, and calls consume(span, grey values) for each
/// span. Wide ones come in strips, so that the rows that one row is blurred from are in the first
/// cache when the next row comes.
template <class Consume>
void Sensor::for_each_span(const ImageF& radiance,
                           int frame_index,
                           const Spans& where,
                           ImageF* frame,
                           const Consume& consume) const {
  GLINT_CHECK(radiance.width() == width_px_ && radiance.height() == height_px_,
              "radiance and sensor differ in size");
  const bool noisy = settings_.full_well_e > 0.0;
  const auto width = static_cast<std::size_t>(whole_vectors(width_px_));
  const std::size_t radius = weights_.size() - 1;
  Scratch scratch{.padded = std::vector<float>(width + 2 * radius + kLanes),
                  .row = std::vector<float>(width),
                  .grey = std::vector<float>(frame != nullptr ? 0 : width),
                  .low = std::vector<const float*>(radius),
                  .high = std::vector<const float*>(radius),
                  .words = std::vector<std::uint32_t>(noisy ? width : 0),
                  .shot = std::vector<float>(noisy ? width : 0),
                  .read = std::vector<float>(noisy ? width : 0),
                  .keeps_noise = noisy && is_small_share(where, width_px_, height_px_)};
  const double scale =
      noisy ? settings_.gain / settings_.full_well_e : settings_.gain * settings_.exposure;
  const int widest = std::max(kNarrowestStrip_px, kCachedRows_floats / (2 * blur_radius_px() + 1));
  const int strips = (width_px_ + widest - 1) / widest;
  for (int strip = 0; strip < strips; ++strip) {
    const int left = width_px_ * strip / strips;
    const int right = width_px_ * (strip + 1) / strips;
    for (const RowSpan& whole : where) {
      const RowSpan span = {
          .y = whole.y, .begin = std::max(whole.begin, left), .end = std::min(whole.end, right)};
      if (span.size() <= 0) {
        continue;
      }
      blur_span(radiance, span, scratch);
      if (noisy) {
        add_noise(span, frame_index, scratch);
      }
      float* grey = frame != nullptr ? frame->row(span.y) + span.begin : scratch.grey.data();
      kernels::to_grey(
          scratch.row.data(), static_cast<float>(scale), levels_of(settings_), span.size(), grey);
      consume(span, static_cast<const float*>(grey));
    }
  }
}

void Sensor::expose(const ImageF& radiance, int frame_index, ImageF& frame) const {
  if (frame.width() != width_px_ || frame.height() != height_px_) {
    frame = ImageF(width_px_, height_px_);
  }
  expose(radiance, frame_index, whole_, frame);
}

void Sensor::expose(const ImageF& radiance,
                    int frame_index,
                    const Spans& where,
                    ImageF& frame) const {
  for_each_span(radiance, frame_index, where, &frame, [](const RowSpan&, const float*) {});
}

void Sensor::accumulate(const ImageF& radiance,
                        int frame_index,
                        ScanSums& sums,
                        ImageF* frame) const {
  accumulate(radiance, frame_index, whole_, sums, frame);
}

void Sensor::accumulate(const ImageF& radiance,
                        int frame_index,
                        const Spans& where,
                        ScanSums& sums,
                        ImageF* frame) const {
  const bool has_size = sums.sum.width() == width_px_ && sums.sum.height() == height_px_;
  if (sums.frames == 0 && !has_size) {
    sums = ScanSums(width_px_, height_px_);
  } else if (sums.frames == 0) {
    for (const RowSpan& span : where) {
      std::fill_n(sums.sum.row(span.y) + span.begin, span.size(), 0.0);
      std::fill_n(sums.clipped_frames.row(span.y) + span.begin, span.size(), std::uint16_t{0});
    }
  }
  GLINT_CHECK(sums.sum.width() == width_px_ && sums.sum.height() == height_px_,
              "sums and sensor differ in size");
  if (frame != nullptr && (frame->width() != width_px_ || frame->height() != height_px_)) {
    *frame = ImageF(width_px_, height_px_);
  }
  for_each_span(radiance, frame_index, where, frame, [&](const RowSpan& span, const float* grey) {
    kernels::accumulate(grey,
                        span.size(),
                        sums.sum.row(span.y) + span.begin,
                        sums.clipped_frames.row(span.y) + span.begin);
  });
  ++sums.frames;
}

}  // namespace glint
