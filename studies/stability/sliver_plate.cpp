// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/sliver_plate.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/units.h"
#include "studies/definition/overrides.h"
#include "studies/output/scratch_folder.h"

namespace glint::stability {
namespace {

constexpr double kTurnDeg = 33.0;
constexpr std::array<double, 4> kRowsAt = {-0.34, -0.11, 0.11, 0.34};  ///< of the plate's width

/// Corners on a grid, for each face of the plate.
class SliverPlate {
 public:
  SliverPlate(const PartSettings& plate, double sliver_mm) : plate_(plate) {
    y_mm_ = {-0.5 * plate.width_mm};
    for (const double at : kRowsAt) {
      y_mm_.push_back(at * plate.width_mm);
      y_mm_.push_back(at * plate.width_mm + sliver_mm);
    }
    y_mm_.push_back(0.5 * plate.width_mm);
  }

  std::string obj() {
    write_corners();
    const std::size_t last = y_mm_.size() - 1;
    for (std::size_t j = 0; j < last; ++j) {
      for (std::size_t i = 0; i < 2; ++i) {
        quad(corner(0, j, i), corner(0, j, i + 1), corner(0, j + 1, i + 1), corner(0, j + 1, i));
        quad(corner(1, j, i), corner(1, j + 1, i), corner(1, j + 1, i + 1), corner(1, j, i + 1));
      }
      quad(corner(0, j, 0), corner(0, j + 1, 0), corner(1, j + 1, 0), corner(1, j, 0));
      quad(corner(1, j, 2), corner(1, j + 1, 2), corner(0, j + 1, 2), corner(0, j, 2));
    }
    for (std::size_t i = 0; i < 2; ++i) {
      quad(corner(1, 0, i), corner(1, 0, i + 1), corner(0, 0, i + 1), corner(0, 0, i));
      quad(corner(0, last, i), corner(0, last, i + 1), corner(1, last, i + 1), corner(1, last, i));
    }
    return text_;
  }

 private:
  /// Counted from 1. @param face  0: above, 1: below
  std::size_t corner(std::size_t face, std::size_t row, std::size_t column) const {
    return (face * y_mm_.size() + row) * 3 + column + 1;
  }

  void write_corners() {
    const double cosine = std::cos(kTurnDeg * kRadPerDeg);
    const double sine = std::sin(kTurnDeg * kRadPerDeg);
    for (const double z_mm : {0.5 * plate_.thickness_mm, -0.5 * plate_.thickness_mm}) {
      for (const double y_mm : y_mm_) {
        for (const double x_mm : {-0.5 * plate_.length_mm, 0.0, 0.5 * plate_.length_mm}) {
          text_ += fmt::format("v {:.17g} {:.17g} {:.17g}\n",
                               x_mm,
                               cosine * y_mm - sine * z_mm,
                               sine * y_mm + cosine * z_mm);
        }
      }
    }
  }

  void quad(std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
    text_ += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, c, a, c, d);
  }

  const PartSettings& plate_;
  std::vector<double> y_mm_;
  std::string text_;
};

PartSettings part_of(const ConfigNode& root) {
  std::vector<Problem> problems;
  PartSettings part = read_scene(root, problems).part;
  if (!problems.empty()) {
    throw ConfigError(problems);
  }
  return part;
}

}  // namespace

std::string sliver_plate_obj(const PartSettings& plate, double sliver_mm) {
  return SliverPlate(plate, sliver_mm).obj();
}

Outcome evaluated_with_slivers(SceneStore& store, const ConfigNode& root, double sliver_mm) {
  const PartSettings plate = part_of(root);
  const ScratchFolder folder("a mesh of a plate");
  const std::filesystem::path file = folder.path() / fmt::format("plate_{}.obj", sliver_mm);
  write_file(file, sliver_plate_obj(plate, sliver_mm));
  ConfigNode meshed = root;
  put_set(meshed,
          "part",
          fmt::format("{{ file = '{}', rotation_deg = [{}, 0, 0] }}", file.string(), -kTurnDeg));
  Outcome outcome = evaluated(store, meshed);
  outcome.scene.part = plate;
  return outcome;
}

}  // namespace glint::stability
