// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: glint_corner_bank STUDY BANK PICTURES
//
// Renders boards as a study with [calibration_trial] takes them, looks for their corners and keeps
// how far each is from its true place, until the file BANK (corner_bank_file.h) has PICTURES
// pictures; what it has is not rendered again. Every other picture is taken at half the f-number:
// the study's sensor has pixels twice as large as the simulated calibrations have, and so its discs
// of confusion come to the same numbers of pixels, from those at the study's f-number to twice as
// wide ones. Prints the bank's table. Exit code 0; 2 for what cannot be read or belongs to other
// pictures.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/file.h"
#include "core/image/image_io.h"
#include "core/progress.h"
#include "core/text.h"
#include "core/thread_pool.h"
#include "core/units.h"
#include "hardware/board/find_board.h"
#include "simulator/camera/lens_settings.h"
#include "studies/calibration_trial/trial_renderer.h"
#include "studies/definition/study_text.h"
#include "tests/hardware/calibration/corner_bank_file.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

/// @throws ConfigError where the study tries no calibration out
Study trial_study(const fs::path& file, const std::vector<KeyValue>& sets) {
  Study study = load_study(file, sets);
  if (!study.calibration_trial) {
    throw ConfigError(Problem{.place = {.file = file.string()},
                              .key = "calibration_trial",
                              .text = "is missing, the table of a calibration that is tried out"});
  }
  if (!(study.scene.lens.f_number > 0.0)) {
    throw ConfigError(Problem{.place = {.file = file.string()},
                              .key = "lens.f_number",
                              .text = "is 0, must be above 0: a lens without blur says nothing"});
  }
  return study;
}

/// One aperture of the study, and how it blurs.
struct BankView {
  BankView(const fs::path& study_file, const std::vector<KeyValue>& sets, const fs::path& ink_file)
      : study(trial_study(study_file, sets)), renderer(study, ink_file, hardware_threads()) {
    const LensGeometry lens = lens_geometry(study.scene.camera, study.scene.lens);
    blur = {.aperture_mm = lens.aperture_mm,
            .focus_mm = lens.focus_mm,
            .image_distance_mm = lens.image_distance_mm,
            .pixel_mm = study.scene.camera.pixel_mm,
            .sensor_px = study.scene.sensor.blur_px};
  }

  Study study;
  TrialRenderer renderer;
  CornerBlur blur;
};

/// What all pictures share: in one line, and all of it as a hash, wherever the files lie.
BankHeader header_of(const BankView& first, const BankView& second) {
  const SceneSettings& scene = first.study.scene;
  const Board& board = first.renderer.board();
  return {.seed = static_cast<std::uint64_t>(first.study.calibration_trial->seed),
          .scene = fmt::format(
              "{} x {} px of {} mm, {} x {} corners of {} mm, f/{} and f/{} focused at {} mm, blur "
              "{} px, full well {} e, read noise {} e, {} bits, {} samples",
              scene.camera.width_px,
              scene.camera.height_px,
              scene.camera.pixel_mm,
              board.cols,
              board.rows,
              board.square_mm,
              scene.lens.f_number,
              second.study.scene.lens.f_number,
              scene.lens.focus_mm,
              scene.sensor.blur_px,
              scene.sensor.full_well_e,
              scene.sensor.read_noise_e,
              scene.sensor.bits,
              scene.paths.samples),
          .inputs = sha256_hex(shown_text(first.study) + board_toml(board))};
}

/// The board's corners as they were found beside where they are.
BankPicture bank_picture(const BankView& view, const BoardView& found, const RigidTransform& pose) {
  const CameraOnRobot& truth = view.renderer.truth();
  const PinholeCamera camera(truth.intrinsics);
  const RigidTransform seen = camera_from_board(truth, pose);
  const Board& board = view.renderer.board();
  const auto pixel = [&](const Eigen::Vector3d& corner) {
    return camera.project(seen * corner).value();
  };
  const int row = board.rows / 2;
  BankPicture picture{
      .outcome = outcome_name(found.outcome),
      .f_number = view.study.scene.lens.f_number,
      .tilt_deg = std::acos(std::min(1.0, std::abs(seen.rotation(2, 2)))) * kDegPerRad,
      .turn_deg = turn_on_pixels_deg(pixel(corner_mm(board, 0, row)),
                                     pixel(corner_mm(board, board.cols - 1, row)))};
  if (!found.is_accepted()) {
    return picture;
  }
  if (!found.is_orientation_known && num_symmetries(board) > 1) {
    picture.outcome = "turned";  // perhaps: which corner is the first one is not to be seen
    return picture;
  }
  const Eigen::Vector2d middle(0.5 * truth.intrinsics.width_px, 0.5 * truth.intrinsics.height_px);
  for (std::size_t i = 0; i < found.board_mm.size(); ++i) {
    const Eigen::Vector2d at = pixel(found.board_mm[i]);
    const double depth = (seen * found.board_mm[i]).z();
    picture.corners.push_back({.error_px = found.picture_px[i] - at,
                               .blur_px = view.blur.sigma_px(depth),
                               .distance_mm = depth,
                               .radius_px = (at - middle).norm()});
  }
  return picture;
}

/// A picture goes through a file, as those of a trial do.
BankPicture rendered_picture(BankView& view, int index, const fs::path& file) {
  const TrialPose pose = view.renderer.pose(static_cast<std::uint64_t>(index));
  write_png(file, view.renderer.render(pose.real, index).value(), PixelDepth::k8Bit);
  return bank_picture(
      view, find_board(read_picture(file).pixels, view.renderer.board()), pose.real);
}

void print_bank(const std::vector<BankPicture>& pictures) {
  const auto accepted = std::ranges::count_if(pictures, &BankPicture::is_accepted);
  fmt::print("{} pictures, {} accepted\n", pictures.size(), accepted);
  const CornerBank bank(pictures);
  fmt::print("{}shared by the corners of a picture: {:.4f} px\n", bank.table(), bank.shared_px());
}

void make_bank(const fs::path& study_file, const fs::path& bank_file, int pictures) {
  const fs::path work = bank_file.string() + ".work";
  const fs::path ink_file = work / "ink.png";
  BankView first(study_file, {}, ink_file);
  const double f_number = first.study.scene.lens.f_number;
  BankView second(study_file, {{"lens.f_number", fmt::format("{}", 0.5 * f_number)}}, ink_file);
  CornerBankFile bank(bank_file, header_of(first, second));
  make_folder(work);
  first.renderer.write_ink();
  Progress bar("corner bank", pictures, Progress::Style::kAuto);
  while (std::ssize(bank.pictures()) < pictures) {
    const int index = static_cast<int>(bank.pictures().size());
    bank.append(rendered_picture(index % 2 == 0 ? first : second, index, work / "picture.png"));
    bar.update(index + 1, fmt::format("picture {} of {}", index + 1, pictures));
  }
  std::error_code ignored;
  fs::remove_all(work, ignored);
  print_bank(bank.pictures());
}

int run(const std::vector<std::string>& arguments) {
  int pictures = 0;
  const auto is_count = [&](const std::string& text) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), pictures);
    return error == std::errc() && end == text.data() + text.size() && pictures >= 1 &&
           pictures <= 100'000;
  };
  if (arguments.size() != 3 || !is_count(arguments[2])) {
    fmt::print(stderr, "usage: glint_corner_bank STUDY BANK PICTURES (1 to 100000)\n");
    return 2;
  }
  try {
    make_bank(arguments[0], arguments[1], pictures);
    return 0;
  } catch (const Error& error) {
    fmt::print(stderr, "glint_corner_bank: {}\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace glint

int main(int count, char** arguments) {
  return glint::run({arguments + 1, arguments + count});
}
