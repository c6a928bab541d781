// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/real_pictures.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "simulator/sensor/rounding.h"
#include "studies/acquire/acquired.h"
#include "studies/compare/compare_sources.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr int kPlainBits = 8;

/// The mean of the view's sequence, or its first accepted picture.
RealView real_view(const Acquired& acquired, const std::string& view) {
  const AcquiredPicture first = acquired.of_view(view).front();
  const fs::path mean = acquired.aspect_of(view);
  const fs::path frame = acquired.folder / first.file;
  const fs::path picture = is_there(mean) ? mean : frame;
  if (!is_there(picture)) {
    throw IoError(fmt::format("{}: there is no such file, {} names it",
                              picture.string(),
                              (acquired.folder / "acquired.json").string()));
  }
  return {
      .name = view,
      .picture = picture,
      .frame = picture == mean && is_there(frame) ? frame : fs::path(),
      .base_from_flange = RigidTransform{.rotation = first.base_from_flange.linear(),
                                         .translation_mm = first.base_from_flange.translation()},
      .position_sigma_mm = first.position_sigma_mm,
      .rotation_sigma_rad = first.rotation_sigma_rad};
}

/// A view that has frames of a scan and no mean of them all: no single frame is its picture.
bool is_cut_short(const Acquired& acquired, const std::string& view) {
  const bool is_of_scan =
      std::ranges::any_of(acquired.pictures, [&](const AcquiredPicture& picture) {
        return picture.view == view && picture.position != 0;
      });
  return (is_of_scan || acquired.status == "stopped") && !is_there(acquired.aspect_of(view));
}

RealDesign read_acquired_design(const std::string& name, const fs::path& folder) {
  const Acquired acquired = read_acquired(folder);
  RealDesign design = {.name = name,
                       .folder = folder,
                       .calibration = acquired.calibration,
                       .is_of_twin = acquired.is_twin};
  for (const std::string& view : acquired.views()) {
    if (is_cut_short(acquired, view)) {
      design.notes.push_back(
          fmt::format("{}: {} is incomplete and left out; glint acquire completes it", name, view));
      continue;
    }
    design.views.push_back(real_view(acquired, view));
  }
  if (design.views.empty()) {
    const char* const why =
        acquired.views().empty() ? "has no accepted picture" : "has no view whose scan is whole";
    throw NoWholeView(fmt::format("{}: {}", (folder / "acquired.json").string(), why));
  }
  const auto rejected = std::ranges::count(acquired.pictures, false, &AcquiredPicture::is_accepted);
  if (rejected > 0) {
    design.notes.push_back(
        fmt::format("{}: {} pictures were rejected when they were taken", name, rejected));
  }
  if (acquired.status != "complete") {
    design.notes.push_back(fmt::format("{}: its pictures are {}", name, acquired.status));
  }
  return design;
}

}  // namespace

double camera_step(const ImageF& recorded, int bits) {
  const bool is_black =
      std::ranges::all_of(recorded.values(), [](float grey) { return grey <= 0.0F; });
  return is_black ? 1.0 / (std::exp2(bits > 0 ? bits : kPlainBits) - 1.0) : recorded_step(recorded);
}

double camera_step(const RealView& view, const ImageF& real, int bits) {
  return view.frame.empty() ? camera_step(real, bits) : camera_step(read_image(view.frame), bits);
}

RealDesign read_real_design(const std::string& name, const fs::path& folder) {
  if (is_there(folder / "acquired.json")) {
    return read_acquired_design(name, folder);
  }
  RealDesign design = {.name = name, .folder = folder};
  for (const CompareSource& source : compare_sources(folder)) {
    design.views.push_back({.name = source.name, .picture = source.picture});
    design.is_by_render = source.is_rendered() && source.picture.stem() == "image";
  }
  return design;
}

}  // namespace glint
