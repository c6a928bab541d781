// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the simulated camera tells about itself: its features, by their names in the Standard
// Features Naming Convention, and the registers behind them.
#pragma once

#include <cstdint>
#include <string>

namespace glint {

namespace twin_register {
inline constexpr std::uint32_t kWidth = 0x10100;
inline constexpr std::uint32_t kHeight = 0x10104;
inline constexpr std::uint32_t kOffsetX = 0x10108;
inline constexpr std::uint32_t kOffsetY = 0x1010c;
inline constexpr std::uint32_t kPixelFormat = 0x10110;
inline constexpr std::uint32_t kSensorWidth = 0x10114;
inline constexpr std::uint32_t kSensorHeight = 0x10118;
inline constexpr std::uint32_t kPayloadSize = 0x1011c;
inline constexpr std::uint32_t kAcquisitionMode = 0x10200;
inline constexpr std::uint32_t kAcquisitionStart = 0x10204;
inline constexpr std::uint32_t kAcquisitionStop = 0x10208;
inline constexpr std::uint32_t kTriggerSelector = 0x10210;
inline constexpr std::uint32_t kTriggerMode = 0x10214;
inline constexpr std::uint32_t kTriggerSource = 0x10218;
inline constexpr std::uint32_t kTriggerSoftware = 0x1021c;
inline constexpr std::uint32_t kExposureTime = 0x10220;  ///< three numbers of 8 bytes
inline constexpr std::uint32_t kGain = 0x10228;
inline constexpr std::uint32_t kBlackLevel = 0x10230;
inline constexpr std::uint32_t kBinningHorizontal = 0x10238;
inline constexpr std::uint32_t kBinningVertical = 0x1023c;
inline constexpr std::uint32_t kXml = 0x20000;
}  // namespace twin_register

inline constexpr double kMinTwinExposureUs = 10.0;
inline constexpr double kMaxTwinExposureUs = 1e7;
inline constexpr double kMaxTwinGainDb = 24.0;
inline constexpr double kMaxTwinBlackLevel = 255.0;
inline constexpr std::uint32_t kMaxTwinBinning = 4;

/// GenApi 1.1.
std::string genicam_xml();

}  // namespace glint
