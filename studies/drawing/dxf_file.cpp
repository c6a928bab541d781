// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/dxf_file.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace glint {
namespace {

using Eigen::Vector2d;

/// A group: its code on one line, its value on the next.
std::string group(int code, std::string_view value) {
  return fmt::format("{}\n{}\n", code, value);
}

std::string group(int code, double value) {
  const double rounded = std::round(value * 1e4) / 1e4;
  return fmt::format("{}\n{:.4f}\n", code, rounded == 0.0 ? 0.0 : rounded);
}

/// Letters that release 12 has no code for become its escapes; control characters become blanks.
std::string plain_text(std::string_view words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto byte = static_cast<unsigned char>(words[i]);
    if (byte == 0xC2 && i + 1 < words.size() && words[i + 1] == '\xB0') {
      text += "%%d";
      ++i;
    } else if (byte == 0xC3 && i + 1 < words.size() && words[i + 1] == '\x98') {
      text += "%%c";
      ++i;
    } else if (byte < 0x20 || byte == 0x7F) {
      text += ' ';
    } else {
      text += byte < 0x80 ? words[i] : (byte >= 0xC0 ? '?' : '\0');
    }
  }
  std::erase(text, '\0');
  return text;
}

constexpr int kWhite = 7;

}  // namespace

void DxfFile::begin(std::string_view kind, std::string_view layer) {
  if (std::ranges::find(layers_, layer) == layers_.end()) {
    layers_.emplace_back(layer);
  }
  entities_ += group(0, kind) + group(8, layer);
}

void DxfFile::point(const Vector2d& at, int code) {
  entities_ += group(code, at.x()) + group(code + 10, at.y()) + group(code + 20, 0.0);
}

void DxfFile::line(std::string_view layer, const Vector2d& a, const Vector2d& b) {
  begin("LINE", layer);
  point(a);
  point(b, 11);
}

void DxfFile::begin_polyline(std::string_view layer, bool is_closed) {
  begin("POLYLINE", layer);
  entities_ += group(66, "1");
  point(Vector2d::Zero());
  entities_ += group(70, is_closed ? "1" : "0");
}

void DxfFile::vertex(std::string_view layer, const Vector2d& at, double bulge) {
  begin("VERTEX", layer);
  point(at);
  if (bulge != 0.0) {
    entities_ += fmt::format("42\n{:.9f}\n", bulge);
  }
}

void DxfFile::end_polyline(std::string_view layer) {
  begin("SEQEND", layer);
}

void DxfFile::chain(std::string_view layer, std::span<const Arc> arcs) {
  if (arcs.empty()) {
    return;
  }
  begin_polyline(layer, false);
  for (const Arc& arc : arcs) {
    vertex(layer, arc.from_mm, arc.bulge);
  }
  vertex(layer, arcs.back().to_mm, 0.0);
  end_polyline(layer);
}

void DxfFile::polyline(std::string_view layer, std::span<const Vector2d> points, bool is_closed) {
  if (points.size() < 2) {
    return;
  }
  begin_polyline(layer, is_closed);
  for (const Vector2d& at : points) {
    vertex(layer, at, 0.0);
  }
  end_polyline(layer);
}

void DxfFile::text(std::string_view layer,
                   const Vector2d& at,
                   double height_mm,
                   std::string_view words) {
  begin("TEXT", layer);
  point(at);
  entities_ += group(40, height_mm) + group(1, plain_text(words));
}

std::string DxfFile::document() const {
  std::string text = group(0, "SECTION") + group(2, "HEADER") + group(9, "$ACADVER") +
                     group(1, "AC1009") + group(9, "$INSUNITS") + group(70, "4") +
                     group(0, "ENDSEC");
  text += group(0, "SECTION") + group(2, "TABLES");
  text += group(0, "TABLE") + group(2, "LTYPE") + group(70, "1") + group(0, "LTYPE") +
          group(2, "CONTINUOUS") + group(70, "0") + group(3, "Solid line") + group(72, "65") +
          group(73, "0") + group(40, 0.0) + group(0, "ENDTAB");
  text += group(0, "TABLE") + group(2, "LAYER") + group(70, std::to_string(layers_.size()));
  for (const std::string& layer : layers_) {
    text += group(0, "LAYER") + group(2, layer) + group(70, "0") +
            group(62, std::to_string(kWhite)) + group(6, "CONTINUOUS");
  }
  text += group(0, "ENDTAB") + group(0, "ENDSEC");
  text += group(0, "SECTION") + group(2, "ENTITIES") + entities_ + group(0, "ENDSEC");
  return text + group(0, "EOF");
}

}  // namespace glint
