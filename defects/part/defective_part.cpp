// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/defective_part.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/wall_clock.h"
#include "defects/boolean/imprint.h"
#include "defects/part/height_defects.h"
#include "defects/places/sampler.h"
#include "defects/surface/displacement.h"
#include "defects/surface/exact_facets.h"
#include "defects/surface/processing.h"
#include "defects/surface/surface_normals.h"
#include "defects/tools/tools.h"
#include "simulator/geometry/surface/surface_path.h"

namespace glint {
namespace {

/// Steps of the path that a line's tool is swept along.
constexpr double kPathSteps = 128.0;

/// A path runs on beyond its line's ends by this share of its length, for the tool's own ends.
constexpr double kPathBeyond = 0.1;

/// Of a defect's depth: facets under it are at most this far off their exact surface.
constexpr double kFacetShare = 0.01;

/// Another small move of the tool may help; for all other outcomes only another place does.
bool is_worth_a_jitter(ImprintOutcome outcome) {
  return outcome == ImprintOutcome::kOpenSeam || outcome == ImprintOutcome::kSelfIntersection ||
         outcome == ImprintOutcome::kDegenerate || outcome == ImprintOutcome::kBrokenPatch;
}

void count_refusal(RealisedDefect& made, const std::string& reason) {
  const auto known =
      std::ranges::find_if(made.refusals, [&](const auto& entry) { return entry.first == reason; });
  if (known == made.refusals.end()) {
    made.refusals.emplace_back(reason, 1);
  } else {
    ++known->second;
  }
}

std::string too_flat_text() {
  return fmt::format(
      "it is too flat for so curved a surface, which would need more than {} "
      "triangles there; make it deeper or smaller, or realise it by its normal",
      kMaxFacetsUnderTool);
}

std::string given_up_text(const RealisedDefect& made) {
  std::string text = fmt::format("given up after {} samples: ", made.attempts);
  for (std::size_t i = 0; i < made.refusals.size(); ++i) {
    text += fmt::format(
        "{}{} ({} times)", i > 0 ? "; " : "", made.refusals[i].first, made.refusals[i].second);
  }
  return text;
}

SurfacePlace turned_across(const SurfacePlace& place) {
  SurfacePlace turned = place;
  turned.u_axis = place.v_axis;
  turned.v_axis = -place.u_axis;
  return turned;
}

std::vector<ToolCollection> tools_of(std::span<const NamedGroup> groups) {
  std::vector<ToolCollection> tools;
  for (const auto& [name, group] : groups) {
    tools.emplace_back(name, group);
  }
  return tools;
}

}  // namespace

struct DefectMaker::State {
  State(std::shared_ptr<const Part> on_part,
        std::shared_ptr<const Bvh> with_bvh,
        std::vector<NamedGroup> named,
        const ImprintSettings& imprint,
        double max_crease_rad)
      : part(std::move(on_part)),
        bvh(std::move(with_bvh)),
        groups(std::move(named)),
        settings(imprint),
        crease_rad(max_crease_rad),
        tools(tools_of(groups)),
        sampler(*part, *bvh, groups, settings, crease_rad) {}

  std::shared_ptr<const Part> part;
  std::shared_ptr<const Bvh> bvh;
  std::vector<NamedGroup> groups;
  ImprintSettings settings;
  double crease_rad = 0.0;
  std::vector<ToolCollection> tools;  ///< one a group
  DefectSampler sampler;

  /// The part before its first imprint, with its search tree; made when it is first needed.
  const ImprintedMesh& untouched() const {
    const std::scoped_lock lock(mutex);
    if (!imprinted) {
      imprinted.emplace(part->mesh);
    }
    return *imprinted;
  }

  mutable std::mutex mutex = {};
  mutable std::optional<ImprintedMesh> imprinted = {};
};

namespace {

/// The tool of a defect where it lies, swept along the surface or bent with it.
TriangleMesh placed_tool(const ToolCollection& tools,
                         const Defect& defect,
                         const Part& part,
                         const Bvh& bvh) {
  const auto path_of = [&](const SurfacePlace& place, double half_mm) {
    return surface_path(part, bvh, place, half_mm, 2.0 * half_mm / kPathSteps);
  };
  const std::int32_t id = part.mesh.patch_of(static_cast<std::size_t>(defect.triangle));
  const ExactPatch* patch = id < 0 ? nullptr : &part.patches[static_cast<std::size_t>(id)];
  if (is_line(defect.type)) {
    const double half_mm = (0.5 + kPathBeyond) * defect.length_mm;
    return tools.tool(defect, path_of(defect.place, half_mm), {.patch = patch});
  }
  const double half_mm = 0.5 * defect.diameter_mm;
  return tools.tool(defect,
                    {},
                    {.along_per_mm = path_bend(path_of(defect.place, half_mm)),
                     .across_per_mm = path_bend(path_of(turned_across(defect.place), half_mm)),
                     .patch = patch});
}

}  // namespace

/// One sample of a part's defects in the making.
class DefectMaker::Making {
 public:
  Making(const State& state, std::uint64_t seed, const ChooseRealisation& choose)
      : state_(state), seed_(seed), choose_(choose) {}

  void make(const DefectSlot& slot) {
    const auto start = std::chrono::steady_clock::now();
    RealisedDefect made;
    for (int attempt = 0; attempt < state_.settings.max_attempts && !made.is_made; ++attempt) {
      made.attempts = attempt + 1;
      try_sample(slot, attempt, made);
    }
    if (made.is_made) {
      taken_.push_back(made.defect);
    } else {
      give_up(made);
    }
    made.seconds = seconds_since(start);
    result_.defects.push_back(std::move(made));
  }

  DefectivePart finish() {
    build_mesh();
    return std::move(result_);
  }

 private:
  const DefectGroup& group_of(const DefectSlot& slot) const {
    return state_.groups[slot.group].second;
  }

  void try_sample(const DefectSlot& slot, int attempt, RealisedDefect& made) {
    DefectSampler::Draw draw = state_.sampler.draw(seed_, slot, attempt, taken_);
    if (!draw.defect) {
      count_refusal(made, draw.reason);
      made.defect = std::move(draw.refused);
      return;
    }
    const DefectGroup& group = group_of(slot);
    Defect& defect = *draw.defect;
    defect.realisation =
        group.realisation == Realisation::kAuto ? choose_(defect, group) : group.realisation;
    if (defect.type == DefectType::kStain) {
      defect.realisation = Realisation::kNormal;  // a stain has no shape
    }
    if (defect.realisation == Realisation::kImprinted) {
      imprint(state_.tools[slot.group], defect, made);
    } else {
      made.is_made = true;
    }
    made.defect = std::move(defect);
    if (!made.is_made) {
      return;
    }
    const HeightFeature feature = height_feature(made.defect, group);
    result_.outlines.push_back(feature);
    if (made.defect.realisation == Realisation::kNormal) {
      result_.features.push_back(feature);
    } else if (made.defect.realisation == Realisation::kDisplaced) {
      displaced_.push_back(feature);
    }
  }

  /// The tool as it is, then moved by little until it goes in or has been moved often enough.
  ImprintResult imprint_with_jitters(ImprintedMesh& mesh,
                                     const TriangleMesh& tool,
                                     ImprintOperation operation,
                                     const Defect& defect,
                                     RealisedDefect& made) const {
    const ImprintLimits limits = {.min_removed_mm3 = state_.settings.min_removed_mm3};
    Rng rng(defect.seed, Stream::kDefects, kJitterIndex);
    ImprintResult result = mesh.imprint(tool, defect.id, operation, limits);
    for (int jitter = 1; jitter <= state_.settings.jitters && is_worth_a_jitter(result.outcome);
         ++jitter) {
      ++made.jitters;
      result = mesh.imprint(jittered(tool, jitter_size(jitter), rng), defect.id, operation, limits);
    }
    return result;
  }

  void imprint(const ToolCollection& tools, Defect& defect, RealisedDefect& made) {
    if (!imprinted_) {
      imprinted_.emplace(state_.untouched());
    }
    defect.tool = tools.choose(defect.seed);
    const TriangleMesh tool = placed_tool(tools, defect, *state_.part, *state_.bvh);
    const ImprintOperation operation =
        tools.works_inwards() ? ImprintOperation::kSubtract : ImprintOperation::kUnite;
    ImprintedMesh finer = *imprinted_;
    if (!refine_under_tool(finer, tool, state_.part->patches, kFacetShare * defect.depth_mm)) {
      count_refusal(made, too_flat_text());
      return;
    }
    const ImprintResult result = imprint_with_jitters(finer, tool, operation, defect, made);
    made.is_made = result.is_done();
    made.removed_volume_mm3 = result.removed_volume_mm3;
    if (made.is_made) {
      imprinted_ = std::move(finer);
    } else {
      count_refusal(made, std::string(outcome_text(result.outcome)));
    }
  }

  void give_up(RealisedDefect& made) {
    made.reason = given_up_text(made);
    if (!state_.settings.may_be_fewer) {
      throw ConfigError("imprint.may_be_fewer",
                        fmt::format("is false, but {} was {}", made.defect.label, made.reason));
    }
  }

  /// What imprints left, or the part as it was.
  void take_surface(const Part& part) {
    if (imprinted_) {
      ImprintedMesh::Labelled labelled = imprinted_->result();
      result_.mesh = std::move(labelled.mesh);
      result_.labels = std::move(labelled.labels);
      set_normals(result_.mesh, part.patches, state_.crease_rad);
      imprinted_.reset();
    } else {
      result_.mesh = part.mesh;
      result_.labels.assign(part.mesh.num_triangles(), 0);
    }
  }

  /// The surface that imprints left, moved by displacements and processed.
  void build_mesh() {
    const ProcessingSettings& processing = state_.settings.processing;
    if (!imprinted_ && displaced_.empty() && !is_any(processing)) {
      return;
    }
    const Part& part = *state_.part;
    take_surface(part);
    if (!displaced_.empty()) {
      displace_surface();
    }
    count_faces();
    if (is_any(processing)) {
      Processed processed = apply_processing(processing,
                                             seed_,
                                             std::move(result_.mesh),
                                             std::move(result_.labels),
                                             part.patches,
                                             state_.crease_rad);
      result_.mesh = std::move(processed.mesh);
      result_.labels = std::move(processed.labels);
      result_.limited_vertices = processed.limited_vertices;
    }
  }

  void displace_surface() {
    Displaced displaced = displace(
        std::move(result_.mesh), std::move(result_.labels), state_.part->patches, displaced_);
    result_.mesh = std::move(displaced.mesh);
    result_.labels = std::move(displaced.labels);
    for (const DisplacedFeature& feature : displaced.features) {
      made_with(feature.id).removed_volume_mm3 = feature.removed_volume_mm3;
    }
  }

  void count_faces() {
    for (const std::int32_t label : result_.labels) {
      if (label > 0) {
        ++made_with(label).faces;
      }
    }
  }

  /// Ids count from 1 in the order of the defects.
  RealisedDefect& made_with(std::int32_t id) {
    return result_.defects[static_cast<std::size_t>(id - 1)];
  }

  /// Far from the indices a tool's own noise draws from.
  static constexpr std::uint64_t kJitterIndex = std::uint64_t{1} << 40;

  const State& state_;
  std::uint64_t seed_;
  const ChooseRealisation& choose_;
  DefectivePart result_;
  std::vector<Defect> taken_;
  std::optional<ImprintedMesh> imprinted_;
  std::vector<HeightFeature> displaced_;
};

DefectMaker::DefectMaker(std::shared_ptr<const Part> part,
                         std::shared_ptr<const Bvh> bvh,
                         std::vector<NamedGroup> groups,
                         const ImprintSettings& settings,
                         double crease_rad)
    : state_(std::make_unique<const State>(
          std::move(part), std::move(bvh), std::move(groups), settings, crease_rad)) {}

DefectMaker::~DefectMaker() = default;
DefectMaker::DefectMaker(DefectMaker&&) noexcept = default;
DefectMaker& DefectMaker::operator=(DefectMaker&&) noexcept = default;

DefectivePart DefectMaker::make(std::uint64_t seed,
                                const ChooseRealisation& choose,
                                const std::function<void(int)>& progress) const {
  Making making(*state_, seed, choose);
  int done = 0;
  for (const DefectSlot& slot : state_->sampler.slots(seed)) {
    making.make(slot);
    if (progress) {
      progress(++done);
    }
  }
  return making.finish();
}

}  // namespace glint
