// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any packets to a simulated camera, and any packets from one. The first byte tells who reads them;
// then each packet has its length before it. Registers keep values that a picture can have.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "core/error.h"
#include "hardware/gige/discovery.h"
#include "hardware/gige/packets.h"
#include "hardware/twin/camera/camera_registers.h"

namespace {

using glint::BytesView;

void write_registers(glint::CameraRegisters& registers, BytesView payload, bool is_acquiring) {
  for (std::size_t i = 0; i + 8 <= payload.size(); i += 8) {
    registers.write(glint::read_u32(payload, i), payload.subspan(i + 4, 4), is_acquiring);
  }
}

void serve(glint::CameraRegisters& registers, BytesView packet) {
  const auto request = glint::parse_gvcp_request(packet);
  if (!request) {
    return;
  }
  const BytesView payload = request->payload;
  switch (static_cast<glint::GvcpCommand>(request->command)) {
    case glint::GvcpCommand::kPacketResend: {
      const auto wanted = glint::parse_resend(*request);
      GLINT_CHECK(!wanted || payload.size() >= 12, "a request that is too short asks for nothing");
      break;
    }
    case glint::GvcpCommand::kReadMemory:
      if (payload.size() >= 8) {
        registers.read(glint::read_u32(payload, 0), glint::read_u16(payload, 6));
      }
      break;
    case glint::GvcpCommand::kWriteRegister:
      write_registers(registers, payload, request->wants_acknowledgement);
      break;
    case glint::GvcpCommand::kWriteMemory:
      if (payload.size() >= 8) {
        registers.write(glint::read_u32(payload, 0), payload.subspan(4), false);
      }
      break;
    default:
      break;
  }
  const glint::StreamLeader leader = registers.leader();
  GLINT_CHECK(leader.width_px > 0 && leader.height_px > 0, "a region has pixels");
  GLINT_CHECK(leader.offset_x_px + leader.width_px <= 2448, "a region lies on the sensor");
  GLINT_CHECK(leader.offset_y_px + leader.height_px <= 2050, "a region lies on the sensor");
  GLINT_CHECK(registers.capture_settings().exposure_us > 0.0, "an exposure takes time");
  GLINT_CHECK((registers.read_number(glint::gige_register::kPacketSize) & 0xffffU) > 36,
              "a packet has room for data");
}

void receive(glint::CameraRegisters& /*registers*/, BytesView packet) {
  if (const auto acknowledgement = glint::parse_gvcp_acknowledgement(packet)) {
    glint::parse_discovery(acknowledgement->payload);
  }
  glint::parse_stream_header(packet);
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using Read = void (*)(glint::CameraRegisters & registers, BytesView packet);
  constexpr Read kReaders[] = {serve, receive};
  if (size < 1) {
    return 0;
  }
  glint::CameraRegisters registers(glint::CameraTwinSettings{});
  BytesView rest(data + 1, size - 1);
  while (rest.size() > 1) {
    const std::size_t length = std::min<std::size_t>(rest[0], rest.size() - 1);
    kReaders[data[0] % std::size(kReaders)](registers, rest.subspan(1, length));
    rest = rest.subspan(1 + length);
  }
  return 0;
}
