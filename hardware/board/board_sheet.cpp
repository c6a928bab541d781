// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/board_sheet.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/text.h"
#include "hardware/board/charuco.h"

namespace glint {
namespace {

constexpr double kMinBorderMm = 10.0;
constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr double kLineSpacing = 1.4;  ///< of the letters' height
constexpr double kRulerMm = 50.0;

void add_marker(const Board& board, const CharucoMarker& marker, BoardSheet& sheet) {
  const double side = marker_side_mm(board);
  const double module = side / marker.side;
  const Eigen::Vector2d middle =
      sheet.first_corner_mm +
      board.square_mm * (marker.square.cast<double>() - Eigen::Vector2d(0.5, 0.5));
  const Eigen::Vector2d corner = middle - Eigen::Vector2d(0.5 * side, 0.5 * side);
  const auto is_dark = [&](int x, int y) {
    return x < marker.side && marker.is_dark[static_cast<std::size_t>(y * marker.side + x)];
  };
  for (int y = 0; y < marker.side; ++y) {
    for (int x = 0; x < marker.side; ++x) {
      int end = x;
      while (is_dark(end, y)) {
        ++end;
      }
      if (end > x) {
        sheet.dark.push_back({.corner_mm = corner + module * Eigen::Vector2d(x, y),
                              .size_mm = module * Eigen::Vector2d(end - x, 1)});
        x = end;
      }
    }
  }
}

std::vector<std::string> words_of(const Board& board) {
  const bool is_charuco = board.kind == BoardKind::kCharuco;
  std::vector<std::string> words = {
      fmt::format("glint board: {}, cols = {}, rows = {} inner corners, square_mm = {}{}",
                  is_charuco ? "charuco" : "checkerboard",
                  board.cols,
                  board.rows,
                  shortest(board.square_mm),
                  board.mark ? ", mark = true" : "")};
  if (is_charuco) {
    constexpr int kBits[] = {4, 5, 6, 7};
    const int bits = kBits[static_cast<std::size_t>(board.dictionary)];
    words.push_back(fmt::format(
        "marker_mm = {}, dictionary = {}x{}", shortest(marker_side_mm(board)), bits, bits));
  }
  words.push_back(fmt::format(
      "Print at 100 %, without fitting to the page. This line is {} mm long:", shortest(kRulerMm)));
  return words;
}

/// A circle of four cubic curves; they leave it by at most 0.03 % of the radius.
std::string pdf_circle(const Eigen::Vector2d& center, double radius) {
  constexpr double kHandle = 0.5522847498;
  const auto at = [&](double x, double y) {
    return fmt::format("{:.4f} {:.4f} ", center.x() + radius * x, center.y() + radius * y);
  };
  const double h = kHandle;
  return at(1, 0) + "m " + at(1, h) + at(h, 1) + at(0, 1) + "c " + at(-h, 1) + at(-1, h) +
         at(-1, 0) + "c " + at(-1, -h) + at(-h, -1) + at(0, -1) + "c " + at(h, -1) + at(1, -h) +
         at(1, 0) + "c f\n";
}

std::string pdf_text(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '(' || c == ')' || c == '\\') {
      escaped += '\\';
    }
    escaped += c;
  }
  return escaped;
}

/// The words below the board and the ruler below them, in mm with y upwards.
std::string pdf_words(const BoardSheet& sheet) {
  std::string text;
  double y = sheet.size_mm.y() - sheet.words_mm.y();
  for (const std::string& line : sheet.words) {
    text += fmt::format("BT /F1 {:.3f} Tf {:.4f} {:.4f} Td ({}) Tj ET\n",
                        sheet.word_height_mm,
                        sheet.words_mm.x(),
                        y,
                        pdf_text(line));
    y -= kLineSpacing * sheet.word_height_mm;
  }
  y += 0.5 * sheet.word_height_mm;
  return text + fmt::format("0.2 w {0:.4f} {1:.4f} m {2:.4f} {1:.4f} l S\n",
                            sheet.words_mm.x(),
                            y,
                            sheet.words_mm.x() + sheet.ruler_mm);
}

/// The page's drawing, in mm with y upwards.
std::string pdf_page(const BoardSheet& sheet) {
  const double height = sheet.size_mm.y();
  std::string page = fmt::format("{0:.6f} 0 0 {0:.6f} 0 0 cm\n", kPointsPerMm);
  for (const SheetRectangle& r : sheet.dark) {
    page += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} re\n",
                        r.corner_mm.x(),
                        height - r.corner_mm.y() - r.size_mm.y(),
                        r.size_mm.x(),
                        r.size_mm.y());
  }
  page += "f\n1 g\n";
  for (const Eigen::Vector2d& dot : sheet.dots_mm) {
    page += pdf_circle({dot.x(), height - dot.y()}, sheet.dot_radius_mm);
  }
  page += "0 g\n";
  return page + pdf_words(sheet);
}

/// The words below the board and the ruler below them.
std::string svg_words(const BoardSheet& sheet) {
  std::string text;
  double y = sheet.words_mm.y();
  for (const std::string& line : sheet.words) {
    text += fmt::format(
        "<text x=\"{:.4f}\" y=\"{:.4f}\" font-family=\"sans-serif\" "
        "font-size=\"{:.2f}\">{}</text>\n",
        sheet.words_mm.x(),
        y,
        sheet.word_height_mm,
        markup_text(line));
    y += kLineSpacing * sheet.word_height_mm;
  }
  return text +
         fmt::format(
             "<path d=\"M{:.4f} {:.4f}h{:.4f}\" stroke=\"#000\" stroke-width=\"0.2\"/>\n</svg>\n",
             sheet.words_mm.x(),
             y - 0.5 * sheet.word_height_mm,
             sheet.ruler_mm);
}

/// The dark squares and the dot that marks one. @param corner  of the board, in mm
void add_squares(const Board& board, const Eigen::Vector2d& corner, BoardSheet& sheet) {
  for (int row = 0; row <= board.rows; ++row) {
    for (int col = row % 2; col <= board.cols; col += 2) {
      sheet.dark.push_back({.corner_mm = corner + board.square_mm * Eigen::Vector2d(col, row),
                            .size_mm = {board.square_mm, board.square_mm}});
    }
  }
  if (board.mark) {
    sheet.dots_mm.emplace_back(corner + 0.5 * board.square_mm * Eigen::Vector2d(1.0, 1.0));
    sheet.dot_radius_mm = 0.5 * kMarkSquares * board.square_mm;
  }
}

}  // namespace

BoardSheet board_sheet(const Board& board) {
  const double border = std::max(kMinBorderMm, board.square_mm);
  const Eigen::Vector2d squares = board.square_mm * Eigen::Vector2d(board.cols + 1, board.rows + 1);
  BoardSheet sheet = {.words = words_of(board), .word_height_mm = 3.0, .ruler_mm = kRulerMm};
  constexpr double kWordsWidth = 125.0;  // of the longest line
  const double below =
      sheet.word_height_mm * kLineSpacing * static_cast<double>(sheet.words.size() + 1);
  sheet.size_mm = {std::max(squares.x() + 2.0 * border, kWordsWidth + 2.0 * kMinBorderMm),
                   squares.y() + 2.0 * border + below};
  const Eigen::Vector2d corner(0.5 * (sheet.size_mm.x() - squares.x()), border);
  sheet.first_corner_mm = corner + Eigen::Vector2d(board.square_mm, board.square_mm);
  add_squares(board, corner, sheet);
  if (board.kind == BoardKind::kCharuco) {
    for (const CharucoMarker& marker : charuco_markers(board)) {
      add_marker(board, marker, sheet);
    }
  }
  sheet.words_mm = {std::min(corner.x(), 0.5 * (sheet.size_mm.x() - kWordsWidth)),
                    corner.y() + squares.y() + border};
  return sheet;
}

std::string sheet_svg(const BoardSheet& sheet) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.4f}mm\" height=\"{1:.4f}mm\" "
      "viewBox=\"0 0 {0:.4f} {1:.4f}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
      "<path shape-rendering=\"geometricPrecision\" d=\"",
      sheet.size_mm.x(),
      sheet.size_mm.y());
  for (const SheetRectangle& r : sheet.dark) {
    svg += fmt::format("M{:.4f} {:.4f}h{:.4f}v{:.4f}h{:.4f}z",
                       r.corner_mm.x(),
                       r.corner_mm.y(),
                       r.size_mm.x(),
                       r.size_mm.y(),
                       -r.size_mm.x());
  }
  svg += "\"/>\n";
  for (const Eigen::Vector2d& dot : sheet.dots_mm) {
    svg += fmt::format("<circle cx=\"{:.4f}\" cy=\"{:.4f}\" r=\"{:.4f}\" fill=\"#fff\"/>\n",
                       dot.x(),
                       dot.y(),
                       sheet.dot_radius_mm);
  }
  return svg + svg_words(sheet);
}

std::string sheet_pdf(const BoardSheet& sheet) {
  const std::string page = pdf_page(sheet);
  const std::vector<std::string> objects = {
      "<< /Type /Catalog /Pages 2 0 R >>",
      "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.4f} {:.4f}] /Contents 4 0 R "
                  "/Resources << /Font << /F1 5 0 R >> >> >>",
                  sheet.size_mm.x() * kPointsPerMm,
                  sheet.size_mm.y() * kPointsPerMm),
      fmt::format("<< /Length {} >>\nstream\n{}endstream", page.size(), page),
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"};
  std::string pdf = "%PDF-1.4\n";
  std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    table += fmt::format("{:010} 00000 n \n", pdf.size());
    pdf += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
  }
  const std::size_t start = pdf.size();
  return pdf + table +
         fmt::format("trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n",
                     objects.size() + 1,
                     start);
}

}  // namespace glint
