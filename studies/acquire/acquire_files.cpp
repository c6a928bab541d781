// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/acquire_files.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/file.h"
#include "core/image/image_io.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// The bytes of a PNG file.
std::string png_of(const ImageF& picture, PixelDepth depth, const fs::path& folder) {
  const fs::path file = folder / ".picture.png";
  write_png(file, picture, depth);
  std::string bytes = read_file(file);
  std::error_code none;
  fs::remove(file, none);
  return bytes;
}

PixelDepth depth_of(const Frame& frame) {
  return bits_of(frame.format) == 8 ? PixelDepth::k8Bit : PixelDepth::k16Bit;
}

ImageF mean_of(const std::vector<const AcquiredPicture*>& pictures, const fs::path& folder) {
  ImageF mean = read_image(folder / pictures.front()->file);
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    const ImageF next = read_image(folder / pictures[i]->file);
    std::ranges::transform(
        mean.values(), next.values(), mean.values().begin(), [](float a, float b) {
          return a + b;
        });
  }
  const auto count = static_cast<float>(pictures.size());
  std::ranges::transform(
      mean.values(), mean.values().begin(), [count](float sum) { return sum / count; });
  return mean;
}

}  // namespace

AcquireFiles::AcquireFiles(fs::path folder,
                           AcquireJournal& journal,
                           const AcquireWork& work,
                           const Cell& cell)
    : folder_(std::move(folder)),
      journal_(journal),
      work_(work),
      tcp_from_flange_(pose_of_six(robot_of(cell).flange_from_tcp).inverse()),
      sigma_(pose_sigma_of(robot_of(cell).model)),
      gain_db_(camera_of(cell).gain_db) {
  if (cell.stage && cell.stage->kind == CellStage::Kind::kGrbl) {
    way_ = stage_way_of(*cell.stage, work.num_positions, work.steps);
  }
}

std::vector<const AcquiredPicture*> AcquireFiles::accepted_of(const std::string& view) const {
  std::vector<const AcquiredPicture*> found;
  for (const AcquiredPicture& picture : journal_.pictures()) {
    if (picture.is_accepted && picture.view == view) {
      found.push_back(&picture);
    }
  }
  std::ranges::sort(found, {}, [](const AcquiredPicture* picture) { return picture->position; });
  return found;
}

AcquisitionPlan AcquireFiles::open_work() const {
  AcquisitionPlan plan = work_.plan;
  for (ViewTask& task : plan.tasks) {
    for (const AcquiredPicture* picture : accepted_of(task.name)) {
      std::erase(task.positions, picture->position);
      task.sharpest = std::max(task.sharpest, picture->sharpness);
    }
  }
  return plan;
}

AcquiredPicture AcquireFiles::described(const TakenPicture& picture) const {
  const ViewTask& task = work_.plan.tasks.at(picture.task);
  const std::string name = folder_name_of(task.name);
  const std::string rejected = fmt::format("rejected/{}/frame_{:03}_try_", name, picture.position);
  const std::string file =
      picture.is_accepted ? fmt::format("views/{}/sequence/frame_{:03}.png", name, picture.position)
                          : fmt::format("{}{}.png", rejected, journal_.next_try(rejected));
  AcquiredPicture described = {.view = task.name,
                               .position = picture.position,
                               .lights = task.lights,
                               .file = file,
                               .is_accepted = picture.is_accepted,
                               .reason = picture.reason,
                               .base_from_flange = picture.pose.base_from_tcp * tcp_from_flange_,
                               .joints_rad = picture.pose.joints_rad,
                               .position_sigma_mm = sigma_.position_mm,
                               .rotation_sigma_rad = sigma_.rotation_rad,
                               .exposure_us = picture.frame.exposure_us,
                               .gain_db = gain_db_,
                               .frame_id = picture.frame.frame_id,
                               .camera_time_ns = picture.frame.camera_time_ns,
                               .sharpness = picture.figures.sharpness};
  described.host_time_s =
      std::chrono::duration<double>(picture.frame.host_time.time_since_epoch()).count();
  if (way_) {
    described.stage_mm = way_->at_mm(picture.position);
  }
  return described;
}

std::filesystem::path AcquireFiles::mean_file(const ViewTask& task) const {
  return folder_ / "views" / folder_name_of(task.name) / "aspect.png";
}

void AcquireFiles::keep(const TakenPicture& picture) {
  if (picture.is_accepted) {  // in the place of one that was lost: the mean is another one, too
    std::error_code none;
    fs::remove(mean_file(work_.plan.tasks.at(picture.task)), none);
  }
  journal_.keep(described(picture),
                png_of(linear_values(picture.frame), depth_of(picture.frame), folder_));
}

void AcquireFiles::write_means() {
  for (const ViewTask& task : work_.plan.tasks) {
    const auto pictures = accepted_of(task.name);
    const fs::path file = mean_file(task);
    // After a power cut a file of an earlier program may have its name and no bytes.
    const bool is_written = fs::exists(file) && fs::file_size(file) > 0;
    if (pictures.size() != task.positions.size() || pictures.empty() || is_written) {
      continue;
    }
    write_file_durably(file,
                       pictures.size() == 1
                           ? read_file(folder_ / pictures.front()->file)
                           : png_of(mean_of(pictures, folder_), PixelDepth::k16Bit, folder_));
  }
}

int AcquireFiles::num_accepted() const {
  return static_cast<int>(
      std::ranges::count_if(journal_.pictures(), &AcquiredPicture::is_accepted));
}

int AcquireFiles::num_wanted() const {
  std::size_t count = 0;
  for (const ViewTask& task : work_.plan.tasks) {
    count += task.positions.size();
  }
  return static_cast<int>(count);
}

std::vector<AcquiredPicture> AcquireFiles::sorted_pictures() const {
  std::vector<AcquiredPicture> pictures = journal_.pictures();
  const auto number_of = [this](const AcquiredPicture& picture) {
    return std::ranges::find(work_.plan.tasks, picture.view, &ViewTask::name) -
           work_.plan.tasks.begin();
  };
  std::ranges::stable_sort(pictures, [&](const AcquiredPicture& a, const AcquiredPicture& b) {
    return std::pair(number_of(a), a.position) < std::pair(number_of(b), b.position);
  });
  return pictures;
}

Json AcquireFiles::write(Json head) const {
  Json pictures = Json::array();
  std::string poses = "# base_from_flange: mm and rotation vector in rad\n";
  poses += csv_row_of("name", "x_mm", "y_mm", "z_mm", "rx_rad", "ry_rad", "rz_rad");
  for (const AcquiredPicture& picture : sorted_pictures()) {
    Json json = picture_json(picture);
    if (picture.is_accepted) {
      const auto six = json["base_from_flange"].get<std::vector<double>>();
      poses += csv_row_of(picture.file, six[0], six[1], six[2], six[3], six[4], six[5]);
    }
    pictures.push_back(std::move(json));
  }
  head["pictures"] = std::move(pictures);
  write_file_durably(folder_ / "poses.csv", poses);
  write_file_durably(folder_ / "acquired.json", head.dump(2) + "\n");
  return head;
}

}  // namespace glint
