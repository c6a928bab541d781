// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/both_scores.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "metrics/aspect_image/defect_scores.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace {

/// A photograph in the place of a simulated picture.
class RealPicture : public ScenePicture {
 public:
  RealPicture(const ScenePicture& simulated, const ImageF& simulated_grey, const ImageF& real)
      : ScenePicture(simulated.scene(), simulated.traced()), simulated_(simulated), real_(real) {
    for (const DefectPixels& defect : traced()->defects) {
      const double there = mean_of(simulated_grey, defect.ring);
      ratios_.push_back(there > 0.0 ? mean_of(real, defect.ring) / there : 1.0);
    }
  }

  bool has_whole_frames(bool /*is_consumed*/, bool /*wants_fringes*/) const override {
    return true;
  }

  MeanImage mean(const MeanRequest& request) const override {
    if (request.watch) {
      request.watch(0, real_);
    }
    MeanImage mean = {.aspect = real_, .frames = 1};
    mean.clipped_frames = Image<std::uint16_t>(real_.width(), real_.height());
    std::ranges::transform(real_.values(), mean.clipped_frames.values().begin(), [](float grey) {
      return static_cast<std::uint16_t>(grey >= 1.0F ? 1 : 0);
    });
    mean.form.frame_pixels = static_cast<int>(real_.size());
    return mean;
  }

  DefectValues flawless(int /*frame*/, std::optional<std::size_t> without) const override {
    DefectValues values = simulated_.flawless(0, without);
    for (std::size_t i = 0; i < values.size() && i < ratios_.size(); ++i) {
      for (float& value : values[i]) {
        value = static_cast<float>(static_cast<double>(value) * ratios_[i]);
      }
    }
    return values;
  }

 private:
  const ScenePicture& simulated_;
  const ImageF& real_;
  std::vector<double> ratios_;
};

}  // namespace

BothScores scores_of_both(SceneStore& store,
                          const SceneSettings& scene,
                          const ImageF& real,
                          WantedScores wanted) {
  wanted.trials.clear();
  wanted.coverage = false;
  wanted.reference = false;
  wanted.picture = true;
  const auto picture = picture_of(store, scene, {.has_flawless = wanted.defects});
  BothScores scores;
  Evaluation simulated = evaluate(*picture, store.pool(), {}, wanted);
  scores.simulated = std::move(simulated.scores);
  wanted.errors = false;
  const RealPicture photograph(*picture, simulated.aspect, real);
  scores.real = evaluate(photograph, store.pool(), {}, wanted).scores;
  return scores;
}

}  // namespace glint
