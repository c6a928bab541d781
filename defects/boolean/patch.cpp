// SPDX-License-Identifier: GPL-3.0-or-later
//
// One Boolean operation of a tool with a part, restricted to the faces that can meet. The faces of
// both surfaces near their intersection are cut (corefine_general.h, else corefine.h), the pieces
// sorted into inside and outside, the new surface assembled, and accepted only if it is valid;
// otherwise the part is left alone and the outcome says why. Rounding may spoil the quick way, so a
// bad surface is tried again with exact constructions. Own method: docs/theory/imprint.md, "Boolean
// operation". Cost: depends on the faces near the tool, and by a logarithm on the size of the part.
#include "defects/boolean/patch.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "defects/boolean/corefine.h"
#include "defects/boolean/corefine_general.h"
#include "defects/boolean/patch_assemble.h"
#include "defects/boolean/patch_check.h"
#include "defects/boolean/patch_crossings.h"
#include "defects/boolean/patch_pieces.h"
#include "defects/boolean/patch_ring.h"
#include "defects/boolean/patch_tool.h"

namespace glint {
namespace {

ImprintOutcome outcome_without_seam(const ImprintedMeshState& part,
                                    const Patch& patch,
                                    const PatchTool& tool) {
  if (part.contains(tool.vertices_mm[static_cast<std::size_t>(tool.triangles[0][0])])) {
    return ImprintOutcome::kSwallowed;
  }
  for (const TestFace& face : patch.tests) {
    if (tool.contains(face.corners[0])) {
      return ImprintOutcome::kSwallowsPart;
    }
  }
  return ImprintOutcome::kNoContact;
}

/// Pieces without a seam, such as another wall of the part near the tool: inside or outside by one
/// of their points.
void sort_part_pieces(Pieces& pieces, const Patch& patch, const PatchTool& tool) {
  std::vector<std::uint8_t> is_done(pieces.num_members(), 0);
  for (const bool may_be_inside : {false, true}) {
    for (std::size_t i = 0; i < patch.tests.size(); ++i) {
      const std::int32_t member = pieces.member_of_face(static_cast<std::int32_t>(i));
      const auto piece = static_cast<std::size_t>(pieces.piece_of(member));
      if (pieces.has_votes(member) || is_done[piece] != 0) {
        continue;
      }
      // Most pieces reach out of the tool's box: that is cheap to see.
      const bool is_outside = tool.box.is_outside(patch.tests[i].corners[0]);
      if (is_outside || may_be_inside) {
        is_done[piece] = 1;
        if (!is_outside && tool.contains(patch.tests[i].corners[0])) {
          pieces.vote(member, 1.0);
        }
      }
    }
  }
}

/// Other bodies of the tool.
void sort_tool_pieces(Pieces& pieces, const PatchTool& tool, const ImprintedMeshState& part) {
  for (std::size_t i = 0; i < tool.faces.size(); ++i) {
    const auto face = static_cast<std::int32_t>(i);
    const std::int32_t member = pieces.member_of_face(face);
    if (!pieces.is_in_ring(face) && !pieces.has_votes(member)) {
      pieces.vote(member, part.contains(tool.faces[i].corners[0]) ? 1.0 : -1.0);
    }
  }
}

PatchChange to_change(NewSurface&& surface, const Patch& patch) {
  PatchChange change;
  for (const std::int32_t face : surface.removed) {
    change.removed.push_back(patch.faces[static_cast<std::size_t>(face)]);
  }
  change.boxes.reserve(surface.tests.size());
  for (const TestFace& face : surface.tests) {
    change.boxes.push_back(face.box());
  }
  change.vertices_mm = std::move(surface.vertices_mm);
  change.faces = std::move(surface.faces);
  return change;
}

/// Does the seam separate inside from outside? One that ends at a hole of the part does not.
bool is_tool_parted(const Seam& seam, Pieces& pieces) {
  return std::all_of(seam.edges.begin(), seam.edges.end(), [&](const Seam::Edge& edge) {
    return pieces.piece_of(edge.tool_left / 3) != pieces.piece_of(edge.tool_right / 3);
  });
}

/// What can be said before the new surface is looked at closely.
ImprintOutcome first_check(const NewSurface& surface,
                           const ImprintedMeshState& part,
                           ImprintOperation operation,
                           const ImprintLimits& limits) {
  const bool is_cutting = operation == ImprintOperation::kSubtract;
  if (surface.num_tool_faces == 0) {
    return is_cutting ? ImprintOutcome::kNoContact : ImprintOutcome::kSwallowed;
  }
  if (surface.num_swallowed == 0) {
    return ImprintOutcome::kOpenSeam;  // they touch, but no face is on a clear side
  }
  if (surface.removed.size() == part.num_alive() && surface.split_parents.empty()) {
    return ImprintOutcome::kSwallowsPart;
  }
  const double volume_mm3 = is_cutting ? surface.removed_volume_mm3 : -surface.removed_volume_mm3;
  return volume_mm3 < limits.min_removed_mm3 || !(volume_mm3 > 0.0) ? ImprintOutcome::kTooLittle
                                                                    : ImprintOutcome::kDone;
}

/// One imprint at work.
class PatchCutter {
 public:
  PatchCutter(const ImprintedMeshState& part,
              const PatchTool& tool,
              std::int32_t label,
              ImprintOperation operation,
              const ImprintLimits& limits)
      : part_(part), tool_(tool), label_(label), operation_(operation), limits_(limits) {}

  PatchResult run() {
    out_.result.patch_faces = static_cast<int>(patch_.faces.size());
    if (rings_.part.faces.empty()) {
      out_.result.outcome = outcome_without_seam(part_, patch_, tool_);
      return std::move(out_);
    }
    const std::optional<CorefinedPair> quick = corefine_general(
        surface_of(rings_.part, patch_.tests), surface_of(rings_.tool, tool_.faces), rings_.pairs);
    if (quick) {
      out_.result.outcome = finish(*quick);
    }
    if (!quick || is_bad_surface(out_.result.outcome)) {
      out_.result.outcome = cut_slowly();
    }
    return std::move(out_);
  }

 private:
  static GeneralSurface surface_of(const Ring& ring, std::span<const TestFace> faces) {
    GeneralSurface surface{ring.mesh, {}};
    surface.tests.reserve(ring.faces.size());
    for (const std::int32_t face : ring.faces) {
      surface.tests.push_back(faces[static_cast<std::size_t>(face)]);
    }
    return surface;
  }

  /// Rounding may be the reason.
  static bool is_bad_surface(ImprintOutcome outcome) {
    return outcome == ImprintOutcome::kOpenSeam || outcome == ImprintOutcome::kDegenerate ||
           outcome == ImprintOutcome::kSelfIntersection;
  }

  /// With exact arithmetic, which needs surfaces that do not cross themselves.
  ImprintOutcome cut_slowly() {
    if (is_broken(rings_.tool, tool_.faces)) {
      return ImprintOutcome::kBrokenTool;
    }
    if (is_broken(rings_.part, patch_.tests)) {
      return ImprintOutcome::kBrokenPatch;
    }
    const CorefinedPair cut = corefine(rings_.part.mesh, rings_.tool.mesh);
    return cut.is_done ? finish(cut) : ImprintOutcome::kBrokenPatch;
  }

  /// Sorts the pieces, puts the new surface together and judges it; fills in out_ when all is well.
  ImprintOutcome finish(const CorefinedPair& cut) {
    const std::optional<Seam> seam = match_seam(cut);
    if (!seam) {
      return ImprintOutcome::kOpenSeam;
    }
    if (seam->edges.empty()) {
      return outcome_without_seam(part_, patch_, tool_);
    }
    Pieces part_pieces(cut.first, rings_.part, patch_.tests, patch_.edges);
    Pieces tool_pieces(cut.second, rings_.tool, tool_.faces, tool_.edges);
    vote_along(*seam, cut, part_pieces, tool_pieces);
    sort_part_pieces(part_pieces, patch_, tool_);
    sort_tool_pieces(tool_pieces, tool_, part_);
    const CutSurfaces surfaces{patch_, tool_, rings_, cut, *seam, part_pieces, tool_pieces};
    NewSurface surface = assemble(surfaces, part_, label_, operation_);
    ImprintOutcome outcome = first_check(surface, part_, operation_, limits_);
    if (surface.num_tool_faces == 0 && !is_tool_parted(*seam, tool_pieces)) {
      outcome = ImprintOutcome::kOpenSeam;
    }
    if (outcome == ImprintOutcome::kDone && !limits_.may_break_through &&
        breaks_through(*seam, part_pieces, tool_pieces)) {
      outcome = ImprintOutcome::kBreaksThrough;
    }
    if (outcome == ImprintOutcome::kDone) {
      outcome = check_surface(surface, patch_, part_);
    }
    if (outcome == ImprintOutcome::kDone) {
      report(std::move(surface), *seam);
    }
    return outcome;
  }

  void report(NewSurface&& surface, const Seam& seam) {
    out_.result.removed_volume_mm3 = surface.removed_volume_mm3;
    out_.result.removed_faces = static_cast<int>(surface.removed.size());
    out_.result.new_faces = static_cast<int>(surface.faces.size());
    out_.result.seam_loops = seam.num_loops;
    out_.change = to_change(std::move(surface), patch_);
  }

  const ImprintedMeshState& part_;
  const PatchTool& tool_;
  std::int32_t label_ = 0;
  ImprintOperation operation_ = ImprintOperation::kSubtract;
  const ImprintLimits& limits_;
  Patch patch_{part_, tool_};
  RingPair rings_ = find_rings(patch_, tool_);
  PatchResult out_;
};

}  // namespace

PatchResult cut_patch(const ImprintedMeshState& part,
                      const TriangleMesh& tool,
                      std::int32_t label,
                      ImprintOperation operation,
                      const ImprintLimits& limits) {
  PatchResult broken;
  broken.result.outcome = ImprintOutcome::kBrokenTool;
  if (!find_fault(tool).empty()) {
    return broken;
  }
  const PatchTool prepared(tool);
  if (!prepared.edges.is_closed()) {
    return broken;
  }
  return PatchCutter(part, prepared, label, operation, limits).run();
}

}  // namespace glint
