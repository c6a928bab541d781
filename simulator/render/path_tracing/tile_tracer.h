// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulator/render/path_tracing/packet_stages.h"
#include "simulator/render/path_tracing/path_task.h"
#include "simulator/render/path_tracing/tile_sums.h"

namespace glint {

/// Follows the paths of one tile at a time; one tracer a thread.
///
/// All paths of a batch take each step together: camera rays, then at every reflection the rays to
/// lights and the reflected ones, each list packed into packets of sixteen without gaps. Results
/// depend on the tile and the samples alone.
class TileTracer {
 public:
  explicit TileTracer(const PathTask& task);

  /// Adds samples [first, first + count) of all pixels of a tile.
  void trace(const Tile& tile, int first, int count, Film& sums);

  const PathCounts& counts() const { return counts_; }

 private:
  /// Packets that are filled lane by lane; those of a former filling are kept for later ones.
  struct Wave {
    std::vector<PathPacket> packets;
    std::size_t paths = 0;

    std::size_t num_packets() const { return (paths + kPacketSize - 1) / kPacketSize; }

    void clear() { paths = 0; }

    /// The packet of the next lane, which is counted from here on.
    PathPacket& next();
    /// May be the wave's own packet, at or behind the next lane.
    void append(const PathPacket& from, std::size_t lane);
    void append(const PathPacket& from);
    /// Makes the rest of the last packet invalid.
    void finish();
  };

  /// Light that arrives if nothing stands in its way.
  struct Pending {
    std::uint32_t path = 0;
    std::int32_t group = 0;
    std::array<float, 3> radiance = {};
  };

  void start(const Tile& tile, int first, int count);
  void start_pixels(const Tile& tile, int count);
  void aim_cameras(const Tile& tile);
  void aim_camera(const Tile& tile, PathPacket& packet, std::size_t lane) const;
  void trace_wave(Wave& wave, Coherence coherence);
  void keep_hits(Wave& wave);
  void look_at_part();
  void look_at_lights(PathPacket& packet, bool is_camera);
  void reflect_all(int reflection);
  void reflect(PathPacket& packet, SurfaceLanes& surface, int reflection);
  void ask_for(const PathPacket& packet, const SurfaceLanes& surface);
  void go_on(PathPacket& packet, const std::int32_t* is_open);
  void trace_shadows();
  void add_light(std::uint32_t path, std::int32_t group, const std::array<float, 3>& radiance);

  const PathTask& task_;
  PacketStages stages_;
  TileSums tile_sums_;
  Wave wave_;
  Wave next_;
  std::vector<SurfaceLanes> surfaces_;  ///< where the packets of wave_ met the part
  std::vector<TilePixel> pixels_;       ///< of each path
  std::vector<double> totals_;          ///< of each path
  std::array<std::uint32_t, kTilePixels> seeds_ = {};
  std::array<float, kTilePixels> columns_ = {};  ///< of the pixels' corners over the focal length
  std::array<float, kTilePixels> rows_ = {};
  std::vector<Pending> pending_;
  std::vector<RayPacket> shadows_;
  ArrivingLanes arriving_;
  LightLanes light_;
  PathCounts counts_;
};

}  // namespace glint
