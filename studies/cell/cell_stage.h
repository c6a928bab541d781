// SPDX-License-Identifier: GPL-3.0-or-later
//
// [stage] of a cell file: what takes a tunnel's stripes from one position of a scan to the next.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/keys.h"
#include "hardware/light/stage.h"

namespace glint {

struct CellStage {
  enum class Kind {
    kGrbl,        ///< a linear stage whose controller speaks Grbl: by host and port, or by device
    kFolder,      ///< a program shows the picture that lies in a folder
    kFramebuffer  ///< a display of this machine
  };

  Kind kind = Kind::kGrbl;
  std::string host;  ///< IPv4; empty: by device
  int port = 23;
  std::filesystem::path device;  ///< serial line, or frame buffer
  int baud = 115200;
  int positions = 0;  ///< 0: as many as the scene's scan
  double first_mm = 0.0;
  double step_mm = 0.0;  ///< 0: the scene's
  double speed_mm_s = 20.0;
  double tolerance_mm = 0.02;
  double timeout_s = 60.0;
  std::filesystem::path folder;
  std::vector<std::filesystem::path> pictures;  ///< that folder or display shows, one a position
  double offset_mm = 0.0;                       ///< of the design whose stripes they show
  double settle_s = 0.2;                        ///< of what shows them
  int width_px = 0;                             ///< of the frame buffer
  int height_px = 0;
  int bytes_per_pixel = 4;
  int bytes_per_row = 0;  ///< 0: width_px * bytes_per_pixel
};

void visit_keys(KeyVisitor& keys, CellStage& stage);

/// As the cell's file has it: "grbl", "folder", "framebuffer".
std::string_view name_of(CellStage::Kind kind);

/// Steps of a scene's scan.
struct ScanSteps {
  double to_first_mm = 0.0;  ///< from where the stripes stand in a design without an offset
  double to_next_mm = 0.0;   ///< from each position to the next; 0: there is no scan
};

/// Where a linear stage stands at each position: at first_mm + to_first_mm + i step_mm. Where its
/// step is negative it goes against the scan, and to_first_mm is subtracted.
/// @param positions, steps  of the scene's scan; number and step hold where the cell's file says
///                          nothing
StageWay stage_way_of(const CellStage& stage, int positions, const ScanSteps& steps);

/// A stage with the link that it speaks over.
struct ConnectedStage {
  std::unique_ptr<TextLink> link;  ///< of a linear stage
  std::unique_ptr<Stage> stage;
};

/// @throws ConfigError, IoError
ConnectedStage connect_stage(const CellStage& stage, int positions, const ScanSteps& steps);

}  // namespace glint
