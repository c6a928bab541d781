// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part with its defects: every defect is drawn, realised, and drawn again when its realisation is
// refused. Each draws from a seed of its own, so that one that is refused does not move the others.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "defects/definition/defect.h"
#include "simulator/geometry/bvh/bvh.h"

namespace glint {

/// One defect and how it came about.
struct RealisedDefect {
  Defect defect;  ///< its last sample when it was given up
  bool is_made = false;
  std::string reason = {};  ///< why it was given up; empty when it was made
  int attempts = 0;         ///< fresh samples that were drawn, >= 1
  int jitters = 0;          ///< small moves of the tool, over all attempts
  std::vector<std::pair<std::string, int>> refusals = {};  ///< reasons and how often each
  double removed_volume_mm3 = 0.0;                         ///< negative where material was added
  int faces = 0;         ///< of the finished mesh that carry its id (before subdivision)
  double seconds = 0.0;  ///< all its attempts together; differs from run to run
};

struct DefectivePart {
  std::vector<RealisedDefect> defects;  ///< in the order of the file

  /// The part's surface when an imprint or a displacement changed it, else without triangles.
  /// Scene frame; patches and shading normals as Part::mesh.
  TriangleMesh mesh;
  std::vector<std::int32_t> labels;  ///< per triangle of mesh: a defect's id, 0: the part itself
  /// Moved less than processing drew (defects/surface/processing.h).
  std::int64_t limited_vertices = 0;

  std::vector<HeightFeature> features;  ///< of defects realised by their normals
  std::vector<HeightFeature> outlines;  ///< of every defect that was made: where its pixels are

  bool has_own_mesh() const { return !mesh.triangles.empty(); }
};

/// The realisation of a defect whose group leaves it open; never kAuto.
using ChooseRealisation = std::function<Realisation(const Defect&, const DefectGroup&)>;

/// What making a part's defects anew can start from: for many samples of one part.
class DefectMaker {
 public:
  /// Reads tool folders and region files.
  /// @throws ConfigError beginning with the key at fault
  DefectMaker(std::shared_ptr<const Part> part,
              std::shared_ptr<const Bvh> bvh,
              std::vector<NamedGroup> groups,
              const ImprintSettings& settings,
              double crease_rad);
  ~DefectMaker();
  DefectMaker(DefectMaker&&) noexcept;
  DefectMaker& operator=(DefectMaker&&) noexcept;

  /// The same bytes for the same seed. Safe to call from several threads.
  /// @param seed      of the sample; settings.seed for the scene itself
  /// @param progress  is told how many defects are done; may be empty
  /// @throws ConfigError when a fixed place is off the part, or a defect was given up and
  ///         imprint.may_be_fewer is false
  DefectivePart make(std::uint64_t seed,
                     const ChooseRealisation& choose,
                     const std::function<void(int)>& progress = {}) const;

 private:
  struct State;
  class Making;
  std::unique_ptr<const State> state_;
};

}  // namespace glint
