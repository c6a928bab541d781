// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/cell_stage.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "core/image/image_io.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 3> kKinds = {"grbl", "folder", "framebuffer"};

std::vector<ImageF> read_pictures(const CellStage& stage) {
  std::vector<ImageF> pictures;
  std::ranges::transform(stage.pictures, std::back_inserter(pictures), read_image);
  return pictures;
}

std::chrono::milliseconds settle_of(const CellStage& stage) {
  return std::chrono::milliseconds(static_cast<int>(1e3 * stage.settle_s));
}

void visit_linear(KeyVisitor& keys, CellStage& stage) {
  keys.text("host", stage.host, "IPv4 address of the stage's controller");
  keys.integer("port", stage.port, Range::between(1, 65535), "of TCP");
  keys.file("device", stage.device, "serial line, or frame buffer");
  keys.integer("baud", stage.baud, Range::between(9600, 115200), "of the serial line");
  keys.number("first_mm", stage.first_mm, Range::between(-10000, 10000), "first position");
  keys.number(
      "step_mm", stage.step_mm, Range::between(-1000, 1000), "to the next; 0: that of the scan");
  keys.number("speed_mm_s", stage.speed_mm_s, Range::positive(), "of its carriage");
  keys.number(
      "tolerance_mm", stage.tolerance_mm, Range::positive(), "of the position that it reports");
  keys.number("timeout_s", stage.timeout_s, Range::positive(), "for one move");
}

void visit_shown(KeyVisitor& keys, CellStage& stage) {
  keys.file("folder", stage.folder, "where show.png is put");
  keys.files("pictures", stage.pictures, "that are shown, one a position");
  keys.number("offset_mm", stage.offset_mm, Range{}, "of the design whose stripes they show");
  keys.number("settle_s", stage.settle_s, Range::between(0, 60), "until a picture is shown");
  keys.integer("width_px", stage.width_px, Range::between(0, 100000), "of the frame buffer");
  keys.integer("height_px", stage.height_px, Range::between(0, 100000), "of the frame buffer");
  keys.integer("bytes_per_pixel", stage.bytes_per_pixel, Range::between(2, 4), "of it: 2 or 4");
  keys.integer("bytes_per_row",
               stage.bytes_per_row,
               Range::between(0, 1'000'000),
               "of it; 0: width times bytes of a pixel");
}

}  // namespace

void visit_keys(KeyVisitor& keys, CellStage& stage) {
  using enum CellStage::Kind;
  keys.choice("kind", stage.kind, kKinds, "what moves or shows the stripes");
  keys.integer(
      "positions", stage.positions, Range::between(0, 10000), "0: as many as the scene's scan");
  visit_linear(keys, stage);
  visit_shown(keys, stage);
  keys.require(stage.kind != kGrbl || stage.host.empty() != stage.device.empty(),
               "kind",
               "is grbl, which needs either host or device");
  keys.require(stage.kind == kGrbl || !stage.pictures.empty(),
               "pictures",
               "is missing: a folder or frame buffer shows pictures");
  keys.require(stage.kind != kFolder || !stage.folder.empty(), "folder", "is missing");
  keys.require(stage.kind != kFramebuffer || !stage.device.empty(), "device", "is missing");
}

std::string_view name_of(CellStage::Kind kind) {
  return kKinds.at(static_cast<std::size_t>(kind));
}

StageWay stage_way_of(const CellStage& stage, int positions, const ScanSteps& steps) {
  const double step_mm = stage.step_mm != 0.0 ? stage.step_mm : steps.to_next_mm;
  const double to_first_mm = step_mm < 0.0 ? -steps.to_first_mm : steps.to_first_mm;
  return {.positions = stage.positions > 0 ? stage.positions : std::max(1, positions),
          .first_mm = stage.first_mm + to_first_mm,
          .step_mm = step_mm,
          .speed_mm_s = stage.speed_mm_s,
          .tolerance_mm = stage.tolerance_mm,
          .timeout_s = stage.timeout_s};
}

ConnectedStage connect_stage(const CellStage& stage, int positions, const ScanSteps& steps) {
  constexpr std::chrono::milliseconds kConnect{2000};
  ConnectedStage connected;
  switch (stage.kind) {
    case CellStage::Kind::kGrbl:
      connected.link = std::make_unique<TextLink>(
          stage.host.empty() ? TextLink::serial(stage.device, stage.baud)
                             : TextLink::tcp(stage.host, stage.port, kConnect));
      connected.stage =
          std::make_unique<LinearStage>(*connected.link, stage_way_of(stage, positions, steps));
      break;
    case CellStage::Kind::kFolder:
      connected.stage =
          std::make_unique<FolderStage>(stage.folder, read_pictures(stage), settle_of(stage));
      break;
    case CellStage::Kind::kFramebuffer: {
      const int row =
          stage.bytes_per_row > 0 ? stage.bytes_per_row : stage.width_px * stage.bytes_per_pixel;
      connected.stage = std::make_unique<FramebufferStage>(
          stage.device,
          FramebufferLayout{.width_px = stage.width_px,
                            .height_px = stage.height_px,
                            .bytes_per_pixel = stage.bytes_per_pixel,
                            .bytes_per_row = row},
          read_pictures(stage),
          settle_of(stage));
      break;
    }
  }
  return connected;
}

}  // namespace glint
