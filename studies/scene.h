// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene as its file describes it: part, camera, viewpoint, sensor, scan, render, lighting,
// defects, imprint, metrics, inspection. Plain settings; traced_scene.h turns them into something
// that can be rendered.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/config.h"
#include "core/keys.h"
#include "defects/defect_settings.h"
#include "metrics/inspection/inspection_settings.h"
#include "metrics/settings.h"
#include "simulator/camera/camera_settings.h"
#include "simulator/geometry/part.h"
#include "simulator/light/tunnel.h"
#include "simulator/render/ray_cache.h"
#include "simulator/render/scan.h"
#include "simulator/sensor/sensor.h"

namespace glint {

struct SceneSettings {
  PartSettings part;
  CameraSettings camera;
  Viewpoint viewpoint;
  SensorSettings sensor;
  ScanSettings scan;
  RenderSettings render;
  std::string tunnel_name = "tunnel";  ///< of its table below [lighting]
  TunnelSettings tunnel;
  std::vector<NamedGroup> defects;  ///< in file order
  ImprintSettings imprint;          ///< what holds for all of them
  MetricsSettings metrics;
  InspectionSettings inspection;
};

/// Names of the top-level tables of a scene.
const std::vector<std::string>& scene_tables();

/// Reads a scene. Tables that are no scene's are left to the caller.
/// @param errors  grows by one line per problem
SceneSettings read_scene(const ConfigNode& root, std::vector<std::string>& errors);

/// The scene with every key present; read_scene() of it gives the same scene.
ConfigNode write_scene(const SceneSettings& scene);

/// The key table of a scene, for `glint explain` and the docs.
std::vector<KeyRow> scene_keys();

/// Puts the place of the key a message begins with before the message: "camera.x: is 3" becomes
/// "study.toml:4:1: camera.x: is 3". Messages that begin with no key of the file stay as they are.
std::string with_place(const ConfigNode& root, const std::string& message);

/// Puts where a problem arose behind the place of each line: "study.toml:4:1: camera.x: is 3"
/// becomes "study.toml:4:1: prototypes.flat: camera.x: is 3".
std::string in_context(const std::string& message, const std::string& context);

}  // namespace glint
