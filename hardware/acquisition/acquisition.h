// SPDX-License-Identifier: GPL-3.0-or-later
//
// One acquisition: an arm goes along its tour, and at each view pictures are taken. Returns data;
// what becomes of the pictures is the sink's.
//
//   drive to the point before the view -> lights -> last leg -> standstill -> stage -> pictures
//        ^                                                                               |
//        |___________________________ next view ________________________________________|
//
// Lights go on before the last leg and off after the pictures: they have the time of a motion to
// become even, and do not shine while the arm is on its way. Each picture is taken between two
// looks at the arm: one that moved meanwhile, or was stopped, gives no picture.
//
// What ends it early:
//   camera, lights, stage, the sink, the program or the user   the arm backs out along the tour to
//                                                              the last safe point, if its safety
//                                                              mode is normal and it is on the tour
//   the arm itself                                             nothing moves any more
//
// Where nothing is to be taken, an arm at a safe point stays there; any other goes to the one that
// the fewest legs lead to.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hardware/acquisition/picture_check.h"
#include "hardware/acquisition/tour.h"
#include "hardware/camera/camera.h"
#include "hardware/light/light.h"
#include "hardware/light/stage.h"
#include "hardware/robot/robot.h"

namespace glint {

/// What is to be taken at one view.
struct ViewTask {
  std::size_t point = 0;  ///< of the tour
  std::string name;
  std::vector<std::string> lights;  ///< that are on; all others are off
  double exposure_us = 10000.0;
  std::vector<int> positions = {0};  ///< of the stage, one picture each; without a stage {0}
  double sharpest = 0.0;             ///< of pictures of this sequence that were taken before
  ExpectedPicture expected = {};     ///< of each of its pictures
};

/// In the order of their points.
struct AcquisitionPlan {
  Tour tour;
  std::vector<ViewTask> tasks;
  CameraConfiguration camera;  ///< its exposure is the views'
};

struct CellLamp {
  Light* light = nullptr;
  double settle_s = 0.1;    ///< until it shines evenly
  bool is_left_on = false;  ///< between views too: nobody wants to switch it that often
};

struct AcquisitionDevices {
  Robot& robot;
  Camera& camera;
  std::vector<CellLamp> lamps;
  Stage* stage = nullptr;                         ///< may be absent
  std::function<void(double seconds)> wait = {};  ///< empty: sleeps
};

struct AcquisitionOptions {
  double speed_share = 0.5;  ///< of the cell's limits
  PictureLimits limits;
  double still_timeout_s = 3.0;
  double reopen_s = 20.0;                       ///< for a camera that is lost
  int max_refused = 20;                         ///< triggers of one picture
  const std::atomic<int>* interrupt = nullptr;  ///< above 0: the user wants it to end
};

/// One picture as it was taken.
struct TakenPicture {
  std::size_t task = 0;
  int position = 0;  ///< of the stage
  int attempt = 0;   ///< 0: the first
  bool is_accepted = false;
  std::string reason;  ///< why not
  Frame frame;
  StillPose pose;  ///< of the standstill before it
  PictureFigures figures;
};

/// Called with each picture, kept or not. Throws when it cannot keep it: that ends the acquisition.
using PictureSink = std::function<void(const TakenPicture&)>;

enum class AcquisitionCause {
  kNone,
  kInterrupted,
  kCamera,
  kLight,
  kStage,
  kSink,
  kProgram,
  kRobot,   ///< a stop, a lost link, a motion that was refused
  kOffTour  ///< the arm stands where no planned leg is
};

/// "none", "interrupted", ...: as JSON has it.
std::string_view name_of(AcquisitionCause cause);

enum class AcquisitionEnd {
  kTour,       ///< at the tour's end
  kBackedOut,  ///< at a safe point, along the way it came
  kStopped     ///< where it was: nothing moved after the cause
};

/// "tour", "backed_out", "stopped"
std::string_view name_of(AcquisitionEnd end);

struct AcquisitionResult {
  AcquisitionCause cause = AcquisitionCause::kNone;
  AcquisitionEnd end = AcquisitionEnd::kStopped;
  std::string where;  ///< place_text(), or the joints
  std::string text;   ///< of the cause; of a way back that was not made, too
  int accepted = 0;
  int rejected = 0;  ///< pictures, retakes included
  int missing = 0;   ///< positions without an accepted picture

  bool is_complete() const { return cause == AcquisitionCause::kNone && missing == 0; }
};

/// Never throws for what devices and sink do.
/// @param plan  tasks by rising points; those without positions are passed by
AcquisitionResult acquire(const AcquisitionPlan& plan,
                          const AcquisitionDevices& devices,
                          const AcquisitionOptions& options,
                          const PictureSink& sink);

}  // namespace glint
