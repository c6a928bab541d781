// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/outlines.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/image/image_io.h"
#include "metrics/overlap/edge_location.h"
#include "metrics/overlap/inner_edges.h"
#include "metrics/overlap/outline.h"
#include "metrics/overlap/region_overlap.h"
#include "metrics/shape/equivalent_ellipse.h"
#include "metrics/shape/silhouette.h"
#include "studies/compare/grab_cut.h"
#include "studies/compare/guided_outline.h"
#include "studies/inspect/picture_sequence.h"

namespace glint {
namespace {

constexpr int kReducedPx = 600;  ///< pictures are reduced to not less than this
constexpr int kMaxFactor = 4;
constexpr double kFillsPicture = 0.98;   ///< share from which a part leaves no background
constexpr double kMinAlike = 0.2;        ///< IoU below which two silhouettes are not of one part
constexpr double kMinLocated = 0.3;      ///< share of a cut's outline at which there are edges
constexpr double kMaxApartShare = 0.05;  ///< of the picture's width: farther edges are others
constexpr double kWellShown = 0.7;       ///< of the simulated edges

int factor_of(const ImageF& picture) {
  return std::clamp(std::max(picture.width(), picture.height()) / kReducedPx, 1, kMaxFactor);
}

ImageF reduced(const ImageF& picture, int factor) {
  return factor == 1 ? picture : reduce(picture, factor);
}

Mask at_least(const ImageF& values, float limit) {
  Mask mask(values.width(), values.height());
  std::ranges::transform(values.values(), mask.values().begin(), [&](float value) {
    return static_cast<unsigned char>(value >= limit ? 1 : 0);
  });
  return mask;
}

double share_of(const Mask& mask) {
  return static_cast<double>(std::ranges::count_if(mask.values(), [](auto v) { return v != 0; })) /
         static_cast<double>(std::max<std::size_t>(mask.size(), 1));
}

ImageF as_image(const Mask& mask) {
  ImageF image(mask.width(), mask.height());
  std::ranges::transform(
      mask.values(), image.values().begin(), [](auto v) { return v != 0 ? 1.0F : 0.0F; });
  return image;
}

/// Reduced mask of what the renderer says, or of a mask's file.
std::optional<Mask> known_mask(const ComparedPicture& picture, int factor) {
  const std::filesystem::path& mask = picture.source.mask;
  if (mask.empty()) {
    return std::nullopt;
  }
  return at_least(reduced(as_image(read_mask(mask, picture.width(), picture.height())), factor),
                  0.5F);
}

/// Both silhouettes, reduced, and how they were found.
struct MaskPair {
  Mask simulated;
  Mask real;
  OutlineMethod simulated_method = OutlineMethod::kThreshold;
  OutlineMethod real_method = OutlineMethod::kThreshold;
};

class MaskFinder {
 public:
  MaskFinder(const ComparedPicture& simulated, const ComparedPicture& real)
      : factor_(factor_of(real.grey)),
        simulated_(reduced(simulated.grey, factor_)),
        real_(reduced(real.grey, factor_)),
        truth_(known_mask(simulated, factor_)) {}

  int factor() const { return factor_; }

  bool fills_picture() const { return truth_ && share_of(*truth_) > kFillsPicture; }

  MaskPair with_real_mask(const Mask& mask) const {
    const Silhouette bright = find_silhouette(simulated_, PartPieces::kAll);
    if (!truth_ && !bright.mask) {
      throw ConfigError("the simulated part: " + std::string(sentence(*bright.fault)));
    }
    return {.simulated = truth_ ? *truth_ : *bright.mask,
            .real = at_least(reduced(as_image(mask), factor_), 0.5F),
            .simulated_method = truth_ ? OutlineMethod::kTruth : OutlineMethod::kThreshold,
            .real_method = OutlineMethod::kMask};
  }

  /// @param why  receives why there is none
  std::optional<MaskPair> by_threshold(std::string& why) const {
    const Silhouette simulated = find_silhouette(simulated_, PartPieces::kAll);
    const Silhouette real = find_silhouette(real_, PartPieces::kAll);
    if (!simulated.mask || !real.mask) {
      why = sentence(!real.mask ? *real.fault : *simulated.fault);
      return std::nullopt;
    }
    if (real.touches_border && !simulated.touches_border) {
      why = "what is bright in the real picture leaves it, the simulated part does not";
      return std::nullopt;
    }
    return MaskPair{.simulated = *simulated.mask, .real = *real.mask};
  }

  std::optional<MaskPair> by_cut(std::string& why) const {
    std::optional<Mask> rough = truth_;
    if (!rough) {
      rough = find_silhouette(simulated_, PartPieces::kAll).mask;
    }
    if (!rough) {
      why = "the simulated part has no outline that a cut could begin with";
      return std::nullopt;
    }
    std::optional<Mask> cut = grab_cut(real_, *rough);
    if (!cut) {
      why = "the cut left nothing on one side";
      return std::nullopt;
    }
    return MaskPair{.simulated = std::move(*rough),
                    .real = std::move(*cut),
                    .simulated_method = truth_ ? OutlineMethod::kTruth : OutlineMethod::kThreshold,
                    .real_method = OutlineMethod::kGrabCut};
  }

 private:
  int factor_;
  ImageF simulated_;
  ImageF real_;
  std::optional<Mask> truth_;
};

PartOutline outline_in(const ComparedPicture& picture,
                       const Mask& mask,
                       int factor,
                       OutlineMethod method) {
  PartOutline outline = {.method = method, .rough = outlines_of(mask, factor)};
  const std::vector<LocatedEdge> edges =
      locate_edges(picture.grey, outline.rough, {.reach_px = 3.0 + 0.75 * factor});
  outline.located = joined(edges, outline.rough);
  outline.coverage = filled(refined(outline.rough, edges), picture.width(), picture.height());
  return outline;
}

std::size_t points_of(const std::vector<Boundary>& lines) {
  std::size_t count = 0;
  for (const Boundary& line : lines) {
    count += line.points.size();
  }
  return count;
}

/// Of the points of the rough outline, those that an edge was found at.
double located_share(const PartOutline& outline) {
  return static_cast<double>(points_of(outline.located)) /
         static_cast<double>(std::max<std::size_t>(points_of(outline.rough), 1));
}

/// @param has_region  the region within the outline is the part's, too
void take(compare_detail::GuidedOutline guided,
          OutlineMethod method,
          bool has_region,
          PartOutline& outline) {
  outline.method = method;
  outline.rough = std::move(guided.rough);
  outline.located = std::move(guided.located);
  if (has_region) {
    outline.coverage = filled(guided.refined, outline.coverage.width(), outline.coverage.height());
  }
}

/// Edges of a part that is darker than what is around it have the other sign.
ImageF negative_of(ImageF picture) {
  for (float& grey : picture.values()) {
    grey = 1.0F - grey;
  }
  return picture;
}

/// Outlines found along the one that the renderer knows. A cut is there because brightness tells
/// nothing: it stays unless most of the outline shows, with either sign of its edges.
std::optional<compare_detail::GuidedOutlines> guided(const ComparedPicture& simulated,
                                                     const ComparedPicture& real,
                                                     const Mask& truth,
                                                     OutlinePair& found) {
  const double reach_px = kMaxApartShare * real.width();
  const Eigen::Vector2d shift_px = middle_shift_px(found);
  const auto along = [&](const ImageF& picture) {
    return compare_detail::guided_outlines(
        simulated.grey, picture, truth, found.real.located, reach_px, shift_px);
  };
  auto result = along(real.grey);
  const auto is_well_shown = [&] { return result && result->share >= kWellShown; };
  if (found.real.method == OutlineMethod::kGrabCut && !is_well_shown()) {
    result = along(negative_of(real.grey));
    if (!is_well_shown()) {
      return std::nullopt;
    }
    found.notes.emplace_back(
        "Beside the part one picture is darker and the other brighter than the part: real edges of "
        "the other sign were looked for along its outline.");
  }
  return result;
}

/// Edges along the outline that the renderer knows, in place of those around what is bright or of a
/// cut; and the regions within it where most of it shows in the real picture. The rest of the real
/// outline is the simulated one moved as a whole.
void guide(const ComparedPicture& simulated, const ComparedPicture& real, OutlinePair& found) {
  const std::filesystem::path& mask = simulated.source.mask;
  if (mask.empty()) {
    return;
  }
  auto outlines = guided(simulated, real, read_mask(mask, real.width(), real.height()), found);
  if (!outlines) {
    return;
  }
  found.motion = outlines->motion;
  found.shown = outlines->share;
  if (const std::string note = compare_detail::untold_shift_note(*found.motion); !note.empty()) {
    found.notes.push_back(note);
  }
  const bool is_well_shown = outlines->share >= kWellShown;
  take(std::move(outlines->simulated), OutlineMethod::kTruth, is_well_shown, found.simulated);
  take(std::move(outlines->real), OutlineMethod::kGuided, is_well_shown, found.real);
  if (!is_well_shown) {
    found.notes.push_back(
        fmt::format("The real picture has {:.0f} % of the outline's edges that the simulated one "
                    "has.",
                    100.0 * found.shown));
  }
}

/// Grey between the dark and the bright half of a picture.
std::optional<double> middle_grey(const ImageF& picture) {
  const Silhouette found = find_silhouette(picture, PartPieces::kAll);
  return found.threshold > 0.0 ? std::optional(found.threshold) : std::nullopt;
}

OutlinePair inside_pictures(const ComparedPicture& simulated, const ComparedPicture& real) {
  const std::optional<double> level = middle_grey(simulated.grey);
  OutlinePair pair;
  if (!level) {
    pair.notes.emplace_back("The simulated picture has no edges to look for in the real one.");
    return pair;
  }
  InnerEdges edges = inner_edges(simulated.grey, real.grey, static_cast<float>(*level));
  if (edges.share() < kWellShown) {
    pair.notes.push_back(
        fmt::format("The real picture has {:.0f} % of the edges that the simulated one has, within "
                    "{:.0f} px.",
                    100.0 * edges.share(),
                    kInnerReachPx));
  }
  pair.simulated.rough = edges.lines;
  pair.simulated.located = std::move(edges.simulated);
  pair.real.rough = std::move(edges.lines);
  pair.real.located = std::move(edges.real);
  return pair;
}

/// As chosen, or the first of threshold and cut that two silhouettes of one part come from.
std::optional<MaskPair> masks_of(const MaskFinder& finder,
                                 OutlineChoice choice,
                                 std::vector<std::string>& notes) {
  std::string why;
  if (choice == OutlineChoice::kAuto || choice == OutlineChoice::kThreshold) {
    std::optional<MaskPair> masks = finder.by_threshold(why);
    const bool is_alike = masks && overlap_of(masks->simulated, masks->real).iou >= kMinAlike;
    if (masks && (is_alike || choice == OutlineChoice::kThreshold)) {
      return masks;
    }
    if (choice == OutlineChoice::kThreshold) {
      throw ConfigError("--outline threshold: " + why);
    }
    notes.push_back("No silhouette by brightness: " +
                    (why.empty() ? std::string("both overlap by less than a fifth") : why) + ".");
  }
  std::optional<MaskPair> masks = finder.by_cut(why);
  if (!masks && choice == OutlineChoice::kGrabCut) {
    throw ConfigError("--outline grab_cut: " + why);
  }
  return masks;
}

}  // namespace

std::string name_of(OutlineMethod method) {
  switch (method) {
    case OutlineMethod::kMask:
      return "mask";
    case OutlineMethod::kTruth:
      return "truth";
    case OutlineMethod::kThreshold:
      return "threshold";
    case OutlineMethod::kGrabCut:
      return "grab_cut";
    case OutlineMethod::kGuided:
      return "along_simulated";
    case OutlineMethod::kInner:
      return "inner_edges";
  }
  return "";
}

OutlineChoice outline_choice(const std::string& name) {
  constexpr std::array<std::pair<const char*, OutlineChoice>, 4> kNames = {
      {{"auto", OutlineChoice::kAuto},
       {"threshold", OutlineChoice::kThreshold},
       {"grab_cut", OutlineChoice::kGrabCut},
       {"inner", OutlineChoice::kInner}}};
  for (const auto& [known, choice] : kNames) {
    if (name == known) {
      return choice;
    }
  }
  throw ConfigError(
      fmt::format("--outline: is {}, must be auto, threshold, grab_cut or inner", name));
}

Eigen::Vector2d middle_shift_px(const OutlinePair& outlines) {
  const auto simulated = moments_of(outlines.simulated.coverage);
  const auto real = moments_of(outlines.real.coverage);
  return simulated && real
             ? Eigen::Vector2d(real->x_px - simulated->x_px, real->y_px - simulated->y_px)
             : Eigen::Vector2d(0.0, 0.0);
}

OutlinePair find_outlines(const ComparedPicture& simulated,
                          const ComparedPicture& real,
                          const std::filesystem::path& real_mask,
                          OutlineChoice choice) {
  const MaskFinder finder(simulated, real);
  std::optional<MaskPair> masks;
  std::vector<std::string> notes;
  if (!real_mask.empty()) {
    const Mask mask = read_mask(real_mask, real.width(), real.height());
    if (share_of(mask) == 1.0) {
      notes.emplace_back("The mask is white all over: where the part is not it should be black.");
    }
    masks = finder.with_real_mask(mask);
  } else if (choice != OutlineChoice::kInner && !finder.fills_picture()) {
    masks = masks_of(finder, choice, notes);
  }
  OutlinePair found = {.notes = std::move(notes)};
  if (masks) {
    found.simulated =
        outline_in(simulated, masks->simulated, finder.factor(), masks->simulated_method);
    found.real = outline_in(real, masks->real, finder.factor(), masks->real_method);
    if (choice == OutlineChoice::kAuto && masks->real_method != OutlineMethod::kMask) {
      guide(simulated, real, found);
    }
    if (found.real.method != OutlineMethod::kGrabCut || located_share(found.real) >= kMinLocated) {
      return found;
    }
    if (choice == OutlineChoice::kGrabCut) {
      throw ConfigError("--outline grab_cut: the cut follows no edge of the real picture");
    }
    found.notes.emplace_back("A cut around where the part should be follows no edge.");
  }
  OutlinePair inner = inside_pictures(simulated, real);
  inner.notes.insert(inner.notes.begin(), found.notes.begin(), found.notes.end());
  inner.notes.emplace_back("The part has no silhouette in the pictures: edges inside them serve.");
  return inner;
}

}  // namespace glint
