// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of 5 megapixels by software trigger from a simulated camera on this machine: the rate
// with exposure, transfer, unpacking; and unpacking alone.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include "hardware/camera/aravis_camera.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/camera_twin.h"
#include "hardware/twin/camera/test_pattern.h"

namespace glint {
namespace {

constexpr int kWidth = 2448;
constexpr int kHeight = 2050;

void capture(benchmark::State& state, PixelFormat format, bool uses_packet_sockets) {
  TestPatternSource source(kWidth, kHeight);
  const std::uint32_t address = 0x7f640001U | (static_cast<std::uint32_t>(::getpid() & 0xff) << 8U);
  const CameraTwin twin({.address = address}, source);
  AravisCamera camera(ipv4_text(address));
  camera.configure({.format = format,
                    .exposure_us = 1000.0,
                    .packet_size = 9000,
                    .uses_packet_sockets = uses_packet_sockets});
  camera.start();
  std::int64_t retakes = 0;
  for (auto _ : state) {
    const Frame frame = camera.capture();
    retakes += frame.retakes;
    if (!frame.is_complete()) {
      state.SkipWithError(frame.what.c_str());
      break;
    }
  }
  state.counters["frames/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["retakes"] = static_cast<double>(retakes);
}

void unpack(benchmark::State& state, PixelFormat format) {
  const auto pattern = test_pattern(kWidth, kHeight, bits_of(format), 0);
  const std::vector<std::uint8_t> bytes = packed(pattern.values(), format);
  for (auto _ : state) {
    benchmark::DoNotOptimize(unpacked(bytes, format, kWidth, kHeight));
  }
}

BENCHMARK_CAPTURE(capture, mono8, PixelFormat::kMono8, true)
    ->Name("cell/camera/mono8")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(capture, mono12, PixelFormat::kMono12, true)
    ->Name("cell/camera/mono12")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(capture, mono8_plain, PixelFormat::kMono8, false)
    ->Name("cell/camera/mono8_without_packet_socket")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(unpack, mono8, PixelFormat::kMono8)
    ->Name("cell/unpack/mono8")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unpack, mono12, PixelFormat::kMono12)
    ->Name("cell/unpack/mono12")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unpack, mono12_packed, PixelFormat::kMono12Packed)
    ->Name("cell/unpack/mono12_packed")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unpack, mono12p, PixelFormat::kMono12p)
    ->Name("cell/unpack/mono12p")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint
