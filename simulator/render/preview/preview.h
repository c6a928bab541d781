// SPDX-License-Identifier: GPL-3.0-or-later
//
// Quick pictures of a part with its defects, made with the simulator's own rays: shaded so that
// dents show, and as a defect map. They need no lighting and say nothing about any.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/image/image.h"
#include "core/pose.h"
#include "core/thread_pool.h"
#include "simulator/camera/camera_settings.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/surface/surface_detail.h"

namespace glint {

/// What is drawn; the parts must outlive the call.
struct PreviewSubject {
  const TriangleMesh& mesh;                 ///< with shading normals
  const Bvh& bvh;                           ///< of the mesh
  const std::vector<std::int32_t>& labels;  ///< per triangle, 0: no defect; empty: none anywhere
  const SurfaceDetail& detail;              ///< defects that are no triangles
};

/// Where from. Camera frame: +x right, +y down, +z along the view.
struct PreviewView {
  RigidTransform camera_from_world;
  PinholeIntrinsics intrinsics;
  double pixel_mm = 0.0;  ///< > 0: parallel rays from the plane z = 0, this far apart
};

struct PreviewPictures {
  ImageF image;  ///< as displayed, in [0, 1], on light grey
  ImageF map;    ///< 1 defect, 0 part, kMapBackground beside it; means at edges
};

inline constexpr float kMapBackground = 0.3F;
inline constexpr int kPreviewSide_px = 1024;  ///< the longest side of a picture
inline constexpr int kTileSide_px = 192;

/// Four rays a pixel. The same bytes for any number of threads.
PreviewPictures draw_preview(const PreviewSubject& subject,
                             const PreviewView& view,
                             ThreadPool& pool);

/// The scene's camera at a viewpoint, its longest side reduced or enlarged to kPreviewSide_px.
PreviewView camera_view(const CameraSettings& camera, const Viewpoint& viewpoint);

/// From outside towards a mesh that fills the picture.
/// @param towards  from the camera to the mesh, any length, not along z
PreviewView fitted_view(const TriangleMesh& mesh,
                        const Eigen::Vector3d& towards,
                        int longest_side_px = kPreviewSide_px);

/// Three-quarter views from the front above and from the back below: together they show nearly
/// all of a part.
std::vector<PreviewView> automatic_views(const TriangleMesh& mesh);

/// What a defect takes of the surface, about its place.
struct PlaceExtent {
  double along_mm = 1.0;   ///< u
  double across_mm = 1.0;  ///< v
  double height_mm = 0.0;  ///< may rise above the place
};

/// Straight onto a place of the surface: parallel rays that start below what hangs over it, as far
/// as that is possible. Where they start inside the part the picture is a flat section.
PreviewView place_view(const Bvh& bvh, const SurfacePlace& place, const PlaceExtent& extent);

/// Square tiles in rows of six, each with its number in a corner; 0: none.
ImageF contact_sheet(const std::vector<ImageF>& tiles, const std::vector<int>& numbers);

}  // namespace glint
