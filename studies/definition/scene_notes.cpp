// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_notes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

std::string range_text(double low, double high) {
  return shortest(std::round(low * 100.0) / 100.0) + " to " + length_text(high);
}

std::string degrees_text(double angle_rad) {
  return shortest(std::round(angle_rad * kDegPerRad * 10.0) / 10.0) + "\u00b0";
}

/// A light's name in front of its type, where it says more.
std::string named(const std::string& name, std::string_view type) {
  return name == type ? name : fmt::format("{}: {}", name, type);
}

std::string line_of(const TunnelSettings& settings) {
  const Tunnel tunnel(settings);
  return fmt::format(
      "{}, {} wide, up to {} above the origin, {} long, slot {}, stripes of period {}, bright "
      "share {:.3g}",
      shape_name(settings.shape),
      length_text(2.0 * tunnel.half_width_mm()),
      length_text(tunnel.top_mm()),
      length_text(settings.length_mm),
      length_text(settings.slot_mm),
      length_text(settings.period_mm),
      settings.duty);
}

std::string line_of(const RingSettings& ring) {
  std::string text = "radii " + range_text(ring.inner_radius_mm, ring.outer_radius_mm);
  text += ring.height_mm != 0.0 ? ", at " + length_text(ring.height_mm) : "";
  text += ring.tilt_rad != 0.0 ? ", tilted by " + degrees_text(ring.tilt_rad) : "";
  return text + (ring.leds > 0 ? fmt::format(", {} LEDs", ring.leds) : "");
}

std::string line_of(const DomeSettings& dome) {
  return "radius " + length_text(dome.radius_mm) + ", opening " + length_text(dome.opening_mm);
}

std::string line_of(const BarSettings& bar) {
  return length_text(bar.length_mm) + " x " + length_text(bar.width_mm);
}

std::string line_of(const CoaxialSettings& light) {
  return length_text(light.width_mm) + " x " + length_text(light.height_mm);
}

std::string line_of(const MeshLightSettings& light) {
  return light.file.filename().string();
}

std::string line_of(const EnvironmentSettings& light) {
  return light.file.empty() ? "the same from everywhere" : light.file.filename().string();
}

std::string line_of(const IesLightSettings& light) {
  return light.file.filename().string();
}

std::string_view mount_text(LightPlacement::Mount mount) {
  switch (mount) {
    case LightPlacement::Mount::kPart:
      return ", on the part";
    case LightPlacement::Mount::kCamera:
      return ", on the camera";
    case LightPlacement::Mount::kScene:
      break;
  }
  return ", fixed in the scene";
}

/// Lights that move with a part that is not at rest, which earlier versions left in the scene.
std::vector<std::string> mount_notes(const SceneSettings& scene) {
  std::vector<std::string> notes;
  for (const NamedLight& light : scene.lights) {
    if (is_posed(scene) && mount_of(light.settings) == LightPlacement::Mount::kPart) {
      notes.push_back(
          fmt::format("lighting.{}.mount is \"part\": the light moves with part.position_mm and "
                      "part.rotation_deg. Before, it stayed in the scene, which is \"scene\" now.",
                      light.name));
    }
  }
  return notes;
}

/// Whether the scan gives every lit pixel the same number of bright positions, and what that means.
SceneNote scan_note(const SceneSettings& scene) {
  const TunnelSettings& tunnel = scene.tunnel;
  const double bright = scene.scan.positions * tunnel.duty;
  const double periods = scene.scan.positions * scan_step_mm(scene.scan, tunnel) *
                         std::cos(tunnel.orientation_rad) / tunnel.period_mm;
  const auto is_whole = [](double value) { return std::abs(value - std::round(value)) < 1e-9; };
  if (!is_whole(periods) || !is_whole(bright)) {
    return {.kind = NoteKind::kRipple,
            .text = fmt::format("{} positions x duty {:g} over {:g} {} is not a whole number "
                                "of bright positions over whole periods: the flawless surface "
                                "itself shows a ripple.",
                                scene.scan.positions,
                                tunnel.duty,
                                periods,
                                std::abs(periods - 1.0) < 1e-9 ? "period" : "periods")};
  }
  std::string note = fmt::format(
      "{} positions x duty {:g} is a whole number of bright positions over whole periods: where "
      "the wall is lit throughout, the mean of a linear sensor is the same everywhere; what the "
      "mean image shows is due to clipping",
      scene.scan.positions,
      tunnel.duty);
  if (tunnel.led_ripple > 0.0 || tunnel.end_falloff > 0.0 || tunnel.cosine_law) {
    note += " and to the uneven brightness of the wall in this scene";
  }
  return {.text = note + "."};
}

std::string rendering_note(const SceneSettings& scene) {
  if (is_direct(scene)) {
    return "Direct light: summed over the lights without noise; powers of lights are factors of "
           "pictures that are rendered once.";
  }
  return fmt::format(
      "Path tracing: {} samples per pixel, at most {} on the part; powers "
      "of lights are "
      "factors of pictures that are rendered once.",
      scene.paths.samples,
      reflections_text(scene.paths));
}

/// A surface that scatters nothing, where only ring, dome, bar and the like shine on it; empty
/// otherwise. A tunnel or surroundings fill what it mirrors.
std::string mirror_note(const SceneSettings& scene) {
  const MaterialSettings& material = scene.material;
  const bool is_smooth =
      material.alpha.empty()
          ? material.roughness == 0.0
          : std::ranges::all_of(material.alpha, [](double alpha) { return alpha == 0.0; });
  const bool is_mirror = material.type == MaterialSettings::Type::kMirror ||
                         (material.type == MaterialSettings::Type::kConductor && is_smooth);
  const bool has_surroundings =
      scene.has_tunnel || std::ranges::any_of(scene.lights, [](const NamedLight& light) {
        return is_surrounding(light.settings);
      });
  if (!is_mirror || has_surroundings || scene.lights.empty()) {
    return "";
  }
  return "The part is a mirror without roughness: it is bright only where it reflects a light into "
         "the camera and black elsewhere, where no defect shows. Give it the roughness of its "
         "finish (material.type = \"conductor\" with a roughness), or light it with a tunnel.";
}

/// How a path-traced scene is lit and rendered.
std::vector<std::string> path_notes(const SceneSettings& scene, const Scores& scores) {
  std::vector<std::string> notes;
  for (const std::string& line : light_lines(scene)) {
    notes.push_back("Light " + line + ".");
  }
  const std::vector<std::string> mounts = mount_notes(scene);
  notes.insert(notes.end(), mounts.begin(), mounts.end());
  if (const std::string note = mirror_note(scene); !note.empty()) {
    notes.push_back(note);
  }
  notes.push_back(rendering_note(scene));
  const auto mean = scores.find("homogeneity.mean");
  if (mean != scores.end() && mean->second <= 0.0) {
    notes.emplace_back(
        "No light reaches the part in this picture: check the lights' positions, "
        "directions and powers.");
  }
  if (scene.viewpoints.size() > 1) {
    notes.emplace_back("Scores are those of the first viewpoint.");
  }
  const auto value = scores.find("homogeneity.h_rms");
  const auto error = scores.find("homogeneity.h_rms.error");
  if (value != scores.end() && error != scores.end()) {
    notes.push_back(
        fmt::format("Standard errors of the scores, from the scatter of independent pictures, are "
                    "separate scores that end in .error: h (rms) is {:.3f} +- {:.3f} %.",
                    100.0 * value->second,
                    100.0 * error->second));
  }
  return notes;
}

}  // namespace

std::vector<std::string> light_titles(const SceneSettings& scene) {
  std::vector<std::string> titles;
  if (scene.has_tunnel) {
    titles.push_back(named(scene.tunnel_name, "tunnel"));
  }
  for (const NamedLight& light : scene.lights) {
    titles.push_back(named(light.name, light_type(light.settings)));
  }
  return titles;
}

std::vector<std::string> light_lines(const SceneSettings& scene) {
  std::vector<std::string> lines;
  if (scene.has_tunnel) {
    lines.push_back(named(scene.tunnel_name, "tunnel") + ", " + line_of(scene.tunnel));
  }
  for (const NamedLight& light : scene.lights) {
    lines.push_back(std::visit(
        [&](const auto& settings) {
          using Settings = std::decay_t<decltype(settings)>;
          const bool is_everywhere = std::is_same_v<Settings, EnvironmentSettings>;
          return fmt::format("{}, {}{}",
                             named(light.name, light_type(light.settings)),
                             line_of(settings),
                             is_everywhere ? "" : mount_text(settings.placement.mount));
        },
        light.settings));
  }
  return lines;
}

std::string scan_line(const SceneSettings& scene) {
  if (!scene.has_tunnel) {
    return "";
  }
  return scene.scan.positions == 1
             ? std::string("one image")
             : fmt::format("{} images, a step of {} between them",
                           scene.scan.positions,
                           length_text(scan_step_mm(scene.scan, scene.tunnel)));
}

namespace {

/// Warnings where glint stability found scores beyond its bounds (docs/stability.md).
std::vector<SceneNote> stability_notes(const SceneSettings& scene, const Scores& scores) {
  std::vector<SceneNote> notes;
  const auto clipped = scores.find("homogeneity.clipped_share");
  if (clipped != scores.end() && clipped->second > 0.05) {
    notes.push_back({.kind = NoteKind::kSaturated,
                     .text = fmt::format("{:.3g} % of the region is at full scale in every frame: "
                                         "no defect can show there, and h counts it as even.",
                                         100.0 * clipped->second)});
  }
  const double min_px = std::min(scene.camera.width_px, scene.camera.height_px);
  if (scene.sensor.blur_px > 0.08 * min_px) {
    notes.push_back({.kind = NoteKind::kRepeatedBorder,
                     .text = fmt::format("A blur of {:g} px is wide for a picture of {:g} px: "
                                         "beyond its border the border's pixels are repeated, "
                                         "which a camera does not see.",
                                         scene.sensor.blur_px,
                                         min_px)});
  }
  const SensorSettings& sensor = scene.sensor;
  const double noise = sensor.full_well_e > 0.0
                           ? std::hypot(std::sqrt(0.5 * sensor.gain / sensor.full_well_e),
                                        sensor.read_noise_e * sensor.gain / sensor.full_well_e)
                           : 0.0;
  if (noise > 0.04 && !scene.defects.empty()) {
    notes.push_back({.kind = NoteKind::kFrameNoise,
                     .text = fmt::format("Noise of a frame is {:.2g} % of full scale at half of "
                                         "it: the change of a defect in its best frame holds this "
                                         "noise.",
                                         100.0 * noise)});
  }
  return notes;
}

/// Stripes that pixels cannot separate, or that are narrower than a pixel.
std::string fine_stripes_note(const SceneSettings& scene) {
  const TunnelSettings& tunnel = scene.tunnel;
  const double period_px =
      tunnel.period_mm / lens_geometry(scene.camera, scene.lens).object_pixel_mm;
  const double narrower_px = period_px * std::min(tunnel.duty, 1.0 - tunnel.duty);
  if (scene.has_tunnel && period_px < 4.0) {
    return fmt::format(
        "A period of the stripes is {:.2g} pixels on the part, and less in the mirror: pixels "
        "alias them, and blur is applied to pixels: frames and what changes in them by a defect "
        "are uncertain.",
        period_px);
  }
  if (scene.has_tunnel && narrower_px > 0.0 && narrower_px < 1.0) {
    return fmt::format(
        "The {} stripes are {:.2g} pixels wide on the part, and less in the mirror: frames and "
        "what changes in them by a defect are uncertain.",
        tunnel.duty < 0.5 ? "bright" : "dark",
        narrower_px);
  }
  return {};
}

/// How the light of the scene comes about. Lobes of rough metal see the slot and the wall's ends:
/// there is nothing to say of their scan.
std::vector<SceneNote> light_notes(const SceneSettings& scene, const Scores& scores) {
  if (needs_paths(scene)) {
    std::vector<SceneNote> notes;
    for (std::string& text : path_notes(scene, scores)) {
      notes.push_back({.text = std::move(text)});
    }
    return notes;
  }
  return is_blurred(scene) ? std::vector<SceneNote>() : std::vector{scan_note(scene)};
}

}  // namespace

std::vector<SceneNote> scene_notes(const SceneSettings& scene, const Scores& scores) {
  std::vector<SceneNote> notes = light_notes(scene, scores);
  const auto add = [&](NoteKind kind, std::string text) {
    notes.push_back({.kind = kind, .text = std::move(text)});
  };
  if (scene.is_tunnel_guessed) {
    add(NoteKind::kScene,
        fmt::format("[lighting.{}] has no type, so it is read as a tunnel.", scene.tunnel_name));
  }
  const auto share_of = [&](const char* name) {
    const auto found = scores.find(name);
    return found == scores.end() ? 0.0 : found->second;
  };
  if (share_of("view.hidden_share") > 0.0) {
    add(NoteKind::kOccluded,
        fmt::format(
            "The wall occludes {:.3g} % of the part from the camera: the slot is too narrow "
            "there; occluded pixels are dark.",
            100.0 * share_of("view.hidden_share")));
  }
  if (share_of("rays.followed_share") + share_of("rays.blocked_share") > 0.0) {
    add(NoteKind::kScene,
        fmt::format("{:.3f} % of the rays hit the part again and were followed, {:.3f} % were "
                    "given up as dark.",
                    100.0 * share_of("rays.followed_share"),
                    100.0 * share_of("rays.blocked_share")));
  }
  if (const double cells = share_of("rays.max_cells"); cells > 0.0) {
    add(NoteKind::kCoarseCells,
        fmt::format("The part is bent within so many pixels that each has at most {0:g} x {0:g} "
                    "cells beyond "
                    "the reach of defects, where up to 16 x 16 are usual: a smaller picture or a "
                    "smoother mesh "
                    "is rendered more exactly.",
                    cells));
  }
  const std::vector<SceneNote> warnings = stability_notes(scene, scores);
  notes.insert(notes.end(), warnings.begin(), warnings.end());
  if (std::string fine = fine_stripes_note(scene); !fine.empty()) {
    add(NoteKind::kFineStripes, std::move(fine));
  }
  if (scene.tunnel.cosine_law) {
    add(NoteKind::kScene,
        "The cosine law is applied to the wall's radiance (compatibility option).");
  }
  return notes;
}

std::vector<std::string> note_texts(std::span<const SceneNote> notes) {
  std::vector<std::string> texts;
  std::ranges::transform(notes, std::back_inserter(texts), &SceneNote::text);
  return texts;
}

}  // namespace glint
