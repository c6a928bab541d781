// SPDX-License-Identifier: GPL-3.0-or-later
//
// The memory of a simulated camera as its client reads and writes it, and what its features are set
// to. Knows no network.
#pragma once

#include <cstdint>
#include <string>

#include "hardware/gige/packets.h"
#include "hardware/twin/camera/picture_source.h"

namespace glint {

struct CameraTwinSettings {
  std::uint32_t address = 0x7f000001;  ///< in 127.0.0.0/8
  std::string vendor = "Glint";
  std::string model = "CameraTwin";
  std::string serial = "TWIN01";
  std::string manufacturer_info = "a simulated camera";  ///< at most 47 characters
  int sensor_width_px = 2448;
  int sensor_height_px = 2050;
  std::uint16_t first_frame_id = 1;  ///< 1 to 65535
  double bytes_per_second = 250e6;   ///< of the cable
};

class CameraRegisters {
 public:
  explicit CameraRegisters(const CameraTwinSettings& settings);

  /// Empty where nothing is. @param size  a multiple of 4
  BytesView read(std::uint32_t address, std::size_t size) const;

  std::uint32_t read_number(std::uint32_t address) const;

  /// Checks and stores; what a register sets off is not done here.
  /// @param is_acquiring  what decides the size of a picture cannot be changed then
  GvcpStatus write(std::uint32_t address, BytesView bytes, bool is_acquiring);

  /// Without checks.
  void store_number(std::uint32_t address, std::uint32_t value);

  CaptureSettings capture_settings() const;
  PixelFormat format() const;

  /// What is sent of the sensor.
  StreamLeader leader() const;

  /// The picture's bytes: binned pixels as their means, the region cut out, in the pixel format.
  Bytes payload_of(const Image<std::uint16_t>& whole) const;

 private:
  double read_real(std::uint32_t address) const;
  void store_real(std::uint32_t address, double value);
  void store_text(std::uint32_t address, const std::string& text, std::size_t size);
  GvcpStatus check(std::uint32_t address, BytesView bytes) const;
  GvcpStatus check_number(std::uint32_t address, std::uint32_t value) const;
  GvcpStatus check_real(std::uint32_t address, double value) const;
  void update_payload_size();
  std::uint32_t full_width_px() const;  ///< of the sensor, in binned pixels
  std::uint32_t full_height_px() const;
  void show_all();
  Image<std::uint16_t> binned(const Image<std::uint16_t>& sensor) const;

  Bytes memory_;
};

/// Whether the address is one of a feature that changes the pictures.
bool changes_pictures(std::uint32_t address);

}  // namespace glint
