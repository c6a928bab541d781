// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell_camera/cell_camera.h"

#include <algorithm>
#include <array>
#include <chrono>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/wall_clock.h"
#include "hardware/camera/aravis_camera.h"
#include "hardware/camera/find_cameras.h"
#include "hardware/gige/discovery.h"
#include "hardware/robot/twin_proof.h"
#include "hardware/twin/side_channel/side_channel.h"
#include "studies/cell/ready_file.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

std::string moment_with_place(std::chrono::system_clock::time_point moment) {
  const auto since = moment.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since);
  return fmt::format(
      "{:%Y-%m-%dT%H:%M:%S}.{:06}Z",
      fmt::gmtime(
          std::chrono::system_clock::to_time_t(std::chrono::system_clock::time_point(seconds))),
      std::chrono::duration_cast<std::chrono::microseconds>(since - seconds).count());
}

Json described(const CameraDescription& camera) {
  Json formats = Json::array();
  for (const PixelFormat format : camera.formats) {
    formats.push_back(name_of(format));
  }
  return {{"id", camera.id},
          {"address", camera.address},
          {"vendor", camera.vendor},
          {"model", camera.model},
          {"serial", camera.serial},
          {"sensor_px", {camera.sensor_width_px, camera.sensor_height_px}},
          {"formats", formats},
          {"exposure_us", {camera.min_exposure_us, camera.max_exposure_us}},
          {"gain", {camera.min_gain, camera.max_gain}},
          {"gain_unit", camera.is_gain_in_db ? "dB" : "steps"},
          {"packet_bytes", camera.packet_size},
          {"packet_sockets", camera.has_packet_sockets}};
}

/// What a picture's grey values say.
void add_levels(const Frame& frame, Json& json) {
  double sum = 0.0;
  std::int64_t clipped = 0;
  const int largest = (1 << bits_of(frame.format)) - 1;
  for (const std::uint16_t code : frame.codes.values()) {
    sum += code;
    clipped += code == largest ? 1 : 0;
  }
  const auto pixels = static_cast<double>(frame.codes.size());
  json["mean_grey"] = sum / pixels / largest;
  json["clipped_share"] = static_cast<double>(clipped) / pixels;
}

Json told_frame(const Frame& frame, const std::string& file) {
  Json json = {{"file", file},
               {"status", name_of(frame.status)},
               {"what", frame.what},
               {"frame_id", frame.frame_id},
               {"camera_time_ns", nullptr},
               {"host_time", nullptr},
               {"exposure_us", frame.exposure_us},
               {"gain", frame.gain},
               {"retakes", frame.retakes},
               {"late_frames", frame.late_frames}};
  if (!frame.is_complete()) {
    return json;
  }
  if (frame.camera_time_ns != 0) {
    json["camera_time_ns"] = frame.camera_time_ns;
  }
  json["host_time"] = moment_with_place(frame.host_time);
  add_levels(frame, json);
  return json;
}

/// A field of a table that is empty where nothing is known.
std::string field_of(const Json& value) {
  return value.is_null() ? "" : value.is_string() ? value.get<std::string>() : value.dump();
}

std::string csv_of(const Json& frames) {
  std::string text = csv_row_of("file",
                                "status",
                                "frame_id",
                                "camera_time_ns",
                                "host_time",
                                "exposure_us",
                                "gain",
                                "retakes",
                                "late_frames");
  for (const Json& frame : frames) {
    text += csv_row_of(frame["file"].get<std::string>(),
                       frame["status"].get<std::string>(),
                       frame["frame_id"].get<std::uint64_t>(),
                       field_of(frame["camera_time_ns"]),
                       field_of(frame["host_time"]),
                       frame["exposure_us"].get<double>(),
                       frame["gain"].get<double>(),
                       frame["retakes"].get<int>(),
                       frame["late_frames"].get<int>());
  }
  return text;
}

/// The pictures of a run, one after the other.
struct Grabbed {
  Json frames = Json::array();
  int complete = 0;
  int losses = 0;
  double seconds = 0.0;  ///< of taking pictures, without writing them
};

Grabbed grab_into(const fs::path& folder,
                  Camera& camera,
                  const GrabOptions& options,
                  const std::function<void(int, const Frame&)>& told) {
  Grabbed grabbed;
  const auto reopen_ms = std::chrono::milliseconds(static_cast<int>(1000.0 * options.reopen_s));
  for (int i = 0; i < options.count; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    Frame frame = camera.capture();
    if (frame.status == FrameStatus::kLost) {
      ++grabbed.losses;
      if (camera.reopen(reopen_ms)) {
        frame = camera.capture();
      }
    }
    grabbed.seconds += seconds_since(begin);
    const std::string file = frame.is_complete() ? fmt::format("frame_{:03}.png", i) : "";
    if (frame.is_complete()) {
      ++grabbed.complete;
      write_png(folder / file,
                linear_values(frame),
                bits_of(frame.format) == 8 ? PixelDepth::k8Bit : PixelDepth::k16Bit);
    }
    grabbed.frames.push_back(told_frame(frame, file));
    if (told) {
      told(i, frame);
    }
    if (camera.state() == CameraState::kLost) {
      break;
    }
  }
  return grabbed;
}

/// Photographs cannot be taken again as they were: those of an earlier call are kept.
void check_grab_folder(const fs::path& folder) {
  const std::array<std::string, 3> names = {"sequence", "frames.csv", "run.json"};
  check_result_folder(folder, ResultKind::kGrab, names);
  if (is_there(folder / "sequence")) {
    throw ConfigError(fmt::format(
        "{}: holds pictures that were grabbed before; choose another output folder, or remove "
        "this one",
        folder.string()));
  }
}

/// Robots that prove to be twins of this user: a side channel alone, as that of a twin on another
/// network that shares the folder, is none.
Json twin_robots() {
  const std::string host = "127.0.0.1";
  Json robots = Json::array();
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(twin_socket_path(0).parent_path(), none)) {
    const std::string name = entry.path().stem().string();
    if (!name.starts_with("robot-")) {
      continue;
    }
    const int port = std::atoi(name.c_str() + 6);
    if (is_proven_twin(host, port)) {
      robots.push_back({{"address", host}, {"rtde_port", port}, {"twin", true}});
    }
  }
  return robots;
}

}  // namespace

bool is_camera_twin(const std::string& address, const std::string& manufacturer_info) {
  if (manufacturer_info.empty()) {
    return false;
  }
  const auto told = ask_side_channel(camera_twin_socket(address), "token");
  return told && *told == manufacturer_info;
}

void check_camera_twin(const Cell& cell) {
  if (cell.twins.empty()) {
    return;
  }
  const std::string& address = camera_of(cell).address;
  check_twin_token(cell, address, cell.twin_tokens.camera, [&address] {
    constexpr int kTimeoutMs = 500;
    const std::array<std::uint32_t, 1> asked = {parse_ipv4(address).value_or(0)};
    for (const FoundDevice& device : discover_at(asked, kTimeoutMs)) {
      if (is_camera_twin(address, device.manufacturer_info)) {
        return std::optional(device.manufacturer_info);
      }
    }
    return std::optional<std::string>();
  });
}

Json list_cameras() {
  Json cameras = Json::array();
  for (const FoundCamera& camera : find_cameras()) {
    cameras.push_back({{"id", camera.id},
                       {"vendor", camera.vendor},
                       {"model", camera.model},
                       {"serial", camera.serial},
                       {"user_name", camera.user_name},
                       {"address", camera.address},
                       {"protocol", camera.protocol},
                       {"twin", is_camera_twin(camera.address, camera.manufacturer_info)}});
  }
  return {{"schema", 1}, {"status", "done"}, {"cameras", cameras}, {"robots", twin_robots()}};
}

CameraConfiguration camera_configuration_of(const CellCamera& camera) {
  CameraConfiguration configuration;
  configuration.format = camera.pixel_format;
  configuration.exposure_us = 1e6 * camera.exposure_s;
  configuration.gain_db = camera.gain_db;
  configuration.gain_raw = camera.gain_raw;
  if (camera.packet_bytes > 0) {
    configuration.packet_size = camera.packet_bytes;
  }
  if (!camera.region_px.empty()) {
    std::array<int, 4> region = {};
    for (std::size_t i = 0; i < region.size(); ++i) {
      region[i] = static_cast<int>(camera.region_px.at(i));
      if (static_cast<double>(region[i]) != camera.region_px[i]) {
        throw ConfigError("camera.region_px", "must be whole pixels");
      }
    }
    configuration.region = SensorRegion{
        .x_px = region[0], .y_px = region[1], .width_px = region[2], .height_px = region[3]};
  }
  for (const CellFeature& feature : camera.features) {
    configuration.features.emplace_back(feature.name, feature.value);
  }
  return configuration;
}

std::unique_ptr<Camera> open_camera_of(const CellCamera& camera) {
  std::string name = camera.address.empty() ? camera.id : camera.address;
  if (name.empty()) {
    const std::vector<FoundCamera> found = find_cameras();
    if (found.size() > 1) {
      throw ConfigError(
          "camera.id",
          fmt::format("is missing: {} cameras answer, glint cell list names them", found.size()));
    }
    if (found.empty()) {
      throw IoError("no camera answers");
    }
    name = found[0].address.empty() ? found[0].id : found[0].address;
  }
  return std::make_unique<AravisCamera>(name);
}

Json grab_pictures(const Cell& cell,
                   const GrabOptions& options,
                   const std::function<void(int, const Frame&)>& told) {
  const CellCamera& settings = camera_of(cell);
  const fs::path folder = options.out.empty()
                              ? default_result_folder(cell_name(cell.file), ResultKind::kGrab)
                              : options.out;
  check_grab_folder(folder);
  check_camera_twin(cell);
  const std::unique_ptr<Camera> camera = open_camera_of(settings);
  camera->configure(camera_configuration_of(settings));
  camera->start();
  OutputFolder output(folder);
  remove_stale_stages(folder);
  StagedFolder stage(folder, "sequence");
  const Grabbed grabbed = grab_into(stage.path(), *camera, options, told);
  const Json description = described(camera->description());
  camera->close();
  stage.commit();
  write_file(folder / "frames.csv", csv_of(grabbed.frames));
  Json run = provenance();
  run["verb"] = command_of(ResultKind::kGrab);
  run["camera"] = description;
  run["seconds"] = grabbed.seconds;
  write_file(folder / "run.json", run.dump(2) + "\n");
  output.keep();
  return {{"schema", 1},
          {"status", grabbed.complete == options.count ? "done" : "incomplete"},
          {"ok", grabbed.complete == options.count},
          {"folder", folder.string()},
          {"camera", description},
          {"count", options.count},
          {"complete", grabbed.complete},
          {"losses", grabbed.losses},
          {"frames_per_second", grabbed.complete / std::max(1e-9, grabbed.seconds)},
          {"frames", grabbed.frames}};
}

}  // namespace glint
