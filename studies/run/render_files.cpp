// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/render_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/exr_layers.h"
#include "studies/imaging/frame_exposure.h"
#include "studies/imaging/geometry/view_geometry.h"
#include "studies/run/render_maps.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

std::string_view channel_name(std::size_t channel, std::size_t channels) {
  constexpr std::array<std::string_view, 3> kNames = {"R", "G", "B"};
  return channels == 1 ? "Y" : kNames[channel];
}

std::size_t num_channels(const Film& sums) {
  return sums.groups.empty() ? 0 : sums.groups[0].channels.size();
}

/// Sums over samples as a mean.
ExrChannel mean_channel(std::string name, const ImageF& sum, const Image<std::int32_t>& samples) {
  return {.name = std::move(name), .fill = [&](int y, float* row) {
            for (int x = 0; x < sum.width(); ++x) {
              row[x] = sum(x, y) / static_cast<float>(std::max(1, samples(x, y)));
            }
          }};
}

void write_radiance(const RenderedView& view, const fs::path& folder) {
  const Film& sums = view.picture.sums;
  const std::size_t channels = num_channels(sums);
  const FrameFactors factors = mean_factors(view.picture.frames);
  std::vector<ImageF> total;
  total.reserve(channels);
  std::vector<ExrChannel> layers;
  for (std::size_t c = 0; c < channels; ++c) {
    total.push_back(channel_radiance(sums, factors, static_cast<int>(c)));
    layers.push_back(exr_channel(std::string(channel_name(c, channels)), total.back()));
  }
  for (std::size_t g = 0; g < sums.groups.size() && sums.groups.size() > 1; ++g) {
    for (std::size_t c = 0; c < channels; ++c) {
      layers.push_back(mean_channel(fmt::format("{}.{}", view.groups[g], channel_name(c, channels)),
                                    sums.groups[g].channels[c],
                                    sums.samples));
    }
  }
  write_exr_channels(folder / "image.exr", sums.width_px, sums.height_px, layers);
}

void write_grey_or_colour(const fs::path& path,
                          std::span<const ImageF> channels,
                          PixelDepth depth) {
  if (channels.size() == 1) {
    write_png(path, channels[0], depth);
  } else {
    write_png(path, rgb_of(channels));
  }
}

/// Exposes all frames. @return their mean
std::vector<ImageF> write_frames(const RenderedView& view, const fs::path& folder, bool is_kept) {
  const Film& sums = view.picture.sums;
  const Sensor sensor(view.scene.sensor, sums.width_px, sums.height_px);
  const PixelDepth depth = view.scene.sensor.bits == 8 ? PixelDepth::k8Bit : PixelDepth::k16Bit;
  std::vector<ImageF> mean(num_channels(sums), ImageF(sums.width_px, sums.height_px));
  const auto share = 1.0F / static_cast<float>(view.picture.frames.size());
  for (std::size_t k = 0; k < view.picture.frames.size(); ++k) {
    const int index = static_cast<int>(k);
    const std::vector<ImageF> frame =
        expose_channels(sensor, channel_radiances(view.picture, view.picture.frames[k]), index);
    for (std::size_t c = 0; c < mean.size(); ++c) {
      std::ranges::transform(frame[c].values(),
                             mean[c].values(),
                             mean[c].values().begin(),
                             [&](float value, float sum) { return sum + share * value; });
    }
    if (is_kept) {
      write_grey_or_colour(
          folder / "sequence" / fmt::format("frame_{:03}.png", index), frame, depth);
    }
  }
  return mean;
}

/// A picture without noise has none; what an earlier one left is removed.
/// @return relative_error(); NaN without noise
double write_standard_error(const PathPicture& picture, const fs::path& path) {
  if (!picture.has_noise) {
    std::error_code ignored;
    fs::remove(path, ignored);
    return std::numeric_limits<double>::quiet_NaN();
  }
  const ImageF standard_error = standard_error_of(picture);
  const ExrChannel channel = exr_channel("Y", standard_error);
  write_exr_channels(path, picture.sums.width_px, picture.sums.height_px, {&channel, 1});
  return relative_error(picture, standard_error);
}

/// @return the picture for people
ViewPictures write_light(const RenderedView& view, const fs::path& folder, bool has_design) {
  write_radiance(view, folder);
  const double error = write_standard_error(view.picture, folder / "standard_error.exr");
  const bool is_sequence = view.picture.frames.size() > 1 && !has_design;
  if (is_sequence) {
    make_folder(folder / "sequence");
  }
  const std::vector<ImageF> mean = write_frames(view, folder, is_sequence);
  write_grey_or_colour(folder / "image.png", mean, PixelDepth::k8Bit);
  write_tiff(folder / "image.tif", mean);
  return {.image = rgb_of(mean), .relative_error = error};
}

void write_coverage(const Film& sums, const fs::path& folder) {
  const auto fill = [&](const auto& count_at) {
    return [&sums, count_at](int y, float* row) {
      for (int x = 0; x < sums.width_px; ++x) {
        row[x] = static_cast<float>(count_at(x, y)) /
                 static_cast<float>(std::max(1, sums.samples(x, y)));
      }
    };
  };
  std::vector<ExrChannel> channels = {
      {.name = "background", .fill = fill([&sums](int x, int y) {
                               return std::max(1, sums.samples(x, y)) - sums.part(x, y);
                             })},
      {.name = "sound", .fill = fill([&sums](int x, int y) {
                          int count = sums.part(x, y);
                          for (const DefectSums& defect : sums.defects) {
                            count -= defect.samples(x, y);
                          }
                          return count;
                        })}};
  for (const DefectSums& defect : sums.defects) {
    channels.push_back(
        {.name = fmt::format("defect.{}", defect.id),
         .fill = fill([&defect](int x, int y) { return static_cast<int>(defect.samples(x, y)); })});
  }
  write_exr_channels(folder / "coverage.exr", sums.width_px, sums.height_px, channels);
}

/// How much of the view shows a defect, and the window around it.
Json seen_json(const Film& sums, std::int32_t id) {
  const auto found = std::ranges::find(sums.defects, id, &DefectSums::id);
  if (found == sums.defects.end()) {
    return {{"area_px", 0.0}, {"window_px", nullptr}};
  }
  int left = sums.width_px;
  int top = sums.height_px;
  int right = -1;
  int bottom = -1;
  for (int y = 0; y < sums.height_px; ++y) {
    for (int x = 0; x < sums.width_px; ++x) {
      if (found->samples(x, y) > 0) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
    }
  }
  Json json = {{"area_px", area_px(sums, *found)}, {"window_px", nullptr}};
  if (right >= 0) {
    json["window_px"] = {left, top, right - left + 1, bottom - top + 1};
  }
  return json;
}

Json defects_in_view(const RenderedView& view) {
  Json list = Json::array();
  const std::vector<double> slopes = defect_slopes_rad(view.part);
  const DefectivePart& part = view.part.made;
  std::size_t outline = 0;  // among the defects that were made
  for (std::size_t i = 0; i < part.defects.size(); ++i) {
    if (part.defects[i].is_made && outline < part.outlines.size()) {
      const Defect& defect = part.defects[i].defect;
      const Json seen = seen_json(view.seen, defect.id);
      list.push_back(defect_in_view_json(defect, part.outlines[outline++], slopes[i], seen));
    }
  }
  return {{"schema", 1}, {"defects", list}};
}

/// What a scored, a lit, or a longer rendering left here must not stand beside this one.
void remove_stale(const RenderedView& view, const fs::path& folder) {
  std::error_code ignored;
  for (const char* name : {"scores.json",
                           "aspect.png",
                           "aspect.exr",
                           "cross_section.svg",
                           "cross_section.dxf",
                           "cross_section.csv"}) {
    fs::remove(folder / name, ignored);
  }
  for (const char* name :
       {"image.exr", "image.png", "image.tif", "standard_error.exr", "side_by_side.png"}) {
    if (!view.has_light()) {
      fs::remove(folder / name, ignored);
    }
  }
  const std::size_t frames =
      view.has_light() && view.picture.frames.size() > 1 ? view.picture.frames.size() : 0;
  for (std::size_t k = frames;
       fs::remove(folder / "sequence" / fmt::format("frame_{:03}.png", k), ignored);
       ++k) {
  }
}

Json vector_json(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

ImageF batch_error(const PathPicture& picture, const FrameFactors& factors, const ImageF& whole) {
  ImageF squares(whole.width(), whole.height());
  for (std::size_t b = 0; b < picture.batches.size(); ++b) {
    const ImageF without = frame_radiance(picture, factors, b);
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const float difference = without.values()[i] - whole.values()[i];
      squares.values()[i] += difference * difference;
    }
  }
  const auto count = static_cast<float>(picture.batches.size());
  for (float& value : squares.values()) {
    value = std::sqrt((count - 1.0F) / count * value);
  }
  return squares;
}

}  // namespace

FrameFactors mean_factors(std::span<const FrameFactors> frames) {
  FrameFactors mean(frames.empty() ? 0 : frames[0].size(), Colour::Zero());
  for (const FrameFactors& frame : frames) {
    for (std::size_t g = 0; g < mean.size(); ++g) {
      mean[g] += frame[g] / static_cast<double>(frames.size());
    }
  }
  return mean;
}

ImageF standard_error_of(const PathPicture& picture) {
  const FrameFactors factors = mean_factors(picture.frames);
  const ImageF whole = frame_radiance(picture, factors);
  if (!picture.batches.empty()) {
    return batch_error(picture, factors, whole);
  }
  const FrameFactors equal(factors.size(), Colour::Ones());
  const ImageF of_equal = frame_radiance(picture, equal);
  const std::vector<double> ones(factors.size(), 1.0);
  ImageF error = standard_error_image(picture.sums, ones);
  for (std::size_t i = 0; i < error.size(); ++i) {
    const float light = of_equal.values()[i];
    error.values()[i] *= light > 0.0F ? whole.values()[i] / light : 0.0F;
  }
  return error;
}

double relative_error(const PathPicture& picture, const ImageF& standard_error) {
  const ImageF radiance = frame_radiance(picture, mean_factors(picture.frames));
  double error = 0.0;
  double light = 0.0;
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    if (picture.sums.part.values()[i] > 0) {
      light += static_cast<double>(radiance.values()[i]);
      error += static_cast<double>(standard_error.values()[i]);
    }
  }
  return light > 0.0 ? error / light : 0.0;
}

double area_px(const Film& sums, const DefectSums& defect) {
  double area = 0.0;
  for (std::size_t i = 0; i < defect.samples.size(); ++i) {
    area += static_cast<double>(defect.samples.values()[i]) / std::max(1, sums.samples.values()[i]);
  }
  return area;
}

bool is_seen(const Film& sums, const DefectSums& defect) {
  constexpr double kMin_px = 1.0;
  constexpr double kRounding_px = 1e-9;
  return area_px(sums, defect) >= kMin_px - kRounding_px;
}

Json defect_in_view_json(const Defect& defect,
                         const HeightFeature& outline,
                         double slope_rad,
                         const Json& view) {
  Json json = {{"id", outline.id},
               {"label", outline.label},
               {"kind", type_name(defect.type)},
               {"realisation", realisation_name(defect.realisation)},
               {"centre_mm", vector_json(outline.centre_mm)},
               {"normal", vector_json(outline.normal)},
               {"height_um", outline.height_mm * 1e3},
               {"max_slope_mrad", slope_rad * 1e3}};
  json.update(view);
  if (is_line(defect.type)) {
    json["direction"] = vector_json(outline.u_axis);
    json["length_mm"] = outline.length_mm;
    json["width_mm"] = outline.width_mm;
  } else {
    json["diameter_mm"] = 4.0 * outline.sigma_mm;
  }
  return json;
}

ViewPictures write_view_files(const RenderedView& view, const fs::path& folder, bool has_design) {
  make_folder(folder);
  if (!has_design) {
    remove_stale(view, folder);
    write_file(folder / "defects.json", defects_in_view(view).dump(2) + "\n");
    write_file(folder / "scene.toml", to_toml(write_scene(view.scene)));
  }
  ViewPictures pictures;
  if (view.has_light()) {
    pictures = write_light(view, folder, has_design);
  }
  write_mask_png(folder / "part_mask.png", view.part_mask);
  write_mask_png(folder / "mask.png", defect_mask(view.seen));
  write_coverage(view.seen, folder);
  write_geometry(view.seen, folder / "geometry.exr");
  pictures.map = defect_map(view.seen, view.part.made);
  write_png(folder / "defects.png", pictures.map);
  if (view.has_light()) {
    write_png(folder / "side_by_side.png", side_by_side(pictures.image, pictures.map));
  }
  return pictures;
}

}  // namespace glint
