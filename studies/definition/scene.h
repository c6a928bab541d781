// SPDX-License-Identifier: GPL-3.0-or-later
//
// A scene as its file describes it: part, material, camera, lens, viewpoints, sensor, scan, render,
// lighting, defects, imprint, metrics, inspection, calibration, cell, reference. Plain settings;
// studies/imaging/traced_scene.h and studies/imaging/path_picture.h turn them into something that
// can be rendered.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/config/config.h"
#include "core/config/key_writer.h"
#include "core/config/keys.h"
#include "defects/definition/defect_settings.h"
#include "metrics/aspect_image/settings.h"
#include "metrics/coverage/coverage_settings.h"
#include "metrics/inspection/inspection_settings.h"
#include "simulator/camera/lens_settings.h"
#include "simulator/camera/viewpoint_set.h"
#include "simulator/geometry/part/part.h"
#include "simulator/light/area/build_lights.h"
#include "simulator/light/tunnel/scan_settings.h"
#include "simulator/light/tunnel/tunnel.h"
#include "simulator/material/material_settings.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/ray_cache/render_settings.h"
#include "simulator/sensor/sensor.h"
#include "studies/definition/cell_settings.h"
#include "studies/definition/cost_settings.h"

namespace glint {

/// What a scene's viewpoints are for.
enum class SceneUse {
  kPictures,  ///< they are rendered or scanned: a scan of a mirror has one
  kCoverage   ///< each is looked from by itself, whatever the light: as many as one likes
};

struct SceneSettings {
  SceneUse use = SceneUse::kPictures;  ///< of who reads the scene, not of its file
  PartSettings part;
  MaterialSettings material;
  CameraSettings camera;
  LensSettings lens;
  std::vector<Viewpoint> viewpoints = {Viewpoint{}};  ///< as listed; at least one
  ViewpointSettings viewpoint_set;                    ///< where all of them come from
  SensorSettings sensor;
  double expose_to = 0.0;  ///< of full scale, for the brightest percent; 0: sensor.exposure holds
  ScanSettings scan;
  RenderSettings render;
  PathSettings paths;
  bool has_tunnel = true;
  std::string tunnel_name = "tunnel";  ///< of its table below [lighting]
  bool is_tunnel_guessed = false;      ///< its table has no type and no name that tells one
  TunnelSettings tunnel;
  std::vector<NamedLight> lights;       ///< all others that shine, in file order
  std::string lighting_use = "all";     ///< names of the lights that shine, with + between them
  bool has_idle_tunnel = false;         ///< the tunnel is there and does not shine
  std::vector<NamedLight> idle_lights;  ///< those that do not shine, in file order
  std::vector<NamedGroup> defects;      ///< in file order
  ImprintSettings imprint;              ///< what holds for all of them
  MetricsSettings metrics;
  InspectionSettings inspection;
  std::optional<CalibrationSettings> calibration;
  std::optional<CellSettings> cell;
  std::optional<ReferenceSettings> reference;
  std::optional<ValidateSettings> validate;
  std::optional<CostSettings> cost;
  CoverageSettings coverage;
  bool has_coverage = false;  ///< its table is there; written only then

  /// The first of the list: the one that is scanned and scored.
  const Viewpoint& viewpoint() const { return viewpoints.front(); }

  Viewpoint& viewpoint() { return viewpoints.front(); }
};

/// Whether the path tracer makes the pictures: any other light than one tunnel, any other material
/// than a plain mirror, or because [render] asks for it; or the sum of direct light, where [render]
/// asks for that. All else is light along kept rays: level 0 for a mirror, blurred reflections
/// where [render] asks for them.
bool needs_paths(const SceneSettings& scene);

/// Whether any light shines in it.
bool is_lit(const SceneSettings& scene);

/// Whether the part is moved or turned in the scene.
bool is_posed(const SceneSettings& scene);

/// Whether it may be looked at from many viewpoints, each of which `glint render` shows by itself;
/// a scan of a mirror has one.
bool allows_many_viewpoints(const SceneSettings& scene);

/// Whether it has something that files of schema 1 did not know.
bool needs_schema_2(const SceneSettings& scene);

/// All files that the scene reads, but for those that are empty.
std::vector<std::filesystem::path> input_files(const SceneSettings& scene);

/// The pinhole of [camera] and [lens]. @throws ConfigError as lens_geometry()
PinholeIntrinsics intrinsics_of(const SceneSettings& scene);

/// Names of the top-level tables of a scene.
const std::vector<std::string>& scene_tables();

/// Reads a scene. Tables that are no scene's are left to the caller.
/// @param errors  grows by the problems found
SceneSettings read_scene(const ConfigNode& root,
                         std::vector<Problem>& errors,
                         SceneUse use = SceneUse::kPictures);

/// Makes of the scene that was read from `root` the one that would be read if the tables in
/// `changed` stood in the place of those of the same name: only these are read and checked, with
/// what depends on them. @param errors  as read_scene() would tell them
void reread_scene(const ConfigNode& root,
                  const ConfigNode& changed,
                  SceneSettings& scene,
                  std::vector<Problem>& errors);

/// The scene with every key present; read_scene() of it gives the same scene.
ConfigNode write_scene(const SceneSettings& scene);

/// The key table of a scene, for `glint explain` and the docs.
std::vector<KeyRow> scene_keys();

/// The problem with the place of its key in the file: of the key, of the table around it, or of the
/// file. Problems that have a place, and those of no key of a scene, stay as they are.
Problem with_place(const ConfigNode& root, Problem problem);
ConfigError with_place(const ConfigNode& root, const ConfigError& error);

/// The error with what the keys were read for before each key: "study.toml:4:1: camera.x: is 3"
/// becomes "study.toml:4:1: prototypes.flat: camera.x: is 3".
ConfigError in_context(const ConfigError& error, const std::string& context);

}  // namespace glint
