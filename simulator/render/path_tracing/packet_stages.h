// SPDX-License-Identifier: GPL-3.0-or-later
//
// The steps of sixteen paths: by kernels where these know the scene's kind, else lane by lane by
// the functions of material and light, which are in double.
#pragma once

#include "simulator/render/path_tracing/path_packet.h"
#include "simulator/render/path_tracing/path_task.h"

namespace glint {

class PacketStages {
 public:
  explicit PacketStages(const PathTask& task) : task_(task) {}

  /// Of lanes that hit the part.
  void intersect(const PathPacket& paths, SurfaceLanes& surface) const;

  /// The lights that valid rays meet before the part.
  void hit_lights(const PathPacket& paths, bool is_camera, LightHitLanes& lights) const;

  /// Draws directions to lights. @return false: the material is a mirror
  bool ask_lights(const PathPacket& paths,
                  const SurfaceLanes& surface,
                  const RandomLanes& random,
                  LightLanes& lights) const;

  /// What the material does with the light asked for, and the directions it chooses.
  /// @param lights  null: a mirror has none
  void reflect(const PathPacket& paths,
               const SurfaceLanes& surface,
               const RandomLanes& random,
               const LightLanes* lights,
               ReflectionLanes& reflection,
               LeavingLanes& leaving) const;

 private:
  void intersect_triangles(const PathPacket& paths, SurfaceLanes& surface) const;
  bool needs_double(const PathPacket& paths, const SurfaceLanes& surface, std::size_t lane) const;
  void intersect_lane(const PathPacket& paths, std::size_t lane, SurfaceLanes& surface) const;
  void set_open(const PathPacket& paths, SurfaceLanes& surface) const;
  void hit_light(const PathPacket& paths,
                 std::size_t lane,
                 bool is_camera,
                 LightHitLanes& lights) const;
  void ask_light(const SurfaceLanes& surface,
                 const RandomLanes& random,
                 std::size_t lane,
                 LightLanes& lights) const;
  Eigen::Vector3d point_of_part(const SurfaceLanes& surface, std::size_t lane) const;
  void tint(const PathPacket& paths,
            const SurfaceLanes& surface,
            ReflectionLanes& reflection,
            LeavingLanes& leaving) const;
  void reflect_lane(const Material& material,
                    const SurfaceLanes& surface,
                    const RandomLanes& random,
                    const LightLanes* lights,
                    std::size_t lane,
                    ReflectionLanes& reflection,
                    LeavingLanes& leaving) const;

  const PathTask& task_;
};

}  // namespace glint
