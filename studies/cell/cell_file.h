// SPDX-License-Identifier: GPL-3.0-or-later
//
// A cell as its file describes it: camera, robot, lights, limits, and the positions it may take.
//
//     [camera]            id or address, exposure, gain ...
//     [robot]             model, host, TCP, payload (hardware/robot/ur_settings.h)
//     [limits]            speeds and the box; without default (hardware/robot/motion_limits.h)
//     [lights.ring]       a digital output, or a person
//     [stage]             what moves a tunnel's stripes (cell_stage.h)
//     [acquisition]       which pictures are kept (hardware/acquisition/picture_check.h)
//     [calibration]       what `glint calibrate` wrote
//     [twin]              what its twins are in truth
//     [[safe_position]]   where the arm waits
//     [[view]]            where pictures are taken from
//     [planning], [[obstacle]], [[body]]  see cell_planning.h
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/keys.h"
#include "hardware/acquisition/picture_check.h"
#include "hardware/camera/pixel_format.h"
#include "hardware/robot/ur_settings.h"
#include "studies/cell/cell_planning.h"
#include "studies/cell/cell_stage.h"

namespace glint {

/// As the file spells them, in the order of PixelFormat.
inline constexpr std::array<std::string_view, kPixelFormats.size()> kCellPixelFormats = {
    "mono8", "mono10", "mono12", "mono16", "mono10_packed", "mono12_packed", "mono10p", "mono12p"};

/// A feature by the camera's own name for it, as the file has it: "LineSelector" = "Line1".
struct CellFeature {
  std::string name;
  std::string value;  ///< numbers and booleans as text
};

/// [camera]. Its width, height and lens are those of the calibration.
struct CellCamera {
  std::string id;       ///< empty: the only one that answers, or that of the address
  std::string address;  ///< IPv4; empty: found by id
  PixelFormat pixel_format = PixelFormat::kMono8;
  double exposure_s = 0.01;
  std::optional<double> gain_db;   ///< neither: as the camera has it
  std::optional<double> gain_raw;  ///< of a camera whose gain is in steps of its own
  int packet_bytes = 0;            ///< 0: as large as a test packet gets through
  std::vector<double> region_px;   ///< x, y, width, height; empty: the whole sensor
  std::vector<CellFeature> features;
};

/// [lights.<name>]
struct CellLight {
  enum class Kind {
    kDigitalOutput,  ///< of the robot's controller
    kManual          ///< a person is asked to switch it
  };

  std::string name;
  Kind kind = Kind::kDigitalOutput;
  int output = 0;         ///< 0 to 7: of the standard digital outputs
  double settle_s = 0.1;  ///< until it shines evenly
  Place output_place;     ///< of the output; of the table where that has none
};

/// [[safe_position]] and [[view]]
struct CellPosition {
  std::string name;
  std::vector<double> joints_rad;    ///< six
  std::vector<std::string> lights;   ///< of a view: those that are on
  std::optional<double> exposure_s;  ///< of a view; none: the camera's
  Place place;
};

/// By which the twins of a ready file are told from others at their addresses.
struct TwinTokens {
  std::optional<std::uint64_t> robot;
  std::optional<std::uint64_t> camera;
  std::optional<std::uint64_t> stage;  ///< a linear one
};

struct Cell {
  std::filesystem::path file;
  std::optional<CellCamera> camera;
  std::optional<UrSettings> robot;
  MotionLimits limits;  ///< of the robot
  std::vector<CellLight> lights;
  std::optional<CellStage> stage;
  PictureLimits acquisition;
  std::filesystem::path calibration;  ///< calibration.toml; empty: none
  std::filesystem::path truth;        ///< a scene for twins of the camera; empty: none
  double motion_speedup = 1.0;        ///< of the twin of the robot: how much faster its clock goes
  std::vector<CellPosition> safe_positions;
  std::vector<CellPosition> views;
  CellPlanning planning;
  /// Ready file of twins whose addresses the devices have: nothing else is driven. Empty: the
  /// cell's own devices.
  std::filesystem::path twins;
  TwinTokens twin_tokens;  ///< as the ready file has them
};

void visit_keys(KeyVisitor& keys, CellCamera& camera);
void visit_keys(KeyVisitor& keys, CellLight& light);

/// @throws ConfigError with the places of all problems, IoError
Cell read_cell(const std::filesystem::path& path);

/// Lights on an output that another one has, too: both would be switched together. Whoever drives
/// the cell refuses them; planning, and pictures that are there, do not mind.
std::vector<Problem> shared_outputs(const Cell& cell);

/// What a cell is called: the name of the folder that its file lies in.
std::string cell_name(const std::filesystem::path& file);

/// The robot of a cell. @throws ConfigError when the file has no [robot]
const UrSettings& robot_of(const Cell& cell);

/// The camera of a cell. @throws ConfigError when the file has no [camera]
const CellCamera& camera_of(const Cell& cell);

/// A view by its name, or by its number counted from 1.
/// @throws ConfigError naming those that there are
const CellPosition& view_of(const Cell& cell, const std::string& name);

/// A safe position by its name; without one the first.
const CellPosition& safe_position_of(const Cell& cell, const std::string& name);

}  // namespace glint
