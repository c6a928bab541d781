// SPDX-License-Identifier: GPL-3.0-or-later
//
// Draws defects: how many, where, how large. Every number of a defect follows from the sample's
// seed, its group's name, its number in the group and the attempt, so that no defect moves another
// (docs/theory/imprint.md, "Places").
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "defects/definition/defect.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"

namespace glint {

/// One defect that is to be drawn.
struct DefectSlot {
  std::size_t group = 0;  ///< in the order of the file
  int number = 0;         ///< within the group, from 0
  std::int32_t id = 0;    ///< from 1
};

class DefectSampler {
 public:
  /// A sample, or why it was refused.
  struct Draw {
    std::optional<Defect> defect = {};
    /// "nearer than 0.5 mm to another defect", ...; the same words for the same trouble, so that
    /// they can be counted. Empty with a defect.
    std::string reason = {};
    Defect refused = {};  ///< what was drawn; its triangle is -1 where no place was found
  };

  /// Reads painted faces, finds sharp edges, puts fixed places onto the surface.
  /// @param part        and bvh: must outlive this
  /// @param crease_rad  edges of the mesh that are sharper count for edge_distance_mm
  /// @throws ConfigError beginning with the key at fault: a place beside the part or off its
  ///         surface, a region without surface, a defect larger than the part, a total that no
  ///         group takes a share of. IoError when a painted file cannot be read.
  DefectSampler(const Part& part,
                const Bvh& bvh,
                const std::vector<NamedGroup>& groups,
                const ImprintSettings& settings,
                double crease_rad);
  ~DefectSampler();
  DefectSampler(DefectSampler&&) noexcept;
  DefectSampler& operator=(DefectSampler&&) noexcept;

  /// What is to be drawn, ordered by group and number. With a total (imprint.count) each random
  /// defect falls to a group by its share; groups that give places and no count keep those besides.
  /// A larger total adds defects and leaves the others as they are.
  std::vector<DefectSlot> slots(std::uint64_t seed) const;

  /// The same bytes for (seed, slot, attempt) whatever was drawn before; safe to call from several
  /// threads. A fixed place stays the same at every attempt, sizes and turn are drawn anew.
  /// @param taken  the defects made so far: only whether the sample is refused depends on them
  Draw draw(std::uint64_t seed,
            const DefectSlot& slot,
            int attempt,
            std::span<const Defect> taken) const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace glint
