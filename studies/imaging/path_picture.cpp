// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/config/key_digest.h"
#include "core/error.h"
#include "simulator/render/path_tracing/sobol.h"
#include "simulator/render/path_tracing/tile_sums.h"
#include "studies/definition/render_methods.h"
#include "studies/imaging/direct/hidden_lights.h"

namespace glint {
namespace {

ThinLens thin_lens_of(const SceneSettings& scene) {
  const LensGeometry geometry = lens_geometry(scene.camera, scene.lens);
  return {.aperture_mm = geometry.aperture_mm, .focus_mm = geometry.focus_mm};
}

/// The seed of an independent picture; the first one's is the scene's own.
int batch_seed(int seed, int batch) {
  constexpr std::uint32_t kPositive = 0x7fffffffU;
  const std::uint32_t scattered = hash_bits(static_cast<std::uint32_t>(batch)) & kPositive;
  return batch == 0 ? seed : static_cast<int>(static_cast<std::uint32_t>(seed) ^ scattered);
}

template <class T>
void add(Image<T>& to, const Image<T>& image) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    to.values()[i] = static_cast<T>(to.values()[i] + image.values()[i]);
  }
}

void add_groups(std::vector<GroupSums>& to, const std::vector<GroupSums>& groups) {
  for (std::size_t g = 0; g < to.size(); ++g) {
    for (std::size_t c = 0; c < to[g].channels.size(); ++c) {
      add(to[g].channels[c], groups[g].channels[c]);
    }
  }
}

/// What was seen first stays.
void add_first(Image<std::int32_t>& to, const Image<std::int32_t>& image) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    std::int32_t& value = to.values()[i];
    value = value < 0 ? image.values()[i] : value;
  }
}

void add(Film& to, const Film& sums) {
  add(to.samples, sums.samples);
  add_groups(to.groups, sums.groups);
  add(to.part, sums.part);
  for (std::size_t i = 0; i < to.defects.size(); ++i) {
    add(to.defects[i].samples, sums.defects[i].samples);
  }
  for (const auto image : {&Film::squares,
                           &Film::depth_mm,
                           &Film::normal_x,
                           &Film::normal_y,
                           &Film::normal_z,
                           &Film::x_mm,
                           &Film::y_mm,
                           &Film::z_mm,
                           &Film::tilt}) {
    add(to.*image, sums.*image);
  }
  add_first(to.triangle, sums.triangle);
  add_first(to.defect, sums.defect);
  to.counts += sums.counts;
}

/// Counts the batches as further passes of one picture.
class BatchPreview {
 public:
  BatchPreview(const PathPreview& preview, int batches)
      : preview_(preview), batches_left_(batches) {}

  /// Of the next batch.
  PathPreview next(const Film* done, int samples) {
    --batches_left_;
    done_ = done;
    done_samples_ = samples;
    if (!preview_) {
      return {};
    }
    return [this](const PathProgress& progress) { return show(progress); };
  }

  bool is_stopped() const { return is_stopped_; }

 private:
  bool show(const PathProgress& progress) {
    ++passes_;
    if (passes_ == 1) {
      tiles_ = static_cast<std::int64_t>(
          tiles_of(progress.sums->width_px, progress.sums->height_px).size());
    }
    PathProgress whole = progress;
    Film together;
    whole.pass = passes_;
    whole.samples += done_samples_;
    whole.tiles_left += batches_left_ > 0 ? tiles_ : 0;
    if (done_ != nullptr) {
      together = *done_;
      add(together, *progress.sums);
      whole.sums = &together;
    }
    is_stopped_ = !preview_(whole);
    return !is_stopped_;
  }

  const PathPreview& preview_;
  int batches_left_ = 0;
  const Film* done_ = nullptr;
  int done_samples_ = 0;
  int passes_ = 0;
  std::int64_t tiles_ = 0;
  bool is_stopped_ = false;
};

std::int64_t bytes_of(const std::vector<GroupSums>& groups) {
  std::int64_t floats = 0;
  for (const GroupSums& group : groups) {
    for (const ImageF& channel : group.channels) {
      floats += static_cast<std::int64_t>(channel.size());
    }
  }
  return floats * static_cast<std::int64_t>(sizeof(float));
}

/// A factor for each picture of a frame; those that are dark are left out.
struct WeightedSum {
  const float* values = nullptr;
  const float* left_out = nullptr;  ///< of the batch without; nullptr: none
  float factor = 0.0F;
};

void add_weighted(const WeightedSum& sum, std::size_t begin, std::size_t end, float* to) {
  const float* values = sum.values + begin;
  const std::size_t count = end - begin;
  if (sum.left_out == nullptr) {
    for (std::size_t i = 0; i < count; ++i) {
      to[i] += sum.factor * values[i];
    }
    return;
  }
  const float* left_out = sum.left_out + begin;
  for (std::size_t i = 0; i < count; ++i) {
    to[i] += sum.factor * (values[i] - left_out[i]);
  }
}

/// Sum of the pictures over the samples of each pixel. What rounding leaves below 0 is 0.
ImageF mean_image(const Image<std::int32_t>& samples,
                  const Image<std::int32_t>* left_out,
                  const std::vector<WeightedSum>& sums,
                  const Spans& where) {
  constexpr std::size_t kBlock = 4096;  // of floats that stay in the fast memory
  ImageF image(samples.width(), samples.height());
  const auto fill = [&](std::size_t begin, std::size_t end) {
    for (const WeightedSum& sum : sums) {
      add_weighted(sum, begin, end, image.values().data() + begin);
    }
    for (std::size_t i = begin; i < end; ++i) {
      const std::int32_t n =
          samples.values()[i] - (left_out == nullptr ? 0 : left_out->values()[i]);
      float& value = image.values()[i];
      value = n > 0 ? std::max(0.0F, value / static_cast<float>(n)) : 0.0F;
    }
  };
  for (std::size_t begin = 0; where.empty() && begin < image.size(); begin += kBlock) {
    fill(begin, std::min(image.size(), begin + kBlock));
  }
  for (const RowSpan& span : where) {
    const auto row = static_cast<std::size_t>(image.row(span.y) - image.row(0));
    fill(row + static_cast<std::size_t>(span.begin), row + static_cast<std::size_t>(span.end));
  }
  return image;
}

/// The pictures of a frame, without those that are dark in it.
std::vector<WeightedSum> sums_of(const PathPicture& picture,
                                 const FrameFactors& factors,
                                 const PathBatch* left_out) {
  std::vector<WeightedSum> sums;
  for (std::size_t g = 0; g < picture.sums.groups.size(); ++g) {
    const std::vector<ImageF>& channels = picture.sums.groups[g].channels;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const double factor =
          factors.at(g)[static_cast<Eigen::Index>(c)] / static_cast<double>(channels.size());
      if (factor != 0.0) {
        const float* of_batch =
            left_out == nullptr ? nullptr : left_out->groups[g].channels[c].values().data();
        sums.push_back({.values = channels[c].values().data(),
                        .left_out = of_batch,
                        .factor = static_cast<float>(factor)});
      }
    }
  }
  return sums;
}

/// What the accuracy of a sum of direct light follows from. Where lights stand changes no power.
int brightness_octave_of(const SceneSettings& scene) {
  const UnitPowerLights lights = unit_power_lights(scene, {}, load_light_mesh);
  return brightness_octave(scene.sensor, frame_factors(scene, lights.unit_power_w));
}

const PathBatch* batch_of(const PathPicture& picture, std::optional<std::size_t> without) {
  return without ? &picture.batches.at(*without) : nullptr;
}

}  // namespace

struct PathView::Data {
  Data(const SceneSettings& scene,
       std::shared_ptr<const BuiltDefects> the_part,
       const Viewpoint& viewpoint,
       bool has_defects)
      : part(std::move(the_part)),
        built(has_defects ? part->built : part->clean),
        material(scene.material, scene.sensor.wavelengths_nm),
        camera_pose(camera_from_world(viewpoint)),
        lights(unit_power_lights(scene,
                                 {.scene_from_camera = inverse(camera_pose),
                                  .scene_from_part = built->part.scene_from_part},
                                 load_light_mesh)),
        camera(intrinsics_of(scene)),
        physical{.part = built->part,
                 .bvh = *built->bvh,
                 .detail = has_defects ? part->detail : no_detail,
                 .material = material,
                 .lights = lights.lights,
                 .camera = camera,
                 .camera_from_world = camera_pose,
                 .lens = thin_lens_of(scene)} {
    // Without an own mesh the defects are in the normals alone.
    if (built != part->clean) {
      physical.face_labels = part->made.labels;
    }
    is_in_tunnel = scene.has_tunnel;
    frames = frame_factors(scene, lights.unit_power_w);
    if (is_direct(scene)) {
      if (scene.paths.has_light) {
        check_lights_unhidden(physical);
      }
      direct = direct_settings(scene.render, brightness_octave_of(scene));
    }
  }

  std::shared_ptr<const BuiltDefects> part;
  std::shared_ptr<const BuiltPart> built;
  SurfaceDetail no_detail;
  SurfaceMaterial material;
  RigidTransform camera_pose;
  UnitPowerLights lights;
  PinholeCamera camera;
  PhysicalScene physical;
  bool is_in_tunnel = false;
  std::vector<FrameFactors> frames;
  std::optional<DirectSettings> direct;
};

PathView::PathView(const SceneSettings& scene,
                   std::shared_ptr<const BuiltDefects> part,
                   const Viewpoint& viewpoint,
                   bool has_defects)
    : data_(std::make_unique<Data>(scene, std::move(part), viewpoint, has_defects)) {}

PathView::~PathView() = default;

const PhysicalScene& PathView::physical() const {
  return data_->physical;
}

const PhysicalScene* PathView::area_lights() const {
  return data_->is_in_tunnel ? nullptr : &data_->physical;
}

const std::vector<FrameFactors>& PathView::frames() const {
  return data_->frames;
}

const std::vector<Colour>& PathView::unit_power_w() const {
  return data_->lights.unit_power_w;
}

const std::optional<DirectSettings>& PathView::direct() const {
  return data_->direct;
}

std::vector<std::string> PathView::group_names() const {
  std::vector<std::string> names;
  for (const LightGroup& group : data_->lights.lights.groups) {
    names.push_back(group.name);
  }
  return names;
}

std::unique_ptr<const PathView> path_view_of(const SceneSettings& scene,
                                             std::shared_ptr<const BuiltDefects> part) {
  return needs_paths(scene)
             ? std::make_unique<const PathView>(scene, std::move(part), scene.viewpoint())
             : nullptr;
}

std::int64_t PathPicture::bytes() const {
  constexpr std::int64_t kPerPixel = 60;
  constexpr std::int64_t kSamples = sizeof(std::int32_t);
  constexpr std::int64_t kDefect = sizeof(std::uint16_t);
  const auto pixels = static_cast<std::int64_t>(sums.samples.size());
  std::int64_t all =
      pixels * (kPerPixel + kDefect * static_cast<std::int64_t>(sums.defects.size()));
  all += bytes_of(sums.groups);
  for (const PathBatch& batch : batches) {
    all += kSamples * pixels + bytes_of(batch.groups);
  }
  return all;
}

std::string picture_key(const SceneSettings& wanted, const Viewpoint& viewpoint) {
  SceneSettings scene = wanted;
  std::string key;
  KeyDigest digest(key);
  visit_keys(digest, scene.part);
  visit_keys(digest, scene.material);
  visit_keys(digest, scene.camera);
  visit_keys(digest, scene.lens);
  Viewpoint at = viewpoint;
  visit_keys(digest, at);
  visit_keys(digest, scene.viewpoint());  // may decide how defects are realised
  digest.numbers("wavelengths_nm", scene.sensor.wavelengths_nm, {}, {}, "");
  visit_keys(digest, scene.paths);
  for (NamedLight& light : without_powers(scene.lights)) {
    digest.text("name", light.name, "");
    std::string type(light_type(light.settings));
    digest.text("type", type, "");
    visit_keys(digest, light.settings);
  }
  if (is_direct(scene)) {
    std::string method = "direct";
    int octave = brightness_octave_of(wanted);
    digest.text("method", method, "");
    digest.integer("rays_per_axis", scene.render.rays_per_axis, {}, "");
    digest.integer("octave", octave, {}, "");
  }
  digest.boolean("has_tunnel", scene.has_tunnel, "");
  if (scene.has_tunnel) {
    digest.text("tunnel", scene.tunnel_name, "");
    TunnelSettings tunnel = without_powers(scene.tunnel);
    visit_keys(digest, tunnel);
    visit_keys(digest, scene.scan);
  }
  for (auto& [name, group] : scene.defects) {
    digest.text("name", name, "");
    visit_keys(digest, group);
  }
  visit_keys(digest, scene.imprint);
  return key;
}

PathSettings path_settings(const SceneSettings& scene) {
  PathSettings paths = scene.paths;
  paths.channels = static_cast<int>(scene.sensor.wavelengths_nm.size());
  return paths;
}

PathPicture render_view(const PathView& view,
                        const PathSettings& paths,
                        ThreadPool& pool,
                        std::span<const PixelWindow> windows,
                        const PathPreview& preview) {
  const int batches = std::max(1, std::min(paths.batches, paths.samples));
  PathSettings of_batch = paths;
  of_batch.samples = (paths.samples + batches - 1) / batches;
  of_batch.windows.assign(windows.begin(), windows.end());
  // Together they shall have the error that is asked for.
  of_batch.relative_error *= std::sqrt(static_cast<double>(batches));
  PathPicture picture = {.frames = view.frames(), .unit_power_w = view.unit_power_w()};
  if (view.direct()) {
    PathSettings whole = paths;
    whole.windows = of_batch.windows;
    picture.sums = direct_film(view.physical(), whole, *view.direct(), pool, preview);
    picture.has_noise = false;
    return picture;
  }
  BatchPreview shown(preview, batches);
  for (int b = 0; b < batches && !shown.is_stopped(); ++b) {
    of_batch.seed = batch_seed(paths.seed, b);
    Film sums = render_paths(view.physical(),
                             of_batch,
                             pool,
                             shown.next(b == 0 ? nullptr : &picture.sums, b * of_batch.samples));
    if (batches > 1) {
      picture.batches.push_back({.samples = sums.samples, .groups = sums.groups});
    }
    if (b == 0) {
      picture.sums = std::move(sums);
    } else {
      add(picture.sums, sums);
    }
  }
  if (picture.batches.size() < 2) {
    picture.batches.clear();
  }
  return picture;
}

ImageF frame_radiance(const PathPicture& picture,
                      const FrameFactors& factors,
                      std::optional<std::size_t> without,
                      const Spans& where) {
  const PathBatch* left_out = batch_of(picture, without);
  return mean_image(picture.sums.samples,
                    left_out == nullptr ? nullptr : &left_out->samples,
                    sums_of(picture, factors, left_out),
                    where);
}

double pixel_radiance(const PathPicture& picture,
                      const FrameFactors& factors,
                      std::size_t pixel,
                      std::optional<std::size_t> without) {
  const PathBatch* left_out = batch_of(picture, without);
  std::int32_t samples = picture.sums.samples.values()[pixel];
  samples -= left_out == nullptr ? 0 : left_out->samples.values()[pixel];
  double sum = 0.0;
  for (const WeightedSum& group : sums_of(picture, factors, left_out)) {
    const float value =
        group.values[pixel] - (group.left_out == nullptr ? 0.0F : group.left_out[pixel]);
    sum += static_cast<double>(group.factor * value);
  }
  return samples > 0 ? sum / samples : 0.0;
}

ImageF channel_radiance(const Film& sums, const FrameFactors& factors, int channel) {
  std::vector<WeightedSum> weighted;
  for (std::size_t g = 0; g < sums.groups.size(); ++g) {
    weighted.push_back(
        {.values = sums.groups[g].channels.at(static_cast<std::size_t>(channel)).values().data(),
         .factor = static_cast<float>(factors.at(g)[channel])});
  }
  return mean_image(sums.samples, nullptr, weighted, {});
}

}  // namespace glint
