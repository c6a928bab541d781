// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a reader of a path-traced picture must know about its lights.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "simulator/render/path_tracing/physical_scene.h"
#include "studies/definition/scene.h"
#include "studies/imaging/path_picture.h"

namespace glint {

/// A light that stands between the camera and the part.
struct HidingLight {
  std::string name;          ///< of its table below [lighting]
  double back_share = 0.0;   ///< of the part in view: behind the light's dark back
  double front_share = 0.0;  ///< of the part in view: behind its luminous side
};

/// The area lights that hide some of the part from the camera, by some ten thousand rays through
/// the middles of pixels. The tunnel's wall is told by view.hidden_share.
std::vector<HidingLight> hiding_lights(const PhysicalScene& scene);

/// A sentence for each of hiding_lights().
std::vector<std::string> hiding_warnings(const PhysicalScene& scene);

/// All sentences: hiding lights, lights too near for their far-field data, files of measured lights
/// that are not read as a whole.
std::vector<std::string> path_warnings(const PhysicalScene& scene);

/// The lamps of any scene, for those who draw them or tell of them. Where no paths are followed
/// there are none.
class SceneLamps {
 public:
  /// @param part  with the scene's defects
  /// @throws ConfigError beginning with the key at fault (lamps that may hide each other), IoError
  SceneLamps(const SceneSettings& scene, std::shared_ptr<const BuiltDefects> part)
      : view_(path_view_of(scene, std::move(part))) {}

  /// PathView::area_lights(); nullptr: the tunnel's cross-section shows how the scene is lit.
  const PhysicalScene* area_lights() const {
    return view_ == nullptr ? nullptr : view_->area_lights();
  }

  /// path_warnings()
  std::vector<std::string> warnings() const;

  /// Of the light groups: "ring", "bar.3".
  std::vector<std::string> group_names() const;

 private:
  std::unique_ptr<const PathView> view_;
};

}  // namespace glint
