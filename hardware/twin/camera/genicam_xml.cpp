// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/camera/genicam_xml.h"

#include <initializer_list>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"
#include "hardware/camera/pixel_format.h"
#include "hardware/gige/packets.h"

namespace glint {
namespace {

constexpr std::string_view kHead = R"(<?xml version="1.0" encoding="utf-8"?>
<RegisterDescription ModelName="CameraTwin" VendorName="Glint" StandardNameSpace="GEV"
 ToolTip="A simulated camera" SchemaMajorVersion="1" SchemaMinorVersion="1"
 SchemaSubMinorVersion="0" MajorVersion="1" MinorVersion="0" SubMinorVersion="0"
 ProductGuid="8f1a2c30-4b1d-4a55-9a3e-6b4f6c696e74" VersionGuid="8f1a2c31-4b1d-4a55-9a3e-6b4f6c696e74"
 xmlns="http://www.genicam.org/GenApi/Version_1_1"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xsi:schemaLocation="http://www.genicam.org/GenApi/Version_1_1 GenApiSchema_Version_1_1.xsd">
)";

std::string category(std::string_view name, std::initializer_list<std::string_view> features) {
  std::string text = fmt::format("<Category Name=\"{}\" NameSpace=\"Standard\">\n", name);
  for (const std::string_view feature : features) {
    text += fmt::format("  <pFeature>{}</pFeature>\n", feature);
  }
  return text + "</Category>\n";
}

std::string string_register(std::string_view name,
                            std::uint32_t address,
                            int length,
                            std::string_view mode = "RO") {
  return fmt::format(
      "<StringReg Name=\"{}\" NameSpace=\"Standard\"><Address>{:#x}</Address>"
      "<Length>{}</Length><AccessMode>{}</AccessMode><pPort>Device</pPort></StringReg>\n",
      name,
      address,
      length,
      mode);
}

std::string integer_register(std::string_view name, std::uint32_t address, std::string_view mode) {
  return fmt::format(
      "<IntReg Name=\"{}\"><Address>{:#x}</Address><Length>4</Length>"
      "<AccessMode>{}</AccessMode><pPort>Device</pPort><Cachable>NoCache</Cachable>"
      "<Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>\n",
      name,
      address,
      mode);
}

/// @param bounds  elements between value and increment
std::string integer(std::string_view name,
                    std::uint32_t address,
                    std::string_view mode,
                    std::string_view bounds) {
  return fmt::format(
             "<Integer Name=\"{0}\" NameSpace=\"Standard\"><pValue>{0}Reg</pValue>{1}</Integer>\n",
             name,
             bounds) +
         integer_register(fmt::format("{}Reg", name), address, mode);
}

/// One bit of a register of 32. @param bit  counted from the highest, as GigE Vision does
std::string flag(std::string_view name, std::uint32_t address, int bit) {
  return fmt::format(
      "<Boolean Name=\"{0}\" NameSpace=\"Standard\"><pValue>{0}Reg</pValue></Boolean>\n"
      "<MaskedIntReg Name=\"{0}Reg\"><Address>{1:#x}</Address><Length>4</Length>"
      "<AccessMode>RW</AccessMode><pPort>Device</pPort><Cachable>NoCache</Cachable>"
      "<LSB>{2}</LSB><MSB>{2}</MSB><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess>"
      "</MaskedIntReg>\n",
      name,
      address,
      bit);
}

std::string command(std::string_view name, std::uint32_t address) {
  return fmt::format(
             "<Command Name=\"{0}\" NameSpace=\"Standard\"><pValue>{0}Reg</pValue>"
             "<CommandValue>1</CommandValue></Command>\n",
             name) +
         integer_register(fmt::format("{}Reg", name), address, "RW");
}

std::string enumeration(std::string_view name,
                        std::uint32_t address,
                        const std::vector<std::pair<std::string_view, std::uint32_t>>& entries) {
  std::string text = fmt::format("<Enumeration Name=\"{}\" NameSpace=\"Standard\">\n", name);
  for (const auto& [entry, value] : entries) {
    text += fmt::format(
        "  <EnumEntry Name=\"{}\" NameSpace=\"Standard\"><Value>{}</Value></EnumEntry>\n",
        entry,
        value);
  }
  return text + fmt::format("  <pValue>{0}Reg</pValue>\n</Enumeration>\n", name) +
         integer_register(fmt::format("{}Reg", name), address, "RW");
}

std::string number(
    std::string_view name, std::uint32_t address, double min, double max, std::string_view unit) {
  return fmt::format(
      "<Float Name=\"{0}\" NameSpace=\"Standard\"><pValue>{0}Reg</pValue><Min>{1}</Min>"
      "<Max>{2}</Max><Unit>{3}</Unit></Float>\n"
      "<FloatReg Name=\"{0}Reg\"><Address>{4:#x}</Address><Length>8</Length>"
      "<AccessMode>RW</AccessMode><pPort>Device</pPort><Cachable>NoCache</Cachable>"
      "<Endianess>BigEndian</Endianess></FloatReg>\n",
      name,
      min,
      max,
      unit,
      address);
}

std::string categories() {
  return category("Root",
                  {"DeviceControl",
                   "ImageFormatControl",
                   "AcquisitionControl",
                   "AnalogControl",
                   "TransportLayerControl"}) +
         category("DeviceControl",
                  {"DeviceVendorName",
                   "DeviceModelName",
                   "DeviceVersion",
                   "DeviceSerialNumber",
                   "DeviceUserID"}) +
         category("ImageFormatControl",
                  {"SensorWidth",
                   "SensorHeight",
                   "BinningHorizontal",
                   "BinningVertical",
                   "Width",
                   "Height",
                   "OffsetX",
                   "OffsetY",
                   "PixelFormat"}) +
         category("AcquisitionControl",
                  {"AcquisitionMode",
                   "AcquisitionStart",
                   "AcquisitionStop",
                   "TriggerSelector",
                   "TriggerMode",
                   "TriggerSource",
                   "TriggerSoftware",
                   "ExposureTime"}) +
         category("AnalogControl", {"Gain", "BlackLevel"}) +
         category(
             "TransportLayerControl",
             {"PayloadSize", "GevSCPSPacketSize", "GevSCPSFireTestPacket", "GevHeartbeatTimeout"});
}

std::string image_features() {
  std::vector<std::pair<std::string_view, std::uint32_t>> formats;
  for (const PixelFormat format : kPixelFormats) {
    formats.emplace_back(name_of(format), genicam_number(format));
  }
  const auto side = [](std::string_view name, std::string_view axis, std::string_view other) {
    return fmt::format(
        "<IntSwissKnife Name=\"{0}Max\"><pVariable Name=\"S\">Sensor{1}Reg</pVariable>"
        "<pVariable Name=\"B\">Binning{2}Reg</pVariable><pVariable Name=\"O\">{3}Reg</pVariable>"
        "<Formula>S / B - O</Formula></IntSwissKnife>\n",
        name,
        axis,
        axis == "Width" ? "Horizontal" : "Vertical",
        other);
  };
  const std::string binning = fmt::format("<Min>1</Min><Max>{}</Max>", kMaxTwinBinning);
  namespace at = twin_register;
  return integer("SensorWidth", at::kSensorWidth, "RO", "") +
         integer("SensorHeight", at::kSensorHeight, "RO", "") + side("Width", "Width", "OffsetX") +
         side("Height", "Height", "OffsetY") + side("OffsetX", "Width", "Width") +
         side("OffsetY", "Height", "Height") +
         integer("BinningHorizontal", at::kBinningHorizontal, "RW", binning) +
         integer("BinningVertical", at::kBinningVertical, "RW", binning) +
         integer("Width", at::kWidth, "RW", "<Min>1</Min><pMax>WidthMax</pMax>") +
         integer("Height", at::kHeight, "RW", "<Min>1</Min><pMax>HeightMax</pMax>") +
         integer("OffsetX", at::kOffsetX, "RW", "<Min>0</Min><pMax>OffsetXMax</pMax>") +
         integer("OffsetY", at::kOffsetY, "RW", "<Min>0</Min><pMax>OffsetYMax</pMax>") +
         enumeration("PixelFormat", at::kPixelFormat, formats);
}

std::string acquisition_features() {
  namespace at = twin_register;
  return enumeration("AcquisitionMode", at::kAcquisitionMode, {{"Continuous", 0}}) +
         command("AcquisitionStart", at::kAcquisitionStart) +
         command("AcquisitionStop", at::kAcquisitionStop) +
         enumeration("TriggerSelector", at::kTriggerSelector, {{"FrameStart", 0}}) +
         enumeration("TriggerMode", at::kTriggerMode, {{"Off", 0}, {"On", 1}}) +
         enumeration("TriggerSource", at::kTriggerSource, {{"Software", 0}}) +
         command("TriggerSoftware", at::kTriggerSoftware) +
         number("ExposureTime", at::kExposureTime, kMinTwinExposureUs, kMaxTwinExposureUs, "us") +
         number("Gain", at::kGain, 0.0, kMaxTwinGainDb, "dB") +
         number("BlackLevel", at::kBlackLevel, 0.0, kMaxTwinBlackLevel, "DN");
}

}  // namespace

std::string genicam_xml() {
  namespace gev = gige_register;
  return std::string(kHead) + categories() +
         string_register("DeviceVendorName", gev::kManufacturer, 32) +
         string_register("DeviceModelName", gev::kModel, 32) +
         string_register("DeviceVersion", gev::kDeviceVersion, 32) +
         string_register("DeviceSerialNumber", gev::kSerial, 16) +
         string_register("DeviceUserID", gev::kUserName, 16, "RW") + image_features() +
         acquisition_features() + integer("PayloadSize", twin_register::kPayloadSize, "RO", "") +
         integer("GevSCPSPacketSize", gev::kPacketSize, "RW", "<Min>576</Min><Max>65000</Max>") +
         flag("GevSCPSFireTestPacket", gev::kPacketSize, 0) +
         integer("GevHeartbeatTimeout", gev::kHeartbeatTimeoutMs, "RW", "<Min>500</Min>") +
         "<Port Name=\"Device\" NameSpace=\"Standard\"/>\n</RegisterDescription>\n";
}

}  // namespace glint
