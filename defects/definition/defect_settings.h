// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a scene file says about defects: one [defects.<name>] table for each group, [imprint] for
// all of them together. Sizes and counts are numbers or ranges [min, max]; what was drawn is a
// Defect (defect.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/config/keys.h"
#include "core/units.h"

namespace glint {

/// Dents, pits, scratches and gouges go inwards, bumps outwards; stains change no shape.
enum class DefectType { kDent, kBump, kScratch, kPit, kGouge, kStain };

/// How a defect becomes part of a scene: as a tilt of the normal, as a fine mesh moved along the
/// normal, or by a Boolean operation with a tool. kAuto takes the cheapest that is good enough.
enum class Realisation { kAuto, kNormal, kDisplaced, kImprinted };

std::string_view type_name(DefectType type);
std::string_view realisation_name(Realisation realisation);

/// Scratches and gouges are drawn out along a line; the others are round.
constexpr bool is_line(DefectType type) {
  return type == DefectType::kScratch || type == DefectType::kGouge;
}

/// Where on the part the defects of a group may lie.
struct DefectRegion {
  enum class Kind { kAll, kBox, kSphere, kFaces };

  Kind kind = Kind::kAll;
  std::vector<double> min_mm = {-10.0, -10.0, -10.0};  ///< box, part frame
  std::vector<double> max_mm = {10.0, 10.0, 10.0};
  std::vector<double> centre_mm = {0.0, 0.0, 0.0};  ///< sphere, part frame
  double radius_mm = 10.0;
  std::filesystem::path file = {};  ///< painted faces: PLY of the same triangles, white is allowed
  double facing_rad = kPi;          ///< only where the normal is this near the part's +z
};

/// Keys of [defects.<name>].
struct DefectGroup {
  DefectType type = DefectType::kDent;
  Realisation realisation = Realisation::kNormal;

  // How many, and where: `count` random places, or else the fixed ones.
  Interval count = 0.0;              ///< whole numbers; 0: the fixed places, of which may be none
  double share = 1.0;                ///< of imprint.count, in proportion; > 0
  std::vector<double> x_mm = {0.0};  ///< fixed places in the part's frame, seen from above
  std::vector<double> y_mm = {0.0};
  std::vector<double> at_mm = {};  ///< fixed places as x, y, z, x, y, z ...; put on the surface
  DefectRegion region = {};        ///< of random places
  double min_distance_mm = 0.0;    ///< between the rims of two defects
  double edge_distance_mm = 0.0;   ///< from the centre to the part's sharp edges

  // Size and turn; each is drawn for every defect.
  Interval height_mm = 2e-3;    ///< depth along the normal, height of a bump
  Interval diameter_mm = 0.8;   ///< round: 4 sigma of a Gaussian, the opening of an imprint
  Interval length_mm = 3.0;     ///< line: from end to end
  Interval width_mm = 0.3;      ///< line: 4 sigma of its cross-section, the opening of an imprint
  Interval angle_rad = 0.0;     ///< turn about the normal, from the part's x axis
  Interval tilt_rad = 0.0;      ///< of an imprint's tool against the normal, any direction
  bool moves_position = false;  ///< normal: also moves the surface point, to first order

  // Tools of imprints.
  double roughness = 0.15;                 ///< of procedural tools: rms of their noise / radius
  int tool_level = 3;                      ///< 20 * 4^level triangles for a round tool
  std::filesystem::path tool_folder = {};  ///< custom tools: STL, PLY, OBJ, OFF in millimetres
  double wall_share = 0.5;                 ///< of the wall's thickness that a depth may take
  enum class Thin { kClamp, kRefuse };
  Thin when_thin = Thin::kClamp;

  double tolerance = 0.01;  ///< auto: allowed error of the picture, share of the defect's contrast

  // Stains.
  std::vector<double> colour = {0.5};  ///< reflectance of a stain: grey, or red, green, blue
  double stain_roughness_rad = 0.0;    ///< rms slope of its micro relief
};

void visit_keys(KeyVisitor& keys, DefectGroup& group);

/// Whether a defect of this type has a use for a key of its table: a dent has none for length_mm.
bool uses_key(DefectType type, std::string_view key);

/// The type a table of that name has when it gives none ("dents" -> dent), kDent otherwise.
DefectType type_from_name(const std::string& name);

/// Noise and subdivision of the finished mesh (docs/theory/imprint.md).
struct ProcessingSettings {
  enum class Subdivision { kMidpoint, kLoop };

  Subdivision subdivision = Subdivision::kMidpoint;
  int levels = 0;                      ///< each makes 4 triangles of 1
  double face_normal_noise_rad = 0.0;  ///< rms tilt of every face's shading normal
  double vertex_noise_mm = 0.0;        ///< rms move of every vertex along its normal
  double edge_roughness_mm = 0.0;      ///< rms move of vertices on sharp edges
};

/// Keys of [imprint]: what holds for all groups.
struct ImprintSettings {
  int seed = 1;
  Interval count = 0.0;          ///< defects in total, shared by `share`; 0: each group's own
  int max_attempts = 20;         ///< fresh samples for one defect before it is given up
  int jitters = 5;               ///< small moves of a tool before a fresh sample
  double min_removed_mm3 = 0.0;  ///< an imprint that takes away less is sampled again
  bool may_be_fewer = true;      ///< false: giving up a defect is an error
  ProcessingSettings processing = {};
};

void visit_keys(KeyVisitor& keys, ImprintSettings& settings);

/// Whether the group says where its defects lie; else its one fixed place is the part's middle.
bool has_given_places(const DefectGroup& group);

/// Defects a group can have at most.
std::size_t max_defects(const DefectGroup& group, const ImprintSettings& settings);

/// A group with its table's name.
using NamedGroup = std::pair<std::string, DefectGroup>;

}  // namespace glint
