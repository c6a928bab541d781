// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/camera/camera_registers.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/genicam_xml.h"

namespace glint {
namespace {

namespace gev = gige_register;
namespace at = twin_register;

constexpr std::uint32_t kVersion12 = 0x00010002;
constexpr std::uint32_t kBigEndianUtf8 = 0x80000001;
constexpr std::uint32_t kLinkLocalAndPersistent = 0x00000005;
constexpr std::uint32_t kNanoseconds = 1'000'000'000;
constexpr std::uint32_t kHeartbeatMs = 3000;
constexpr std::uint32_t kDefaultPacketSize = 1500;
constexpr std::uint32_t kPacketSizeMask = 0xffff;
constexpr std::uint32_t kDoNotFragment = 1U << 30U;
/// Several registers in a packet, memory may be written, lost packets are sent again, answers may
/// be late, serial number.
constexpr std::uint32_t kCapability = 1U | (1U << 1U) | (1U << 2U) | (1U << 5U) | (1U << 30U);

bool is_real(std::uint32_t address) {
  return address == at::kExposureTime || address == at::kGain || address == at::kBlackLevel;
}

constexpr std::size_t kUserNameBytes = 16;

/// How many bytes a write to a register has.
std::size_t bytes_of_register(std::uint32_t address) {
  if (address == gev::kUserName) {
    return kUserNameBytes;
  }
  return is_real(address) ? 8 : 4;
}

bool is_binning(std::uint32_t address) {
  return address == at::kBinningHorizontal || address == at::kBinningVertical;
}

bool decides_size(std::uint32_t address) {
  return is_binning(address) || (address >= at::kWidth && address <= at::kPixelFormat);
}

bool is_writable(std::uint32_t address) {
  switch (address) {
    case gev::kHeartbeatTimeoutMs:
    case gev::kPrivilege:
    case gev::kStreamPort:
    case gev::kPacketSize:
    case gev::kPacketDelay:
    case gev::kStreamAddress:
    case gev::kUserName:
    case at::kAcquisitionMode:
    case at::kAcquisitionStart:
    case at::kAcquisitionStop:
    case at::kTriggerSelector:
    case at::kTriggerMode:
    case at::kTriggerSource:
    case at::kTriggerSoftware:
      return true;
    default:
      return decides_size(address) || is_real(address);
  }
}

GvcpStatus valid_if(bool holds) {
  return holds ? GvcpStatus::kSuccess : GvcpStatus::kInvalidParameter;
}

}  // namespace

bool changes_pictures(std::uint32_t address) {
  return is_real(address) || address == at::kPixelFormat;
}

CameraRegisters::CameraRegisters(const CameraTwinSettings& settings) {
  const std::string xml = genicam_xml();
  memory_.assign(at::kXml + xml.size() / 4 * 4 + 512, 0);
  std::ranges::copy(xml, memory_.begin() + at::kXml);
  store_number(gev::kVersion, kVersion12);
  store_number(gev::kDeviceMode, kBigEndianUtf8);
  store_number(gev::kMacHigh, 0x0200);  // locally administered
  store_number(gev::kMacLow, settings.address);
  store_number(gev::kIpConfiguration, kLinkLocalAndPersistent);
  store_number(gev::kCurrentIpConfiguration, kLinkLocalAndPersistent);
  store_number(gev::kCurrentIp, settings.address);
  store_number(gev::kSubnetMask, 0xff000000);
  store_text(gev::kManufacturer, settings.vendor, 32);
  store_text(gev::kModel, settings.model, 32);
  store_text(gev::kDeviceVersion, "1", 32);
  store_text(gev::kManufacturerInfo, settings.manufacturer_info, 48);
  store_text(gev::kSerial, settings.serial, 16);
  store_text(gev::kXmlUrl, fmt::format("Local:twin.xml;{:x};{:x}", at::kXml, xml.size()), 512);
  store_number(gev::kNetworkInterfaces, 1);
  store_number(gev::kStreamChannels, 1);
  store_number(gev::kCapability, kCapability);
  store_number(gev::kHeartbeatTimeoutMs, kHeartbeatMs);
  store_number(gev::kTickFrequencyLow, kNanoseconds);
  store_number(gev::kPacketSize, kDefaultPacketSize);
  store_number(at::kSensorWidth, static_cast<std::uint32_t>(settings.sensor_width_px));
  store_number(at::kSensorHeight, static_cast<std::uint32_t>(settings.sensor_height_px));
  store_number(at::kWidth, static_cast<std::uint32_t>(settings.sensor_width_px));
  store_number(at::kHeight, static_cast<std::uint32_t>(settings.sensor_height_px));
  store_number(at::kBinningHorizontal, 1);
  store_number(at::kBinningVertical, 1);
  store_number(at::kPixelFormat, genicam_number(PixelFormat::kMono8));
  const CaptureSettings defaults;
  store_real(at::kExposureTime, defaults.exposure_us);
  store_real(at::kGain, defaults.gain_db);
  store_real(at::kBlackLevel, defaults.black_level);
  update_payload_size();
}

BytesView CameraRegisters::read(std::uint32_t address, std::size_t size) const {
  if (address > memory_.size() || size > memory_.size() - address) {
    return {};
  }
  return BytesView(memory_).subspan(address, size);
}

std::uint32_t CameraRegisters::read_number(std::uint32_t address) const {
  return read_u32(memory_, address);
}

void CameraRegisters::store_number(std::uint32_t address, std::uint32_t value) {
  store_u32(memory_, address, value);
}

double CameraRegisters::read_real(std::uint32_t address) const {
  return std::bit_cast<double>((static_cast<std::uint64_t>(read_number(address)) << 32U) |
                               read_number(address + 4));
}

void CameraRegisters::store_real(std::uint32_t address, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  store_number(address, static_cast<std::uint32_t>(bits >> 32U));
  store_number(address + 4, static_cast<std::uint32_t>(bits & 0xffffffffU));
}

void CameraRegisters::store_text(std::uint32_t address, const std::string& text, std::size_t size) {
  std::ranges::copy(text.substr(0, size - 1), memory_.begin() + address);
}

GvcpStatus CameraRegisters::check_number(std::uint32_t address, std::uint32_t value) const {
  const std::uint64_t wide = value;
  switch (address) {
    case at::kWidth:
      return valid_if(value > 0 && wide + read_number(at::kOffsetX) <= full_width_px());
    case at::kHeight:
      return valid_if(value > 0 && wide + read_number(at::kOffsetY) <= full_height_px());
    case at::kOffsetX:
      return valid_if(wide + read_number(at::kWidth) <= full_width_px());
    case at::kOffsetY:
      return valid_if(wide + read_number(at::kHeight) <= full_height_px());
    case at::kBinningHorizontal:
    case at::kBinningVertical:
      return valid_if(value >= 1 && value <= kMaxTwinBinning);
    case at::kPixelFormat:
      return valid_if(pixel_format_of_number(value).has_value());
    case gev::kStreamAddress:
      return valid_if(value == 0 || is_loopback(value));
    case gev::kPacketSize:
      return valid_if((value & kPacketSizeMask) >= 576 && (value & kPacketSizeMask) <= 65000);
    case gev::kHeartbeatTimeoutMs:
      return valid_if(value >= 500);
    default:
      return GvcpStatus::kSuccess;
  }
}

GvcpStatus CameraRegisters::check_real(std::uint32_t address, double value) const {
  if (address == at::kExposureTime) {
    return valid_if(value >= kMinTwinExposureUs && value <= kMaxTwinExposureUs);
  }
  return valid_if(value >= 0.0 &&
                  value <= (address == at::kGain ? kMaxTwinGainDb : kMaxTwinBlackLevel));
}

GvcpStatus CameraRegisters::check(std::uint32_t address, BytesView bytes) const {
  const std::uint32_t value = read_u32(bytes, 0);
  if (!is_real(address)) {
    return check_number(address, value);
  }
  const std::uint64_t bits = (static_cast<std::uint64_t>(value) << 32U) | read_u32(bytes, 4);
  return check_real(address, std::bit_cast<double>(bits));
}

GvcpStatus CameraRegisters::write(std::uint32_t address, BytesView bytes, bool is_acquiring) {
  const std::size_t wanted = bytes_of_register(address);
  if (address % 4 != 0) {
    return GvcpStatus::kBadAlignment;
  }
  if (read(address, wanted).empty()) {
    return GvcpStatus::kInvalidAddress;
  }
  if (!is_writable(address) || bytes.size() != wanted) {
    return GvcpStatus::kWriteProtect;
  }
  if (is_acquiring && decides_size(address)) {
    return GvcpStatus::kAccessDenied;
  }
  const std::uint32_t value = read_u32(bytes, 0);
  const GvcpStatus status = check(address, bytes);
  if (status == GvcpStatus::kSuccess) {
    std::ranges::copy(bytes, memory_.begin() + address);
    if (address == gev::kPacketSize) {
      store_number(address, value & (kPacketSizeMask | kDoNotFragment));
    }
    if (is_binning(address)) {
      show_all();
    }
    update_payload_size();
  }
  return status;
}

std::uint32_t CameraRegisters::full_width_px() const {
  return read_number(at::kSensorWidth) / read_number(at::kBinningHorizontal);
}

std::uint32_t CameraRegisters::full_height_px() const {
  return read_number(at::kSensorHeight) / read_number(at::kBinningVertical);
}

void CameraRegisters::show_all() {
  store_number(at::kOffsetX, 0);
  store_number(at::kOffsetY, 0);
  store_number(at::kWidth, full_width_px());
  store_number(at::kHeight, full_height_px());
}

PixelFormat CameraRegisters::format() const {
  return pixel_format_of_number(read_number(at::kPixelFormat)).value_or(PixelFormat::kMono8);
}

CaptureSettings CameraRegisters::capture_settings() const {
  return {.exposure_us = read_real(at::kExposureTime),
          .gain_db = read_real(at::kGain),
          .black_level = read_real(at::kBlackLevel),
          .bits = bits_of(format())};
}

StreamLeader CameraRegisters::leader() const {
  return {.pixel_format = read_number(at::kPixelFormat),
          .width_px = read_number(at::kWidth),
          .height_px = read_number(at::kHeight),
          .offset_x_px = read_number(at::kOffsetX),
          .offset_y_px = read_number(at::kOffsetY)};
}

void CameraRegisters::update_payload_size() {
  const std::size_t pixels =
      static_cast<std::size_t>(read_number(at::kWidth)) * read_number(at::kHeight);
  store_number(at::kPayloadSize, static_cast<std::uint32_t>(bytes_of(format(), pixels)));
}

Image<std::uint16_t> CameraRegisters::binned(const Image<std::uint16_t>& sensor) const {
  const auto across = static_cast<int>(read_number(at::kBinningHorizontal));
  const auto down = static_cast<int>(read_number(at::kBinningVertical));
  Image<std::uint16_t> means(sensor.width() / across, sensor.height() / down);
  for (int y = 0; y < means.height(); ++y) {
    for (int x = 0; x < means.width(); ++x) {
      int sum = 0;
      for (int i = 0; i < across * down; ++i) {
        sum += sensor(across * x + i % across, down * y + i / across);
      }
      means(x, y) = static_cast<std::uint16_t>(sum / (across * down));
    }
  }
  return means;
}

Bytes CameraRegisters::payload_of(const Image<std::uint16_t>& whole) const {
  const bool is_binned =
      read_number(at::kBinningHorizontal) * read_number(at::kBinningVertical) > 1;
  const Image<std::uint16_t> means = is_binned ? binned(whole) : Image<std::uint16_t>();
  const Image<std::uint16_t>& sensor = is_binned ? means : whole;
  const StreamLeader region = leader();
  const auto width = static_cast<std::size_t>(region.width_px);
  if (static_cast<int>(region.width_px) == sensor.width() &&
      static_cast<int>(region.height_px) == sensor.height()) {
    return packed(sensor.values(), format());
  }
  std::vector<std::uint16_t> cut;
  cut.reserve(width * region.height_px);
  for (std::uint32_t y = 0; y < region.height_px; ++y) {
    const std::uint16_t* row =
        sensor.row(static_cast<int>(region.offset_y_px + y)) + region.offset_x_px;
    cut.insert(cut.end(), row, row + width);
  }
  return packed(cut, format());
}

}  // namespace glint
