#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "experiments/report/report.hpp"
#include "libsim/base/error.hpp"

namespace modcal::report::audio_test {
namespace {

std::vector<unsigned char> decoded(const std::string& uri) {
  const std::string prefix = "data:audio/wav;base64,";
  EXPECT_TRUE(uri.starts_with(prefix));
  static const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (std::size_t i = prefix.size(); i < uri.size() && uri[i] != '='; ++i) {
    group = group << 6 | static_cast<std::uint32_t>(digits.find(uri[i]));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(group >> bits));
  }
  return bytes;
}

std::uint32_t number(const std::vector<unsigned char>& bytes, std::size_t at, int size) {
  std::uint32_t value = 0;
  for (int i = size - 1; i >= 0; --i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

std::vector<double> tone(std::size_t samples) {
  std::vector<double> result(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    result[i] = 3.0 + 0.01 * std::sin(2.0 * std::numbers::pi * 0.025 * static_cast<double>(i));
  }
  return result;
}

TEST(Audio, WritesAWaveFileOf16Bits) {
  const std::vector<unsigned char> wav = decoded(wav_data_uri(tone(1600), 16000.0));
  ASSERT_EQ(wav.size(), 44u + 3200u);
  EXPECT_EQ(std::string(wav.begin(), wav.begin() + 4), "RIFF");
  EXPECT_EQ(number(wav, 4, 4), wav.size() - 8);
  EXPECT_EQ(std::string(wav.begin() + 8, wav.begin() + 16), "WAVEfmt ");
  EXPECT_EQ(number(wav, 20, 2), 1u);  // PCM
  EXPECT_EQ(number(wav, 22, 2), 1u);
  EXPECT_EQ(number(wav, 24, 4), 16000u);
  EXPECT_EQ(number(wav, 34, 2), 16u);
  EXPECT_EQ(number(wav, 40, 4), 3200u);
}

// The constant 3 is gone, the peak of 0.01 is at 0.9 of full scale, the ends are silent.
TEST(Audio, BringsAQuietSignalToItsPeakAndFadesTheEnds) {
  const std::vector<unsigned char> wav = decoded(wav_data_uri(tone(1600), 16000.0));
  int peak = 0;
  for (std::size_t at = 44; at < wav.size(); at += 2) {
    peak = std::max(peak, std::abs(static_cast<std::int16_t>(number(wav, at, 2))));
  }
  EXPECT_NEAR(peak, 0.9 * 32767.0, 1.0);
  EXPECT_EQ(number(wav, 44, 2), 0u);
  EXPECT_EQ(number(wav, wav.size() - 2, 2), 0u);
}

TEST(Audio, PlaysSilenceAsSilence) {
  const std::vector<unsigned char> wav =
      decoded(wav_data_uri(std::vector<double>(100, 7.0), 8000.0));
  for (std::size_t at = 44; at < wav.size(); ++at) EXPECT_EQ(wav[at], 0);
}

TEST(Audio, RefusesWhatNoBrowserPlays) {
  const Audio good{
      .id = "a", .title = "", .caption = "", .sample_rate = 8000.0, .tracks = {{"x", {1.0, 2.0}}}};
  EXPECT_NO_THROW(check_audio(good));
  Audio bad = good;
  bad.sample_rate = 8000.5;
  EXPECT_THROW(check_audio(bad), InvalidInput);
  bad = good;
  bad.tracks[0].samples.clear();
  EXPECT_THROW(check_audio(bad), InvalidInput);
  bad = good;
  bad.tracks[0].samples[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(check_audio(bad), InvalidInput);
  bad = good;
  bad.id = "a b";
  EXPECT_THROW(check_audio(bad), InvalidInput);
}

}  // namespace
}  // namespace modcal::report::audio_test
