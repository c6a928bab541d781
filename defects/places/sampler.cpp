// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/places/sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"
#include "core/rng.h"
#include "defects/places/sample_distance.h"
#include "defects/places/sample_places.h"
#include "defects/places/sample_region.h"
#include "defects/places/sample_wall.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// What a defect's random numbers are for: each has its own sequence, so that drawing more for one
/// leaves the others.
enum class Use : std::uint64_t {
  kPlace,
  kDepth,
  kDiameter,
  kLength,
  kWidth,
  kAngle,
  kTilt,
  kTiltDirection
};

/// Mixes a value into a hash. Source: S. Vigna, splitmix64 (public domain), 2015.
std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  std::uint64_t z = (hash ^ value) + 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31);
}

std::uint64_t mixed(std::uint64_t hash, const std::string& text) {
  hash = mixed(hash, text.size());
  for (const char c : text) {
    hash = mixed(hash, static_cast<unsigned char>(c));
  }
  return hash;
}

/// Keeps hashes for different purposes apart.
enum class Purpose : std::uint64_t { kTotal = 1, kShares, kCount, kNumbers, kTool };

std::uint64_t start_of(std::uint64_t seed, Purpose purpose) {
  return mixed(mixed(0, seed), static_cast<std::uint64_t>(purpose));
}

double uniform(std::uint64_t hash, Use use) {
  return Rng(hash, Stream::kDefects, static_cast<std::uint64_t>(use)).uniform();
}

/// A whole number of [min, max], each equally likely.
int whole_number(const Interval& count, std::uint64_t hash) {
  const double choices = count.max - count.min + 1.0;
  const double drawn = std::floor(choices * Rng(hash, Stream::kDefects, 0).uniform());
  return static_cast<int>(count.min + std::min(drawn, choices - 1.0));
}

void check_size(const std::string& table, std::string_view key, double size_mm, double part_mm) {
  if (size_mm > part_mm) {
    throw ConfigError(
        fmt::format("{}.{}", table, key),
        fmt::format("{:g} mm is larger than the part, which is {:.4g} mm from corner to corner",
                    size_mm,
                    part_mm));
  }
}

void check_sizes(const std::string& table, const DefectGroup& group, double part_mm) {
  if (is_line(group.type)) {
    check_size(table, "length_mm", group.length_mm.max, part_mm);
    check_size(table, "width_mm", group.width_mm.max, part_mm);
  } else {
    check_size(table, "diameter_mm", group.diameter_mm.max, part_mm);
  }
  if (group.type != DefectType::kStain) {
    check_size(table, "height_um", group.height_mm.max, part_mm);
  }
}

bool goes_inwards(DefectType type) {
  return type != DefectType::kBump && type != DefectType::kStain;
}

}  // namespace

/// All a group's draws start from.
struct GroupPlaces {
  std::string name;
  DefectGroup group;
  bool is_fixed = false;
  std::vector<FixedPlace> places = {};     ///< fixed
  std::optional<PlaceRegion> region = {};  ///< random
};

struct DefectSampler::State {
  const Part& part;
  const Bvh& bvh;
  Interval total;  ///< random defects of all groups; 0: each group's own
  std::vector<GroupPlaces> groups = {};
  std::vector<double> share_sums = {};  ///< of this group and all before; fixed ones add nothing
  SharpEdges edges = {};
  bool has_distances = false;  ///< a group asks for a distance to others

  std::vector<int> counts(std::uint64_t seed) const;
  std::optional<SurfacePoint> choose_place(const GroupPlaces& places,
                                           Defect& defect,
                                           std::uint64_t hash) const;
  std::string refusal(const GroupPlaces& places,
                      const Defect& defect,
                      std::span<const Defect> taken) const;
  std::string fit_to_wall(const DefectGroup& group, Defect& defect) const;
};

DefectSampler::DefectSampler(const Part& part,
                             const Bvh& bvh,
                             const std::vector<NamedGroup>& groups,
                             const ImprintSettings& settings,
                             double crease_rad) {
  auto state = std::make_unique<State>(State{.part = part, .bvh = bvh, .total = settings.count});
  const bool has_total = settings.count.max > 0.0;
  std::shared_ptr<const AreaSampler> whole;
  bool needs_edges = false;
  double shares = 0.0;
  for (const auto& [name, group] : groups) {
    const std::string table = "defects." + name;
    check_sizes(table, group, part.box_in_part_mm.size_mm().norm());
    const bool is_fixed = group.count.max <= 0.0 && (!has_total || has_given_places(group));
    GroupPlaces places = {.name = name, .group = group, .is_fixed = is_fixed};
    if (is_fixed) {
      places.places = fixed_places(part, bvh, table, group);
    } else {
      whole = whole ? whole : std::make_shared<const AreaSampler>(part.mesh);
      places.region.emplace(part, table, group.region, whole);
      needs_edges = needs_edges || group.edge_distance_mm > 0.0;
      shares += group.share;
    }
    state->has_distances = state->has_distances || group.min_distance_mm > 0.0;
    state->share_sums.push_back(shares);
    state->groups.push_back(std::move(places));
  }
  if (has_total && !groups.empty() && shares <= 0.0) {
    throw ConfigError("imprint.count", "no group has a share, all of them list their places");
  }
  if (needs_edges) {
    state->edges = SharpEdges(part.mesh, crease_rad);
  }
  state_ = std::move(state);
}

DefectSampler::~DefectSampler() = default;
DefectSampler::DefectSampler(DefectSampler&&) noexcept = default;
DefectSampler& DefectSampler::operator=(DefectSampler&&) noexcept = default;

std::vector<int> DefectSampler::State::counts(std::uint64_t seed) const {
  const bool has_total = total.max > 0.0;
  std::vector<int> counts;
  for (const GroupPlaces& places : groups) {
    const std::uint64_t hash = mixed(start_of(seed, Purpose::kCount), places.name);
    counts.push_back(places.is_fixed ? static_cast<int>(places.places.size())
                     : has_total     ? 0
                                     : whole_number(places.group.count, hash));
  }
  if (!has_total || groups.empty()) {
    return counts;
  }
  const int wanted = whole_number(total, start_of(seed, Purpose::kTotal));
  for (int i = 0; i < wanted; ++i) {
    Rng rng(start_of(seed, Purpose::kShares), Stream::kDefects, static_cast<std::uint64_t>(i));
    auto chosen = std::ranges::upper_bound(share_sums, rng.uniform() * share_sums.back());
    if (chosen == share_sums.end()) {  // the product was rounded up
      chosen = std::ranges::lower_bound(share_sums, share_sums.back());
    }
    ++counts[static_cast<std::size_t>(chosen - share_sums.begin())];
  }
  return counts;
}

std::vector<DefectSlot> DefectSampler::slots(std::uint64_t seed) const {
  std::vector<DefectSlot> slots;
  const std::vector<int> counts = state_->counts(seed);
  for (std::size_t group = 0; group < counts.size(); ++group) {
    for (int number = 0; number < counts[group]; ++number) {
      slots.push_back(
          {.group = group, .number = number, .id = static_cast<std::int32_t>(slots.size()) + 1});
    }
  }
  return slots;
}

std::optional<SurfacePoint> DefectSampler::State::choose_place(const GroupPlaces& places,
                                                               Defect& defect,
                                                               std::uint64_t hash) const {
  if (places.is_fixed) {
    const FixedPlace& fixed = places.places[static_cast<std::size_t>(defect.number)];
    defect.off_surface_mm = fixed.off_mm;
    return fixed.point;
  }
  Rng rng(hash, Stream::kDefects, static_cast<std::uint64_t>(Use::kPlace));
  return places.region->draw(part, rng);
}

/// Rules that hold for random places only.
std::string DefectSampler::State::refusal(const GroupPlaces& places,
                                          const Defect& defect,
                                          std::span<const Defect> taken) const {
  const DefectGroup& own = places.group;
  if (own.edge_distance_mm > 0.0 && edges.is_near(defect.place.centre_mm, own.edge_distance_mm)) {
    return fmt::format("nearer than {:g} mm to a sharp edge", own.edge_distance_mm);
  }
  for (const Defect& other : has_distances ? taken : std::span<const Defect>()) {
    const auto its = std::ranges::find(groups, other.group, &GroupPlaces::name);
    const double apart_mm = its == groups.end()
                                ? own.min_distance_mm
                                : std::max(own.min_distance_mm, its->group.min_distance_mm);
    if (apart_mm > 0.0 && rim_distance(defect, other) < apart_mm) {
      return fmt::format("nearer than {:g} mm to another defect", apart_mm);
    }
  }
  return "";
}

/// Makes a defect shallower where the wall asks for it; a reason when it cannot be.
std::string DefectSampler::State::fit_to_wall(const DefectGroup& group, Defect& defect) const {
  constexpr double kNoWall_mm = 1e-3;
  defect.wall_mm = wall_below(part, bvh, defect);
  const double allowed_mm = group.wall_share * defect.wall_mm;
  if (!goes_inwards(defect.type) || defect.depth_mm <= allowed_mm) {
    return "";
  }
  if (group.when_thin == DefectGroup::Thin::kRefuse || defect.wall_mm < kNoWall_mm) {
    return "the wall is too thin for the depth";
  }
  defect.depth_mm = allowed_mm;
  return "";
}

namespace {

void draw_sizes(const DefectGroup& group, std::uint64_t hash, Defect& defect) {
  if (is_line(group.type)) {
    defect.length_mm = group.length_mm.at(uniform(hash, Use::kLength));
    defect.width_mm = group.width_mm.at(uniform(hash, Use::kWidth));
  } else {
    defect.diameter_mm = group.diameter_mm.at(uniform(hash, Use::kDiameter));
  }
}

/// The numbers that depend on nothing but the defect's own hash.
Defect drawn_numbers(const GroupPlaces& places,
                     const DefectSlot& slot,
                     int attempt,
                     std::uint64_t hash) {
  const DefectGroup& group = places.group;
  Defect defect;
  defect.label = fmt::format("{}_{}", places.name, slot.number + 1);
  defect.group = places.name;
  defect.id = slot.id;
  defect.number = slot.number;
  defect.attempt = attempt;
  defect.seed = mixed(hash, static_cast<std::uint64_t>(Purpose::kTool));
  defect.type = group.type;
  defect.realisation = group.realisation;
  defect.wanted_depth_mm = group.height_mm.at(uniform(hash, Use::kDepth));
  defect.depth_mm = defect.wanted_depth_mm;
  draw_sizes(group, hash, defect);
  defect.angle_rad = group.angle_rad.at(uniform(hash, Use::kAngle));
  defect.tilt_rad = group.tilt_rad.at(uniform(hash, Use::kTilt));
  defect.tilt_direction_rad = 2.0 * kPi * uniform(hash, Use::kTiltDirection);
  defect.tool = type_name(group.type);
  return defect;
}

}  // namespace

DefectSampler::Draw DefectSampler::draw(std::uint64_t seed,
                                        const DefectSlot& slot,
                                        int attempt,
                                        std::span<const Defect> taken) const {
  GLINT_CHECK(slot.group < state_->groups.size() && attempt >= 0, "no such slot");
  const GroupPlaces& places = state_->groups[slot.group];
  const std::uint64_t group_hash = mixed(start_of(seed, Purpose::kNumbers), places.name);
  const std::uint64_t hash = mixed(mixed(group_hash, static_cast<std::uint64_t>(slot.number)),
                                   static_cast<std::uint64_t>(attempt));
  Defect defect = drawn_numbers(places, slot, attempt, hash);
  const std::optional<SurfacePoint> point = state_->choose_place(places, defect, hash);
  if (!point) {
    return {.reason = "no place was found in the region", .refused = std::move(defect)};
  }
  const Vector3d normal = footprint_normal(state_->part, state_->bvh, *point, defect.radius_mm());
  defect.place = oriented_place(state_->part, point->point_mm, normal, defect.angle_rad);
  defect.triangle = point->triangle;
  std::string reason = places.is_fixed ? "" : state_->refusal(places, defect, taken);
  if (reason.empty()) {
    reason = state_->fit_to_wall(places.group, defect);
  }
  if (!reason.empty()) {
    return {.reason = std::move(reason), .refused = std::move(defect)};
  }
  return {.defect = std::move(defect)};
}

}  // namespace glint
