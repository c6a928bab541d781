// SPDX-License-Identifier: GPL-3.0-or-later
//
// A client that hears no answer sends its request again under the same id, as GigE Vision's control
// protocol has it: it is answered as it was, and nothing is done twice.
#include <bit>
#include <thread>

#include <gtest/gtest.h>

#include "hardware/twin/camera/genicam_xml.h"
#include "hardware/twin/camera/gvcp_server.h"
#include "hardware/twin/camera/test_pattern.h"
#include "tests/hardware/twin/camera/twin_process.h"

namespace glint {
namespace {

using std::chrono::milliseconds;

constexpr std::uint8_t kWantsAcknowledgement = 1;
constexpr double kExposureUs = 300e3;

Bytes numbers(std::initializer_list<std::uint32_t> values) {
  Bytes bytes;
  for (const std::uint32_t value : values) {
    append_u32(bytes, value);
  }
  return bytes;
}

class RepeatedRequests : public testing::Test {
 protected:
  RepeatedRequests() {
    EXPECT_EQ(status_of(write(1, gige_register::kPrivilege, 2)), GvcpStatus::kSuccess);
    const auto exposure = std::bit_cast<std::uint64_t>(kExposureUs);
    EXPECT_EQ(status_of(ask(client_,
                            GvcpCommand::kWriteMemory,
                            2,
                            numbers({twin_register::kExposureTime,
                                     static_cast<std::uint32_t>(exposure >> 32U),
                                     static_cast<std::uint32_t>(exposure)}))),
              GvcpStatus::kSuccess);
    EXPECT_EQ(status_of(write(3, twin_register::kAcquisitionStart, 1)), GvcpStatus::kSuccess);
  }

  /// The answer; empty: none.
  Bytes ask(UdpSocket& from, GvcpCommand command, std::uint16_t id, const Bytes& payload) {
    from.send({.address = address_, .port = kGvcpPort},
              gvcp_request(command, id, payload, kWantsAcknowledgement));
    Bytes answer;
    Endpoint sender;
    for (int i = 0; i < 100; ++i) {
      server_.step();
      if (from.wait(milliseconds(1)) && from.receive(answer, sender)) {
        return answer;
      }
    }
    return {};
  }

  Bytes write(std::uint16_t id, std::uint32_t address, std::uint32_t value) {
    return ask(client_, GvcpCommand::kWriteRegister, id, numbers({address, value}));
  }

  Bytes trigger(std::uint16_t id) { return write(id, twin_register::kTriggerSoftware, 1); }

  static GvcpStatus status_of(const Bytes& answer) {
    const auto parsed = parse_gvcp_acknowledgement(answer);
    return parsed ? static_cast<GvcpStatus>(parsed->status) : GvcpStatus::kNotImplemented;
  }

  std::uint32_t address_ = test_address(31);
  TestPatternSource source_{64, 48};
  GvcpServer server_{{.address = address_, .sensor_width_px = 64, .sensor_height_px = 48}, source_};
  UdpSocket client_{{.address = 0x7f000001, .port = 0}};
  UdpSocket other_{{.address = 0x7f000001, .port = 0}};
};

TEST_F(RepeatedRequests, ATriggerHasItsFirstAnswerAndTakesOnePicture) {
  const Bytes first = trigger(4);
  EXPECT_EQ(status_of(first), GvcpStatus::kSuccess);
  EXPECT_EQ(trigger(4), first);
  // What others ask in between, and the client itself, makes no difference.
  EXPECT_FALSE(ask(other_, GvcpCommand::kDiscovery, 4, {}).empty());
  EXPECT_FALSE(
      ask(client_, GvcpCommand::kReadRegister, 5, numbers({gige_register::kPrivilege})).empty());
  EXPECT_EQ(trigger(4), first);
  EXPECT_EQ(server_.counts().refused, 0U);
  EXPECT_EQ(status_of(trigger(6)), GvcpStatus::kBusy) << "another trigger is refused";
  EXPECT_EQ(status_of(trigger(6)), GvcpStatus::kBusy);
  EXPECT_EQ(server_.counts().refused, 1U) << "once";
  std::this_thread::sleep_for(milliseconds(300));
  for (int i = 0; i < 20; ++i) {  // until the picture is sent
    std::this_thread::sleep_for(milliseconds(2));
    server_.step();
  }
  EXPECT_EQ(server_.counts().frames, 1U);
  EXPECT_EQ(status_of(trigger(6)), GvcpStatus::kBusy) << "a refusal stays one";
  EXPECT_EQ(status_of(trigger(7)), GvcpStatus::kSuccess);
}

TEST_F(RepeatedRequests, TheSameIdWithOtherContentOrOfAnotherClientIsAnotherRequest) {
  EXPECT_EQ(status_of(trigger(4)), GvcpStatus::kSuccess);
  EXPECT_EQ(status_of(write(4, gige_register::kHeartbeatTimeoutMs, 5000)), GvcpStatus::kSuccess);
  const Bytes read =
      ask(client_, GvcpCommand::kReadRegister, 4, numbers({gige_register::kHeartbeatTimeoutMs}));
  EXPECT_EQ(read_u32(parse_gvcp_acknowledgement(read)->payload, 0), 5000U);
  EXPECT_EQ(
      status_of(ask(
          other_, GvcpCommand::kWriteRegister, 4, numbers({twin_register::kTriggerSoftware, 1}))),
      GvcpStatus::kAccessDenied);
}

// Whoever gives control away and takes it again begins anew.
TEST_F(RepeatedRequests, AreForgottenWhenControlIsGivenBack) {
  EXPECT_EQ(status_of(trigger(4)), GvcpStatus::kSuccess);
  EXPECT_EQ(status_of(write(5, gige_register::kPrivilege, 0)), GvcpStatus::kSuccess);
  EXPECT_EQ(status_of(trigger(4)), GvcpStatus::kAccessDenied);
}

}  // namespace
}  // namespace glint
