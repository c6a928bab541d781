// SPDX-License-Identifier: GPL-3.0-or-later
//
// Imprints: closed tools subtracted from a part (dents, scratches) or united with it (bumps). Only
// the faces the tool's surface meets go through the Boolean operation, so that the cost of one
// imprint does not depend on the size of the part (docs/theory/imprint.md, "Boolean operation").
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "core/rng.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

enum class ImprintOperation { kSubtract, kUnite };

/// How an imprint ended. Everything but kDone leaves the part exactly as it was.
enum class ImprintOutcome {
  kDone,
  kNoContact,         ///< the tool's surface does not meet the part, nor lies inside it
  kSwallowed,         ///< the tool is wholly inside: it would be a hidden void, or change nothing
  kSwallowsPart,      ///< nothing of the part's surface would remain near the tool
  kOpenSeam,          ///< the cut does not close, e.g. at a hole of the part or a flush contact
  kSelfIntersection,  ///< the imprinted surface would cross itself
  kDegenerate,        ///< the cut makes a face without area
  kBrokenPatch,    ///< the part's own surface is crossed or not a manifold where the tool meets it
  kBrokenTool,     ///< the tool is not closed or crosses itself (see tool_fault)
  kTooLittle,      ///< less volume than ImprintLimits::min_removed_mm3
  kBreaksThrough,  ///< the tool comes out at another side of the part, or cuts a piece off
};

/// The outcome as a sentence for users, without a full stop ("the tool does not touch the part").
std::string_view outcome_text(ImprintOutcome outcome);

struct ImprintLimits {
  double min_removed_mm3 = 0.0;    ///< refuse less than this; for kUnite the volume added
  bool may_break_through = false;  ///< allow tunnels and cut-off pieces
};

struct ImprintResult {
  ImprintOutcome outcome = ImprintOutcome::kNoContact;
  double removed_volume_mm3 = 0.0;  ///< negative for kUnite; 0 unless kDone
  int patch_faces = 0;              ///< faces of the part that were looked at
  int removed_faces = 0;            ///< faces of the part that were cut or taken away
  int new_faces = 0;                ///< faces that came instead, the tool's among them
  int seam_loops = 0;               ///< connected pieces of the seam between part and tool

  bool is_done() const { return outcome == ImprintOutcome::kDone; }
};

/// Some faces of a part with their vertices, to be put back finer (defects/surface/exact_facets.h).
struct MeshCutout {
  TriangleMesh mesh;                   ///< vertices_mm, triangles and patch
  std::vector<std::int32_t> labels;    ///< per face, as ImprintedMesh::Labelled
  std::vector<std::int32_t> origin;    ///< likewise
  std::vector<std::int32_t> faces;     ///< the part's numbers of the faces that were cut out
  std::vector<std::int32_t> vertices;  ///< and of their vertices; those added later have none
};

class ImprintedMeshState;

/// A part that takes one imprint after another. Faces an imprint does not touch keep their bytes
/// and their order, and a refused imprint changes nothing. The same calls give the same bytes.
///
/// Copies share the part and its search tree, so that many defective copies of one part cost one
/// construction: build once, copy for each. Different objects may be used from different threads,
/// copies of one object too.
class ImprintedMesh {
 public:
  /// part: closed or open; triangles with a repeated corner are allowed and ignored. Only
  /// vertices_mm, triangles and patch are used. @throws ConfigError when the mesh is unusable (see
  /// find_fault(TriangleMesh)).
  explicit ImprintedMesh(const TriangleMesh& part);
  ImprintedMesh(const ImprintedMesh& other);
  ImprintedMesh(ImprintedMesh&& other) noexcept;
  ImprintedMesh& operator=(const ImprintedMesh& other);
  ImprintedMesh& operator=(ImprintedMesh&& other) noexcept;
  ~ImprintedMesh();

  /// Cuts the tool out of the part, or adds it. tool: closed, turned outwards, without fault (see
  /// tool_fault), in the part's frame. label > 0 marks the faces that come from the tool. A refused
  /// tool may be tried again, moved a little (see jittered).
  ImprintResult imprint(const TriangleMesh& tool,
                        std::int32_t label,
                        ImprintOperation operation,
                        const ImprintLimits& limits = {});

  /// The faces whose boxes meet a box.
  MeshCutout cutout(const BoundingBox& box_mm) const;

  /// Puts faces that were cut out back after some of them were cut to pieces: the first faces and
  /// vertices are those of cutout(), further ones are new. Its border must be as it was.
  void replace(const MeshCutout& finer);

  struct Labelled {
    TriangleMesh mesh;                 ///< vertices_mm, triangles and patch (unless all are -1)
    std::vector<std::int32_t> labels;  ///< per face 0 = part, otherwise the tool's label
    /// Per face the index of the part's triangle it is (a piece of), -1 for faces of tools.
    std::vector<std::int32_t> origin;
  };

  /// What there is now: faces that are unchanged first, in the part's order, then new ones in the
  /// order they came. Vertices that no face uses are dropped; the others keep their order.
  Labelled result() const;

  std::size_t num_triangles() const;

  /// Bytes held in memory, shared ones included.
  std::size_t memory_bytes() const;

 private:
  std::unique_ptr<ImprintedMeshState> state_;
};

/// The tool moved and turned by a random amount: up to `size` times its diagonal along each axis
/// and `size` radians about each. Sources of trouble are faces of tool and part in one plane; a few
/// retries with growing size (jitter_size) cure them.
TriangleMesh jittered(const TriangleMesh& tool, double size, Rng& rng);

/// The size of retry 1, 2, ...: 1e-4, then times 3 each, at most 3e-2.
double jitter_size(int retry);

}  // namespace glint
