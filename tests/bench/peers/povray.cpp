// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/peers/povray.h"

#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/text.h"
#include "tests/bench/peers/process.h"

namespace glint::peers {
namespace {

/// The scene without part.inc; `Shift` is declared on the command line.
std::string scene_text(const SceneSettings& scene) {
  const TunnelSettings& tunnel = scene.tunnel;
  const PinholeIntrinsics camera = intrinsics_of(scene.camera);
  const std::vector<double>& eye_mm = scene.viewpoint().position_mm;
  return fmt::format(
      "#version 3.7;\n"
      "global_settings {{ assumed_gamma 1 max_trace_level 3 }}\n"
      "camera {{ location <{},{},{}> direction <0,0,-{}> right <{},0,0> up <0,{},0> }}\n"
      "#include \"part.inc\"\n"
      "#declare R = {}; #declare L = {}; #declare Slot = {};\n"
      "cylinder {{ <-L/2,0,0>, <L/2,0,0>, R open\n"
      "  clipped_by {{ difference {{\n"
      "    box {{ <-L,-2*R,0>, <L,2*R,2*R> }} box {{ <-2*L,-Slot/2,-R>, <2*L,Slot/2,3*R> }} }} }}\n"
      "  texture {{\n"
      "    pigment {{ gradient x\n"
      "      color_map {{ [0 rgb 1] [{duty} rgb 1] [{duty} rgb 0] [1 rgb 0] }}\n"
      "      scale {} translate Shift*x }}\n"
      "    finish {{ ambient 0 diffuse 0 specular 0 emission 1 }} }} }}\n",
      eye_mm[0],
      eye_mm[1],
      eye_mm[2],
      camera.focal_px.x(),
      camera.width_px,
      camera.height_px,
      tunnel.radius_mm,
      tunnel.length_mm,
      tunnel.slot_mm,
      tunnel.period_mm,
      fmt::arg("duty", tunnel.duty));
}

/// "Trace Time: 0 hours 0 minutes 2 seconds (2.241 seconds)\n using 1 thread(s) with 2.232
/// CPU-seconds total" gives 2.232.
double logged_seconds(const std::string& log, std::string_view what) {
  constexpr std::string_view kBefore = " with ";
  std::size_t at = log.find(what);
  at = at == std::string::npos ? at : log.find(kBefore, at);
  if (at == std::string::npos) {
    throw Error(fmt::format("POV-Ray's output has no \"{}\"", what));
  }
  return std::strtod(log.c_str() + at + kBefore.size(), nullptr);
}

/// "... Ray Tracer Version 3.7.0.10.unofficial" gives 3.7.0.10.unofficial.
std::string version_in(const std::string& log) {
  constexpr std::string_view kBefore = "Version ";
  const std::size_t at = log.find(kBefore);
  if (at == std::string::npos) {
    return "of unknown version";
  }
  const std::size_t begin = at + kBefore.size();
  return log.substr(begin, log.find_first_of(" \r\n", begin) - begin);
}

struct Times {
  double process_s = 0.0;
  double parse_s = 0.0;
  double trace_s = 0.0;
  std::string version;
};

std::vector<std::string> command(const SceneSettings& scene,
                                 const PovraySettings& settings,
                                 double shift_mm,
                                 const std::string& image) {
  return {"povray",
          "+Ipeer.pov",
          "+O" + image,
          "+FE",
          fmt::format("+W{}", scene.camera.width_px),
          fmt::format("+H{}", scene.camera.height_px),
          "+WT1",
          "-D",
          "-P",
          "-J",
          "+AM1",
          fmt::format("+A{:.2f}", settings.threshold),
          fmt::format("+R{}", settings.depth),
          "Declare=Shift=" + shortest(shift_mm)};
}

Times time_frame(const SceneSettings& scene,
                 const PovraySettings& settings,
                 int frame,
                 const std::filesystem::path& folder) {
  const std::string name = fmt::format("povray_{}_{}", settings.name, frame);
  const auto log_file = folder / (name + ".log");
  Times times;
  times.process_s = run_program(
      command(scene, settings, frame * scan_step_mm(scene.scan, scene.tunnel), name + ".exr"),
      folder,
      log_file);
  const std::string log = read_file(log_file);
  times.parse_s = logged_seconds(log, "Parse Time:");
  times.version = version_in(log);
  times.trace_s = logged_seconds(log, "Trace Time:");
  return times;
}

}  // namespace

std::vector<Result> measure_povray(const SceneSettings& scene,
                                   const PovraySettings& settings,
                                   const std::filesystem::path& folder) {
  write_file(folder / "peer.pov", scene_text(scene));
  Result whole;
  Times mean;
  for (int frame = 0; frame < settings.timed_frames; ++frame) {
    const Times times = time_frame(scene, settings, frame, folder);
    mean.process_s += times.process_s / settings.timed_frames;
    mean.parse_s += times.parse_s / settings.timed_frames;
    mean.trace_s += times.trace_s / settings.timed_frames;
    mean.version = times.version;
    whole.samples_s.push_back(times.process_s);
  }
  const int rays = settings.depth * settings.depth;
  whole.tool = "POV-Ray";
  whole.setting = fmt::format(
      "R{} {}",
      settings.depth,
      settings.threshold > 0.0
          ? fmt::format("adaptive, threshold {}, 1 to {} rays/px", settings.threshold, 1 + rays)
          : fmt::format("everywhere, 1 + {} rays/px", rays));
  whole.frame_s = mean.process_s;
  whole.warm_s = whole.cold_s = mean.process_s * scene.scan.positions;
  whole.frame = read_image(folder / fmt::format("povray_{}_0.exr", settings.name));
  whole.notes =
      fmt::format("one process a frame (parsing {:.3g} s, tracing {:.3g} s); {} measured, extended",
                  mean.parse_s,
                  mean.trace_s,
                  settings.timed_frames);
  whole.settings = {
      mean.version + ", +AM1 -J +FE +WT1, and +A0.00 (everywhere) or +A0.10 (adaptive)",
      "part: mesh2 as text, reflection 1; no light sources",
      "tunnel: open cylinder with clipped_by, emission 1; max_trace_level 3"};
  Result tracing = whole;
  tracing.setting = fmt::format("R{}, tracing alone", settings.depth);
  tracing.frame_s = mean.trace_s;
  tracing.warm_s = mean.trace_s * scene.scan.positions;
  tracing.cold_s = 0.0;
  tracing.frame = ImageF();
  tracing.samples_s.clear();
  tracing.notes = "as if POV-Ray kept the mesh between frames, which it does not";
  return {whole, tracing};
}

}  // namespace glint::peers
