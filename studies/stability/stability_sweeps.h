// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sweeps of `glint stability`: one key or ratio each, from harmless to hopeless.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/config/config.h"
#include "studies/definition/study.h"

namespace glint::stability {

inline constexpr int kMaxPixels = 8000;

/// What sweeps of ratios are relative to: of base_scene_text(), or of a scene in its place.
struct SweptScene {
  bool is_builtin = true;
  double pixel_mm = 1.2;  ///< between neighbouring pixels on the part
  double period_mm = 16.0;
  std::string tunnel = "tunnel";  ///< its table below [lighting]
};

/// Fewer and larger pixels where there are more than kMaxPixels.
void reduce_camera(CameraSettings& camera);

/// Of a scene whose camera is reduced.
SweptScene swept_scene(SceneSettings scene);

/// The scene that all sweeps but those of the pair start from, as a study file: a mirror strip of
/// 190 x 44 mm under a semicylinder, 163 x 38 pixels, two dents, no noise.
std::string_view base_scene_text();

/// A matt plate of 60 x 40 mm beside an upright square light, path-traced.
std::string_view bar_scene_text();

struct SweepValue {
  double value = 0.0;
  std::vector<KeyValue> sets;   ///< over those of the sweep
  std::string method = "auto";  ///< render.method
  double sliver_mm = 0.0;       ///< > 0: the plate is a mesh with triangles as narrow as this
  int pixel_factor = 1;         ///< > 1: with_larger_pixels()
};

struct Sweep {
  enum class Kind {
    kTunnel,  ///< against the reference tracer
    kBar,     ///< a matt plate below a bar, against Lambert's formula
    kWinner,  ///< which of two designs is better, with and without a disturbance
    kSwitch   ///< against the same scene by another method
  };

  std::string name;   ///< snake_case
  std::string swept;  ///< the key or ratio
  std::string title;  ///< what is swept, for people
  Kind kind = Kind::kTunnel;
  bool has_own_sizes = false;       ///< in mm, of the built-in scene: means nothing in another one
  bool is_beside_bar = false;       ///< starts from bar_scene_text()
  std::vector<KeyValue> sets = {};  ///< over the base scene
  std::vector<SweepValue> values = {};
};

/// All that a scene can be swept by, in the order they are told.
std::vector<Sweep> all_sweeps(const SweptScene& scene = {});

/// "0.5", "1e+06": a number as a study file takes it.
std::string number_text(double value);

/// A tunnel without a slot, through which the camera looks all the same.
std::vector<KeyValue> quiet_wall();

/// One key at several values, each by the same method.
std::vector<SweepValue> key_values(const std::string& key,
                                   const std::vector<double>& values,
                                   const std::string& method = "auto");

/// The named sweeps in the order of all_sweeps(); all of them for none.
/// @throws ConfigError for an unknown name, with the known ones
std::vector<Sweep> chosen_sweeps(const std::vector<std::string>& names,
                                 const SweptScene& scene = {});

/// The scene of a cell as a tree of tables. @throws ConfigError
ConfigNode scene_tables_of(const ConfigNode& base, const Sweep& sweep, const SweepValue& value);

}  // namespace glint::stability
