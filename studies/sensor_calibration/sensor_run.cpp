// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/sensor_calibration/sensor_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/thread_pool.h"
#include "core/wall_clock.h"
#include "hardware/photon_transfer/photon_transfer.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"
#include "studies/sensor_calibration/sensor_levels.h"
#include "studies/sensor_calibration/sensor_page.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

const std::array<std::string, 6> result_names = {
    "sensor.toml", "sensor.json", "levels.csv", "flat_field.exr", "report.html", "run.json"};

/// A picture's codes as its file holds them, and the bits that any of them sets.
struct Codes {
  ImageF values;
  unsigned bits = 0;
};

Codes codes_of(const fs::path& file) {
  const Picture picture = read_picture(file);
  if (picture.is_float || picture.channels != 1) {
    throw ConfigError(fmt::format(
        "{}: must be a grey picture of 8 or 16 bits, as the camera gave it", file.string()));
  }
  Codes codes{.values = ImageF(picture.width(), picture.height())};
  std::visit(
      [&](const auto& image) {
        for (std::size_t i = 0; i < image.size(); ++i) {
          codes.bits |= static_cast<unsigned>(image.values()[i]);
          codes.values.values()[i] = static_cast<float>(image.values()[i]);
        }
      },
      picture.pixels);
  return codes;
}

/// The pictures of a folder as levels.
class SensorPictures {
 public:
  SensorPictures(const SensorOptions& options, ThreadPool& pool)
      : files_(read_levels(options.folder)), pool_(pool) {
    const auto bits = pool.map<unsigned>(std::ssize(files_), [&](std::int64_t i) {
      unsigned all = 0;
      for (const Codes& codes : read(files_[static_cast<std::size_t>(i)])) {
        all |= codes.bits;
      }
      return all;
    });
    unsigned all = 0;
    for (const unsigned of_level : bits) {
      all |= of_level;
    }
    range_ = options.bits ? told_range(*options.bits, all) : code_range(all);
  }

  int bits() const { return range_.bits; }

  double full_scale_dn() const { return std::pow(2.0, range_.bits) - 1.0; }

  const std::vector<LevelFiles>& files() const { return files_; }

  /// The pictures of a level in codes.
  std::vector<ImageF> pictures(const LevelFiles& level) const {
    std::vector<ImageF> images;
    for (Codes& codes : read(level)) {
      for (float& value : codes.values.values()) {
        value = std::ldexp(value, -range_.shift);
      }
      images.push_back(std::move(codes.values));
    }
    return images;
  }

  std::vector<LevelStatistics> levels() const {
    return pool_.map<LevelStatistics>(std::ssize(files_), [&](std::int64_t i) {
      const LevelFiles& level = files_[static_cast<std::size_t>(i)];
      LevelStatistics statistics = level_statistics(pictures(level), full_scale_dn());
      statistics.is_dark = level.is_dark;
      statistics.exposure = level.exposure;
      statistics.photons = level.photons;
      return statistics;
    });
  }

 private:
  static std::vector<Codes> read(const LevelFiles& level) {
    std::vector<Codes> pictures;
    for (const fs::path& file : level.pictures) {
      pictures.push_back(codes_of(file));
      const ImageF& first = pictures.front().values;
      const ImageF& last = pictures.back().values;
      if (last.width() != first.width() || last.height() != first.height()) {
        throw ConfigError(fmt::format("{}: has {} x {} pixels, {} has {} x {}",
                                      file.string(),
                                      last.width(),
                                      last.height(),
                                      level.pictures.front().string(),
                                      first.width(),
                                      first.height()));
      }
    }
    return pictures;
  }

  std::vector<LevelFiles> files_;
  CodeRange range_;
  ThreadPool& pool_;
};

Json known(double value) {
  return value > 0.0 && std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json level_json(const LevelStatistics& level, bool is_fitted) {
  return {{"kind", level.is_dark ? "dark" : "bright"},
          {"exposure", level.exposure},
          {"photons", known(level.photons)},
          {"pictures", level.pictures},
          {"mean_dn", level.mean_dn},
          {"temporal_variance_dn2", level.temporal_variance_dn2},
          {"spatial_variance_dn2", level.spatial_variance_dn2},
          {"clipped_share", level.clipped_share},
          {"fitted", is_fitted}};
}

/// The time at which radiance 1 of a scene reaches full scale.
double full_scale_exposure(const PhotonTransfer& transfer) {
  return transfer.rate_dn > 0.0 ? transfer.full_scale_dn / transfer.rate_dn : 0.0;
}

Json sensor_json(const PhotonTransfer& transfer, int bits) {
  return {{"bits", bits},
          {"gain", 1.0},
          {"full_well_e", transfer.full_scale_e},
          {"read_noise_e", transfer.read_noise_e},
          {"dark_e", transfer.dark_e}};
}

Json result_json(std::span<const LevelStatistics> levels,
                 const PhotonTransfer& transfer,
                 int bits) {
  Json json = {{"schema", 1},
               {"status", "done"},
               {"fit", "weighted affine"},
               {"bits", bits},
               {"gain_dn_per_e", transfer.fit.slope},
               {"gain_sigma", transfer.fit.slope_sigma},
               {"offset_dn2", transfer.fit.offset},
               {"dark_mean_dn", transfer.dark_mean_dn},
               {"dark_variance_dn2", transfer.dark_variance_dn2},
               {"dark_rate_dn_per_exposure", transfer.dark_rate_dn},
               {"dark_noise_e", transfer.dark_noise_e},
               {"saturation_dn", transfer.saturation_dn},
               {"saturation_e", transfer.saturation_e},
               {"linearity_error",
                transfer.linearity_error ? Json(*transfer.linearity_error) : Json(nullptr)},
               {"responsivity_dn_per_photon", known(transfer.responsivity_dn)},
               {"quantum_efficiency", known(transfer.quantum_efficiency)},
               {"prnu", transfer.photo_response_nonuniformity},
               {"dsnu_e", transfer.dark_nonuniformity_e},
               {"largest_snr", transfer.largest_snr},
               {"dynamic_range", transfer.dynamic_range},
               {"full_scale_exposure", known(full_scale_exposure(transfer))},
               {"sensor", sensor_json(transfer, bits)},
               {"levels", Json::array()},
               {"warnings", transfer.warnings}};
  for (std::size_t i = 0; i < levels.size(); ++i) {
    json["levels"].push_back(level_json(levels[i], transfer.is_fitted[i]));
  }
  return json;
}

std::string sensor_toml(const PhotonTransfer& transfer, int bits) {
  std::string text = fmt::format(
      "# glint calibrate --sensor: include = [\"sensor.toml\"] in a scene takes this sensor\n"
      "# {:.5g} +- {:.2g} DN per electron (weighted affine fit of variance against mean)\n",
      transfer.fit.slope,
      transfer.fit.slope_sigma);
  if (const double exposure = full_scale_exposure(transfer); exposure > 0.0) {
    text +=
        fmt::format("# exposure = 1 is {:.6g} (unit of the levels) under their light\n", exposure);
  }
  return text + fmt::format(
                    "[sensor]\nbits = {}\ngain = 1\nfull_well_e = {:.6g}\n"
                    "read_noise_e = {:.5g}\ndark_e = {:.5g}\n",
                    bits,
                    transfer.full_scale_e,
                    transfer.read_noise_e,
                    transfer.dark_e);
}

std::string levels_csv(std::span<const LevelStatistics> levels, const PhotonTransfer& transfer) {
  std::string text = csv_row_of("kind",
                                "exposure",
                                "photons",
                                "pictures",
                                "mean_dn",
                                "temporal_variance_dn2",
                                "spatial_variance_dn2",
                                "clipped_share",
                                "fitted");
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelStatistics& level = levels[i];
    text += csv_row_of(level.is_dark ? "dark" : "bright",
                       level.exposure,
                       level.photons,
                       level.pictures,
                       level.mean_dn,
                       level.temporal_variance_dn2,
                       level.spatial_variance_dn2,
                       level.clipped_share,
                       transfer.is_fitted[i] ? "yes" : "no");
  }
  return text;
}

/// Response of each pixel over the mean response: the bright level nearest to half saturation
/// without the dark levels' mean picture.
ImageF flat_field(const SensorPictures& pictures,
                  std::span<const LevelStatistics> levels,
                  const PhotonTransfer& transfer) {
  std::size_t half = 0;
  std::size_t dark = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double away = std::abs(levels[i].mean_dn - 0.5 * transfer.saturation_dn);
    if (levels[i].is_dark) {
      dark = i;
    } else if (away < nearest) {
      nearest = away;
      half = i;
    }
  }
  const Image<double> bright = mean_picture(pictures.pictures(pictures.files()[half]));
  const Image<double> black = mean_picture(pictures.pictures(pictures.files()[dark]));
  if (bright.width() != black.width() || bright.height() != black.height()) {
    throw ConfigError("bright and dark pictures have different sizes");
  }
  const double mean = levels[half].mean_dn - levels[dark].mean_dn;
  ImageF flat(bright.width(), bright.height());
  for (std::size_t i = 0; i < flat.size(); ++i) {
    flat.values()[i] = static_cast<float>((bright.values()[i] - black.values()[i]) / mean);
  }
  return flat;
}

fs::path out_of(const SensorOptions& options) {
  std::error_code ignored;
  const fs::path folder = fs::weakly_canonical(fs::absolute(options.folder, ignored), ignored);
  const std::string name =
      folder.has_filename() ? folder.filename().string() : folder.parent_path().filename().string();
  return options.out.empty()
             ? default_result_folder(name.empty() ? "camera" : name, ResultKind::kSensor)
             : options.out;
}

}  // namespace

Json calibrate_sensor(const SensorOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::string started = utc_text(std::chrono::system_clock::now());
  const fs::path out = out_of(options);
  check_result_folder(out, ResultKind::kSensor, result_names);
  check_inputs_kept(std::array<fs::path, 1>{options.folder / "levels.csv"}, out, result_names);
  if (options.out.empty()) {
    check_source_of_folder(out, {options.folder});
  }
  ThreadPool pool(options.threads);
  const SensorPictures pictures(options, pool);
  const std::vector<LevelStatistics> levels = pictures.levels();
  const PhotonTransfer transfer = photon_transfer(levels, pictures.full_scale_dn());
  Json result = result_json(levels, transfer, pictures.bits());
  const std::string toml = sensor_toml(transfer, pictures.bits());
  ResultWriter writer(out, ResultKind::kSensor);
  write_file(writer.path() / "sensor.toml", toml);
  write_file(writer.path() / "sensor.json", result.dump(2) + "\n");
  write_file(writer.path() / "levels.csv", levels_csv(levels, transfer));
  write_exr(writer.path() / "flat_field.exr", flat_field(pictures, levels, transfer));
  write_file(
      writer.path() / "report.html",
      sensor_page(result, levels, transfer, toml, moment_text(started, seconds_since(start))));
  writer.finish({{"levels", levels.size()},
                 {"source", source_seen_from(out, options.folder)},
                 {"threads", options.threads}},
                start);
  result["report"] = (out / "report.html").string();
  result["folder"] = out.string();
  return result;
}

}  // namespace glint
