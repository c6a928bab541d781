// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "hardware/camera/aravis.h"
#include "hardware/camera/aravis_camera.h"
#include "hardware/camera/find_cameras.h"
#include "hardware/camera/kept_features.h"
#include "hardware/camera/sensor_region.h"
#include "hardware/gige/udp_socket.h"

namespace glint {
namespace {

using aravis::Failure;
using aravis::Owner;
using aravis::text_of;

/// Whether this process may open raw sockets.
bool may_use_packet_sockets() {
  const int descriptor = ::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor >= 0) {
    ::close(descriptor);
  }
  return descriptor >= 0;
}

void check_range(const char* key, double value, double min, double max) {
  if (!(value >= min && value <= max)) {
    throw ConfigError(
        key, fmt::format("is {:.10g}, this camera allows {:.10g} to {:.10g}", value, min, max));
  }
}

class AravisDriver final : public CameraDriver {
 public:
  explicit AravisDriver(Owner<ArvCamera> camera) : camera_(std::move(camera)) {
    arv_camera_set_range_check_policy(camera_.get(), ARV_RANGE_CHECK_POLICY_ENABLE);
    arv_camera_set_access_check_policy(camera_.get(), ARV_ACCESS_CHECK_POLICY_ENABLE);
    g_signal_connect(device(), "control-lost", G_CALLBACK(on_control_lost), &is_control_lost_);
  }

  ~AravisDriver() override { g_signal_handlers_disconnect_by_data(device(), &is_control_lost_); }

  CameraDescription describe() override;
  DriverSettings configure(const CameraConfiguration& configuration) override;
  void start() override;
  void stop() override;
  void trigger() override;
  std::optional<DriverFrame> next_frame(std::chrono::milliseconds within) override;
  bool answers() override;

  bool has_lost_control() const override { return is_control_lost_; }

 private:
  static void on_control_lost(ArvDevice*, std::atomic<bool>* is_lost) { *is_lost = true; }

  ArvDevice* device() const { return arv_camera_get_device(camera_.get()); }

  bool is_network() const { return arv_camera_is_gv_device(camera_.get()) != FALSE; }

  /// By the newer name of the feature; else it is GainRaw.
  bool is_gain_in_db() const {
    return arv_device_is_feature_available(device(), "Gain", nullptr) != FALSE;
  }

  void describe_ranges(CameraDescription& description);
  void set_features(const NamedFeatures& features, bool are_of_size);
  void set_exposure(double exposure_us);
  void set_gain(const CameraConfiguration& configuration);
  void set_packets(const CameraConfiguration& configuration);
  void check_packet_size();
  DriverFrame frame_of(ArvBuffer* buffer) const;

  std::atomic<bool> is_control_lost_ = false;
  Owner<ArvCamera> camera_;
  Owner<ArvStream> stream_;
  CameraConfiguration configuration_;
};

std::vector<PixelFormat> available_formats(ArvCamera* camera) {
  std::vector<PixelFormat> formats;
  guint count = 0;
  const std::unique_ptr<gint64, aravis::Free> numbers(
      arv_camera_dup_available_pixel_formats(camera, &count, nullptr));
  for (guint i = 0; i < count; ++i) {
    if (const auto format =
            pixel_format_of_number(static_cast<std::uint32_t>(numbers.get()[i] & 0xffffffff))) {
      formats.push_back(*format);
    }
  }
  return formats;
}

/// Its present IP address; empty when it does not say.
std::string address_of(ArvDevice* device) {
  std::string address;
  GInetAddress* ip = nullptr;
  if (arv_gv_device_get_current_ip(ARV_GV_DEVICE(device), &ip, nullptr, nullptr, nullptr) !=
          FALSE &&
      ip != nullptr) {
    const std::unique_ptr<char, aravis::Free> text(g_inet_address_to_string(ip));
    address = text_of(text.get());
    g_object_unref(ip);
  }
  return address;
}

CameraDescription AravisDriver::describe() {
  ArvCamera* camera = camera_.get();
  CameraDescription description;
  description.vendor = text_of(arv_camera_get_vendor_name(camera, nullptr));
  description.model = text_of(arv_camera_get_model_name(camera, nullptr));
  description.serial = text_of(arv_camera_get_device_serial_number(camera, nullptr));
  description.id = description.vendor + "-" + description.serial;
  Failure failure;
  arv_camera_get_sensor_size(
      camera, &description.sensor_width_px, &description.sensor_height_px, failure.slot());
  failure.check("sensor size");
  description.formats = available_formats(camera);
  describe_ranges(description);
  description.has_software_trigger =
      arv_camera_is_software_trigger_supported(camera, nullptr) != FALSE;
  description.has_packet_sockets = may_use_packet_sockets();
  if (is_network()) {
    description.packet_size = static_cast<int>(arv_camera_gv_get_packet_size(camera, nullptr));
    description.address = address_of(device());
  }
  return description;
}

void AravisDriver::describe_ranges(CameraDescription& description) {
  ArvCamera* camera = camera_.get();
  Failure failure;
  arv_camera_get_exposure_time_bounds(
      camera, &description.min_exposure_us, &description.max_exposure_us, failure.slot());
  failure.check("exposure");
  description.has_gain = arv_camera_is_gain_available(camera, nullptr) != FALSE;
  description.is_gain_in_db = is_gain_in_db();
  if (description.has_gain) {
    arv_camera_get_gain_bounds(camera, &description.min_gain, &description.max_gain, nullptr);
  }
}

/// By which pixels of the sensor one of a picture is made: what a region may be depends on them.
bool is_of_size(const std::string& feature) {
  return feature.starts_with("Binning") || feature.starts_with("Decimation");
}

void AravisDriver::set_features(const NamedFeatures& features, bool are_of_size) {
  for (const auto& [name, value] : features) {
    if (is_of_size(name) == are_of_size) {
      aravis::set_feature(device(), name, value, "features." + name);
    }
  }
}

void AravisDriver::set_exposure(double exposure_us) {
  ArvCamera* camera = camera_.get();
  double min = 0.0;
  double max = 0.0;
  Failure failure;
  arv_camera_get_exposure_time_bounds(camera, &min, &max, failure.slot());
  failure.check("exposure_us");
  check_range("exposure_us", exposure_us, min, max);
  if (arv_camera_is_exposure_auto_available(camera, nullptr) != FALSE) {
    arv_camera_set_exposure_time_auto(camera, ARV_AUTO_OFF, nullptr);
  }
  arv_camera_set_exposure_time(camera, exposure_us, failure.slot());
  failure.check("exposure_us");
}

void AravisDriver::set_gain(const CameraConfiguration& configuration) {
  ArvCamera* camera = camera_.get();
  if (arv_camera_is_gain_auto_available(camera, nullptr) != FALSE) {
    arv_camera_set_gain_auto(camera, ARV_AUTO_OFF, nullptr);  // grey values of a run are compared
  }
  if (!configuration.gain_db && !configuration.gain_raw) {
    return;
  }
  const char* const key = configuration.gain_db ? "gain_db" : "gain_raw";
  const double gain = configuration.gain_db ? *configuration.gain_db : *configuration.gain_raw;
  if (arv_camera_is_gain_available(camera, nullptr) == FALSE) {
    throw ConfigError(key, "this camera has no gain");
  }
  double min = 0.0;
  double max = 0.0;
  Failure failure;
  arv_camera_get_gain_bounds(camera, &min, &max, failure.slot());
  failure.check(key);
  const bool is_in_db = is_gain_in_db();
  if (configuration.gain_db.has_value() != is_in_db) {
    throw ConfigError(key,
                      fmt::format("this camera's gain is in {}: give {}, {:.10g} to {:.10g}",
                                  is_in_db ? "dB" : "steps of its own",
                                  is_in_db ? "gain_db" : "gain_raw",
                                  min,
                                  max));
  }
  check_range(key, gain, min, max);
  arv_camera_set_gain(camera, gain, failure.slot());
  failure.check(key);
}

// The test packet is sent when the stream is made.
void AravisDriver::set_packets(const CameraConfiguration& configuration) {
  if (!is_network()) {
    return;
  }
  arv_camera_gv_set_packet_size_adjustment(camera_.get(), ARV_GV_PACKET_SIZE_ADJUSTMENT_ON_FAILURE);
  arv_camera_gv_set_stream_options(camera_.get(),
                                   configuration.uses_packet_sockets
                                       ? ARV_GV_STREAM_OPTION_NONE
                                       : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  if (configuration.packet_size) {
    Failure failure;
    arv_camera_gv_set_packet_size(camera_.get(), *configuration.packet_size, failure.slot());
    failure.check("packet_bytes");
  }
}

DriverSettings AravisDriver::configure(const CameraConfiguration& configuration) {
  ArvCamera* camera = camera_.get();
  Failure failure;
  aravis::restore_features(device(), configuration.restored);
  arv_camera_set_pixel_format_from_string(
      camera, std::string(name_of(configuration.format)).c_str(), failure.slot());
  failure.check("pixel_format");
  set_features(configuration.features, true);
  aravis::set_region(camera, configuration.region);
  set_exposure(configuration.exposure_us);
  set_gain(configuration);
  set_features(configuration.features, false);
  arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, failure.slot());
  failure.check("acquisition mode");
  arv_camera_set_trigger(camera, "Software", failure.slot());
  failure.check("software trigger");
  set_packets(configuration);
  configuration_ = configuration;
  DriverSettings settings = {.description = describe()};
  settings.exposure_us = arv_camera_get_exposure_time(camera, failure.slot());
  failure.check("exposure_us");
  settings.gain = settings.description.has_gain ? arv_camera_get_gain(camera, nullptr) : 0.0;
  settings.others = aravis::kept_features(device());
  return settings;
}

void AravisDriver::check_packet_size() {
  if (!is_network() || !configuration_.packet_size) {
    return;
  }
  const auto size = static_cast<int>(arv_camera_gv_get_packet_size(camera_.get(), nullptr));
  if (size < *configuration_.packet_size) {
    throw ConfigError("packet_bytes",
                      fmt::format("packets of {} bytes do not get through, at most {} do",
                                  *configuration_.packet_size,
                                  size));
  }
}

void AravisDriver::start() {
  ArvCamera* camera = camera_.get();
  Failure failure;
  stream_.reset();  // of a start that was refused: it would end the new one's
  stream_.reset(arv_camera_create_stream(camera, nullptr, nullptr, failure.slot()));
  failure.check("stream");
  check_packet_size();
  const guint payload = arv_camera_get_payload(camera, failure.slot());
  failure.check("payload");
  if (is_network()) {
    constexpr gint kSocketBytes = 16 << 20;
    g_object_set(stream_.get(),
                 "socket-buffer",
                 ARV_GV_STREAM_SOCKET_BUFFER_FIXED,
                 "socket-buffer-size",
                 kSocketBytes,
                 nullptr);
  }
  for (int i = 0; i < kBuffers; ++i) {
    arv_stream_push_buffer(stream_.get(), arv_buffer_new(payload, nullptr));
  }
  arv_camera_start_acquisition(camera, failure.slot());
  failure.check("start of the acquisition");
}

void AravisDriver::stop() {
  Failure failure;
  arv_camera_stop_acquisition(camera_.get(), failure.slot());
  stream_.reset();
  failure.check("stop of the acquisition");
}

void AravisDriver::trigger() {
  Failure failure;
  arv_camera_software_trigger(camera_.get(), failure.slot());
  if (failure.is_refusal()) {
    throw TriggerRefused("the camera refuses the trigger: " + failure.text());
  }
  if (failure) {
    throw IoError("the trigger is not answered: " + failure.text());
  }
}

std::string text_of_status(ArvBufferStatus status) {
  switch (status) {
    case ARV_BUFFER_STATUS_TIMEOUT:
      return "packets did not come in time";
    case ARV_BUFFER_STATUS_MISSING_PACKETS:
      return "packets are missing";
    case ARV_BUFFER_STATUS_SIZE_MISMATCH:
      return "it is larger than the camera had said";
    default:
      return fmt::format("Aravis reports status {}", static_cast<int>(status));
  }
}

DriverFrame AravisDriver::frame_of(ArvBuffer* buffer) const {
  DriverFrame frame;
  const ArvBufferStatus status = arv_buffer_get_status(buffer);
  frame.frame_id = arv_buffer_get_frame_id(buffer);
  frame.is_complete = status == ARV_BUFFER_STATUS_SUCCESS;
  if (!frame.is_complete) {
    frame.what = text_of_status(status);
    return frame;
  }
  frame.camera_time_ns = arv_buffer_get_timestamp(buffer);
  frame.host_time = std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(
          std::chrono::nanoseconds(arv_buffer_get_system_timestamp(buffer))));
  const auto number = static_cast<std::uint32_t>(arv_buffer_get_image_pixel_format(buffer));
  const auto format = pixel_format_of_number(number);
  if (!format || *format != configuration_.format) {
    frame.is_complete = false;
    frame.what = fmt::format(
        "it has the pixel format {:#010x}, not {}", number, name_of(configuration_.format));
    return frame;
  }
  std::size_t size = 0;
  const void* data = arv_buffer_get_data(buffer, &size);
  frame.format = *format;
  frame.codes = unpacked({static_cast<const std::uint8_t*>(data), size},
                         *format,
                         arv_buffer_get_image_width(buffer),
                         arv_buffer_get_image_height(buffer));
  return frame;
}

std::optional<DriverFrame> AravisDriver::next_frame(std::chrono::milliseconds within) {
  const auto microseconds = static_cast<guint64>(std::chrono::microseconds(within).count());
  ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_.get(), microseconds);
  if (buffer == nullptr) {
    return std::nullopt;
  }
  DriverFrame frame;
  try {
    frame = frame_of(buffer);
  } catch (const ConfigError& error) {
    frame.what = error.what();  // fewer bytes than a picture of its size has
  }
  arv_stream_push_buffer(stream_.get(), buffer);
  return frame;
}

bool AravisDriver::answers() {
  Failure failure;
  arv_camera_get_payload(camera_.get(), failure.slot());
  return !failure && !has_lost_control();
}

}  // namespace

std::unique_ptr<CameraDriver> open_aravis_driver(const std::string& name) {
  std::string address = name;
  if (!name.empty() && !parse_ipv4(name)) {
    for (const FoundCamera& camera : find_cameras_at({}, 100)) {
      address = camera.id == name ? camera.address : address;
    }
  }
  Failure failure;
  Owner<ArvCamera> camera(
      arv_camera_new(address.empty() ? nullptr : address.c_str(), failure.slot()));
  if (!camera) {
    throw IoError(
        fmt::format("camera {}: {}", name.empty() ? "(the first one)" : name, failure.text()));
  }
  if (arv_camera_is_gv_device(camera.get()) != FALSE &&
      arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(camera.get()))) == FALSE) {
    throw IoError(fmt::format("camera {}: another program controls it", name));
  }
  return std::make_unique<AravisDriver>(std::move(camera));
}

}  // namespace glint
