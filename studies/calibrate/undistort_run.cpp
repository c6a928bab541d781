// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/undistort_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <set>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/exr_layers.h"
#include "core/image/image_io.h"
#include "core/thread_pool.h"
#include "hardware/poses/camera_file.h"
#include "simulator/camera/undistortion.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

/// The name without its ending: that depends on what the picture holds.
std::vector<std::string> written_stems(const std::vector<fs::path>& pictures) {
  std::vector<std::string> stems;
  std::set<std::string> seen;
  for (const fs::path& picture : pictures) {
    stems.push_back(picture.stem().string());
    if (!seen.insert(stems.back()).second) {
      throw ConfigError(
          fmt::format("{}: another picture of that name would be written to the same "
                      "file; undistort them into folders of their own",
                      picture.string()));
    }
  }
  return stems;
}

/// That of the first picture.
fs::path folder_undistorted(const UndistortOptions& options) {
  std::error_code ignored;
  return fs::absolute(options.pictures.front(), ignored).parent_path();
}

void check_options(const UndistortOptions& options, const fs::path& out) {
  if (options.pictures.empty()) {
    throw ConfigError("PICTURES: there are none; give the pictures to undistort");
  }
  if (options.camera.empty()) {
    throw ConfigError("--camera: is missing; give calibration.toml, or a camera's file of others");
  }
  std::vector<std::string> names = {"camera.toml", "run.json"};
  for (const std::string& stem : written_stems(options.pictures)) {
    names.insert(names.end(), {stem + ".png", stem + ".exr", stem + ".tiff"});
  }
  check_result_folder(out, ResultKind::kUndistort, names);
  std::vector<fs::path> inputs = options.pictures;
  inputs.push_back(options.camera);
  check_inputs_kept(inputs, out, names);
  if (options.out.empty()) {
    check_source_of_folder(out, {folder_undistorted(options)});
  }
}

/// The camera with the picture's size, where its file does not tell one.
PinholeIntrinsics camera_of(const PinholeIntrinsics& read,
                            const Picture& picture,
                            const std::string& name,
                            const fs::path& file) {
  PinholeIntrinsics camera = read;
  if (camera.width_px == 0) {
    camera.width_px = picture.width();
    camera.height_px = picture.height();
  }
  if (camera.width_px != picture.width() || camera.height_px != picture.height()) {
    throw ConfigError(fmt::format("{}: has {} x {} pixels, the camera of {} has {} x {}",
                                  name,
                                  picture.width(),
                                  picture.height(),
                                  file.string(),
                                  camera.width_px,
                                  camera.height_px));
  }
  return camera;
}

/// The camera of the new pictures, which have no distortion.
std::string camera_toml(const PinholeIntrinsics& camera) {
  return fmt::format(
      "# camera of the undistorted pictures beside this file\n[camera]\nwidth_px = {}\n"
      "height_px = {}\nfocal_x_px = {}\nfocal_y_px = {}\ncenter_x_px = {}\ncenter_y_px = {}\n",
      camera.width_px,
      camera.height_px,
      camera.focal_px.x(),
      camera.focal_px.y(),
      camera.center_px.x(),
      camera.center_px.y());
}

/// One channel, or red, green and blue.
std::vector<ImageF> channels_of(const Picture& picture, const fs::path& file) {
  if (picture.channels >= 3) {
    return read_colours(file);
  }
  return {linear_values(picture.pixels)};
}

void write_floats(const fs::path& path, const std::vector<ImageF>& channels) {
  if (channels.size() == 1) {
    write_exr(path, channels[0]);
    return;
  }
  write_exr_channels(path,
                     channels[0].width(),
                     channels[0].height(),
                     std::array{exr_channel("R", channels[0]),
                                exr_channel("G", channels[1]),
                                exr_channel("B", channels[2])});
}

/// @return the name of the file
std::string write_picture(const fs::path& folder,
                          const std::string& stem,
                          const Picture& picture,
                          const std::vector<ImageF>& channels) {
  const bool is_colour = channels.size() == 3;
  const char* const ending = picture.is_float                ? ".exr"
                             : is_colour && picture.bits > 8 ? ".tiff"
                                                             : ".png";
  const fs::path path = folder / (stem + ending);
  if (picture.is_float) {
    write_floats(path, channels);
  } else if (is_colour && picture.bits > 8) {
    write_tiff(path, channels);
  } else if (is_colour) {
    write_png(path, rgb_of(channels));
  } else {
    write_png(path, channels[0], picture.bits > 8 ? PixelDepth::k16Bit : PixelDepth::k8Bit);
  }
  return stem + ending;
}

}  // namespace

Json undistort_pictures(const UndistortOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const fs::path out = options.out.empty()
                           ? folder_of_pictures(options.pictures, ResultKind::kUndistort)
                           : options.out;
  check_options(options, out);
  const PinholeIntrinsics read = read_camera_file(options.camera).intrinsics;
  ThreadPool pool(options.threads);
  ResultWriter writer(out, ResultKind::kUndistort);
  std::optional<Undistortion> undistortion;
  PinholeIntrinsics camera = read;
  Json pictures = Json::array();
  for (const fs::path& file : options.pictures) {
    const Picture picture = read_picture(file);
    camera = camera_of(undistortion ? camera : read, picture, file.string(), options.camera);
    if (!undistortion) {
      undistortion.emplace(camera, pool);
    }
    std::vector<ImageF> channels = channels_of(picture, file);
    for (ImageF& channel : channels) {
      channel = (*undistortion)(channel, pool);
    }
    pictures.push_back(
        {{"file", file.string()},
         {"written", write_picture(writer.path(), file.stem().string(), picture, channels)}});
  }
  write_file(writer.path() / "camera.toml", camera_toml(camera));
  writer.finish({{"pictures", pictures.size()},
                 {"source", source_seen_from(out, folder_undistorted(options))}},
                start);
  return {{"schema", 1},
          {"status", "done"},
          {"pictures", pictures},
          {"outside_share", undistortion->outside_share()},
          {"folder", out.string()}};
}

}  // namespace glint
