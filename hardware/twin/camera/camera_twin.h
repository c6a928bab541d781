// SPDX-License-Identifier: GPL-3.0-or-later
//
// A simulated camera that speaks GigE Vision on an address of this machine: a client cannot tell it
// from a real one. Control and stream are bound to one address of 127.0.0.0/8 and nothing else, so
// it does not hear broadcasts: it is found by asking that address.
//
// It answers discovery, registers, memory and requests for lost packets, sends test packets, gives
// control to one client as long as that one is heard within the heartbeat, and takes pictures by
// software trigger. A change of settings is answered when the source has the picture for them;
// until then the client is told that the answer takes longer. A trigger that finds no finished
// picture is refused, and so is one while a picture is being taken.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "hardware/twin/camera/camera_registers.h"
#include "hardware/twin/camera/picture_source.h"

namespace glint {

/// Why a trigger was refused.
enum class TwinRefusal { kNone, kNoFinishedPicture, kStillExposing, kNotAcquiring };

/// "none", "trigger_without_picture", "trigger_during_exposure", "trigger_while_stopped"
std::string_view name_of(TwinRefusal refusal);

struct CameraTwinCounts {
  std::uint64_t frames = 0;  ///< pictures taken
  std::uint64_t refused = 0;
  std::uint64_t resent_packets = 0;
  std::uint64_t lost_controls = 0;  ///< clients that were not heard in time
  TwinRefusal last_refusal = TwinRefusal::kNone;
};

class CameraTwin {
 public:
  /// Listens from now on. @param source  must outlive the twin
  /// @throws ConfigError for an address that is not in 127.0.0.0/8, IoError when it is taken
  CameraTwin(const CameraTwinSettings& settings, PictureSource& source);
  ~CameraTwin();
  CameraTwin(const CameraTwin&) = delete;
  CameraTwin& operator=(const CameraTwin&) = delete;

  CameraTwinCounts counts() const;

 private:
  class Server;

  std::unique_ptr<Server> server_;
};

/// The first of the addresses that find_cameras() asks at which no camera listens.
/// @throws IoError when all of them are taken
std::uint32_t free_camera_address();

}  // namespace glint
