// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/board_target.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "hardware/board/board_sheet.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kThickness_mm = 2.0;

/// The first point of the picture whose middle lies at or beyond a place along one side.
int first_point(double mm, double texel_mm) {
  return std::max(0, static_cast<int>(std::ceil(mm / texel_mm - 0.5)));
}

/// Where the ink of the board's first corner begins: on the border of a point, up to half a point
/// from where the sheet has it. All corners are off by the same, as squares have whole points.
Vector2d painted_corner_mm(const BoardSheet& sheet, double texel_mm) {
  return texel_mm * Vector2d(first_point(sheet.first_corner_mm.x(), texel_mm),
                             first_point(sheet.first_corner_mm.y(), texel_mm));
}

/// Sets the points of a rectangle whose middles a test accepts.
template <class Test>
void paint(ImageF& image,
           double texel_mm,
           const Vector2d& from_mm,
           const Vector2d& to_mm,
           float value,
           const Test& holds) {
  const auto first = [&](double mm) { return first_point(mm, texel_mm); };
  const int last_x = std::min(image.width(), first(to_mm.x()));
  const int last_y = std::min(image.height(), first(to_mm.y()));
  for (int y = first(from_mm.y()); y < last_y; ++y) {
    for (int x = first(from_mm.x()); x < last_x; ++x) {
      if (holds(texel_mm * Vector2d(x + 0.5, y + 0.5))) {
        image(x, y) = value;
      }
    }
  }
}

}  // namespace

ImageF ink_picture(const Board& board, double ink) {
  const BoardSheet sheet = board_sheet(board);
  const double texel_mm = board.square_mm / kTexelsPerSquare;
  const Vector2d size = sheet.size_mm / texel_mm;
  ImageF image(static_cast<int>(std::lround(size.x())), static_cast<int>(std::lround(size.y())));
  std::ranges::fill(image.values(), 1.0F);
  for (const SheetRectangle& dark : sheet.dark) {
    paint(image,
          texel_mm,
          dark.corner_mm,
          dark.corner_mm + dark.size_mm,
          static_cast<float>(ink),
          [](const Vector2d&) { return true; });
  }
  const Vector2d reach = Vector2d::Constant(sheet.dot_radius_mm);
  for (const Vector2d& dot : sheet.dots_mm) {
    paint(image, texel_mm, dot - reach, dot + reach, 1.0F, [&](const Vector2d& at) {
      return (at - dot).norm() <= sheet.dot_radius_mm;
    });
  }
  return image;
}

BoardTarget board_target(const Board& board, const std::filesystem::path& ink_file, double paper) {
  const BoardSheet sheet = board_sheet(board);
  // The picture has whole points: the plate is as large as the picture.
  const double texel_mm = board.square_mm / kTexelsPerSquare;
  const Vector2d size_mm(texel_mm * std::round(sheet.size_mm.x() / texel_mm),
                         texel_mm * std::round(sheet.size_mm.y() / texel_mm));
  BoardTarget target;
  target.part.shape = PartSettings::Shape::kPlate;
  target.part.length_mm = size_mm.x();
  target.part.width_mm = size_mm.y();
  target.part.thickness_mm = kThickness_mm;
  target.material.type = MaterialSettings::Type::kDiffuse;
  target.material.reflectance = {paper};
  target.material.texture.colour_file = ink_file;
  target.material.texture.encoding = TextureEncoding::kLinear;
  target.material.texture.size_mm = {size_mm.x(), size_mm.y()};
  // The board's y runs down the sheet and its z into it.
  target.part_from_board.rotation = Vector3d(1.0, -1.0, -1.0).asDiagonal();
  const Vector2d corner_mm = painted_corner_mm(sheet, texel_mm);
  target.part_from_board.translation_mm = {
      corner_mm.x() - 0.5 * size_mm.x(), 0.5 * size_mm.y() - corner_mm.y(), 0.5 * kThickness_mm};
  return target;
}

std::string board_part_toml(const BoardTarget& target) {
  const std::vector<double>& size_mm = target.material.texture.size_mm;
  const Vector3d& at_mm = target.part_from_board.translation_mm;
  return fmt::format(
      "# glint calibrate --print_board: the sheet as the part of a scene, by include\n"
      "# part_from_board: half a turn about x, then {} {} {} mm\n"
      "[part]\nshape = \"plate\"\nlength_mm = {}\nwidth_mm = {}\nthickness_mm = {}\n\n"
      "[material]\ntype = \"diffuse\"\nreflectance = [{}]\n\n"
      "[material.texture]\ncolour_file = \"{}\"\nencoding = \"linear\"\nsize_mm = [{}, {}]\n",
      at_mm.x(),
      at_mm.y(),
      at_mm.z(),
      target.part.length_mm,
      target.part.width_mm,
      target.part.thickness_mm,
      target.material.reflectance.front(),
      target.material.texture.colour_file.string(),
      size_mm[0],
      size_mm[1]);
}

}  // namespace glint
