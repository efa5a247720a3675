#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <sndfile.hh>
#include <sstream>

#include "libsim/base/random.hpp"
#include "libsim/records/record_file.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::wav_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Wav : public FolderTest {
 protected:
  /// A file as another program writes it: no comment of ours.
  std::filesystem::path foreign(std::string_view name, int format, int channels,
                                const std::vector<double>& interleaved) const {
    SndfileHandle file(path(name).string(), SFM_WRITE, format, channels, 48000);
    file.writef(interleaved.data(), static_cast<sf_count_t>(interleaved.size()) / channels);
    return path(name);
  }
};

std::vector<Signal> noises(std::size_t count, std::size_t size, double scale = 1.0) {
  std::vector<Signal> signals;
  for (std::size_t c = 0; c < count; ++c) {
    signals.push_back({fmt::format("R{}", c + 1), "N", 51200.0, std::vector<double>(size)});
    fill_uniform(StreamKey(2).with(static_cast<std::uint64_t>(c)), signals[c].samples);
    for (double& value : signals[c].samples) value = scale * (2.0 * value - 1.0);
  }
  return signals;
}

TEST_F(Wav, ReadsEverySampleFormatWithinItsQuantization) {
  struct Case {
    int format;
    double step;
  };
  // libsndfile, the writer here, scales integers by 2^(b−1) − 1 and truncates or rounds: a sample x
  // is off by |x| 2^(1−b) and at most one step of 2^(1−b).
  const Case cases[] = {{SF_FORMAT_PCM_U8, std::exp2(-7)},  {SF_FORMAT_PCM_16, std::exp2(-15)},
                        {SF_FORMAT_PCM_24, std::exp2(-23)}, {SF_FORMAT_PCM_32, std::exp2(-31)},
                        {SF_FORMAT_FLOAT, std::exp2(-25)},  {SF_FORMAT_DOUBLE, 0.0}};
  std::vector<double> samples(20000);
  fill_uniform(StreamKey(3), samples);
  for (double& value : samples) value = 2.0 * value - 1.0;
  for (const int container : {SF_FORMAT_WAV, SF_FORMAT_WAVEX, SF_FORMAT_RF64}) {
    for (const auto& [format, step] : cases) {
      const Recording record = read_wav(foreign("a.wav", container | format, 2, samples));
      ASSERT_EQ(record.channels.size(), 2u);
      EXPECT_EQ(record.sample_rate, 48000.0);
      ASSERT_EQ(record.frames(), 10000u);
      double largest = 0.0;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        largest = std::max(largest, std::abs(record.channels[i % 2].samples[i / 2] - samples[i]));
      }
      EXPECT_LE(largest, 2 * step) << record.format;
      EXPECT_EQ(record.channels[1].name, "2");
      EXPECT_TRUE(std::isnan(record.channels[1].full_scale));
    }
  }
}

TEST_F(Wav, RoundTripRestoresNamesUnitsScaleAndSamples) {
  const std::vector<Signal> signals = noises(3, 40000, 4.0);
  const std::pair<WavSamples, double> cases[] = {
      {WavSamples::kDouble, 0.0},             // full scale 8, a power of two: exact
      {WavSamples::kFloat, std::exp2(-23)},   // half a unit of a 24-bit mantissa, |x| ≤ 4
      {WavSamples::kPcm24, std::exp2(-21)}};  // half a step of 8·2^−23
  for (const auto& [samples, bound] : cases) {
    write_wav(path("a.wav"), signals,
              {.samples = samples, .full_scale = 8.0, .provenance = "a long story"});
    const Recording record = read_wav(path("a.wav"));
    ASSERT_EQ(record.channels.size(), 3u);
    EXPECT_EQ(record.sample_rate, 51200.0);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(record.channels[c].name, signals[c].quantity);
      EXPECT_EQ(record.channels[c].unit, "N");
      EXPECT_EQ(record.channels[c].full_scale, 8.0);
      ASSERT_EQ(record.channels[c].samples.size(), 40000u);
      double largest = 0.0;
      for (std::size_t i = 0; i < 40000; ++i) {
        largest = std::max(largest,
                           std::abs(8.0 * record.channels[c].samples[i] - signals[c].samples[i]));
      }
      EXPECT_LE(largest, bound);
    }
  }
}

TEST_F(Wav, EqualSignalsGiveEqualBytes) {
  const auto bytes = [&](std::string_view name) {
    write_wav(path(name), noises(2, 100));
    std::ostringstream text;
    text << std::ifstream(path(name), std::ios::binary).rdbuf();
    return text.str();
  };
  const std::string first = bytes("a.wav");
  EXPECT_EQ(first, bytes("b.wav"));
  EXPECT_EQ(first.find("PEAK"), std::string::npos);  // the chunk that holds the time of day
}

TEST_F(Wav, ReadsEightChannelsByNameAndNumber) {
  const std::vector<Signal> signals = noises(8, 17);
  write_wav(path("a.wav"), signals, {.samples = WavSamples::kDouble});
  const Recording record = read_wav(path("a.wav"), {.channels = {"R7", "2"}});
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_EQ(record.channels[0].samples, signals[6].samples);
  EXPECT_EQ(record.channels[1].samples, signals[1].samples);
  EXPECT_THAT(
      refusal_of([&] { read_wav(path("a.wav"), {.channels = {"R9"}}); }),
      HasSubstr("there is no channel \"R9\", did you mean \"R1\"?; the file has 8 channels"));
  EXPECT_THAT(refusal_of([&] { read_wav(path("a.wav"), {.channels = {"9"}}); }),
              HasSubstr("there is no channel \"9\""));
  EXPECT_THAT(refusal_of([&] {
                read_wav(path("a.wav"), {.channels = {"1", "R1"}});
              }),
              HasSubstr("channel \"R1\" is asked for twice"));
}

TEST_F(Wav, KeepsTheNamesOfManyChannels) {
  const std::vector<Signal> signals = noises(150, 2);
  write_wav(path("a.wav"), signals);
  EXPECT_EQ(read_wav(path("a.wav")).channels[149].name, "R150");
  EXPECT_THAT(refusal_of([&] { write_wav(path("b.wav"), noises(300, 2)); }),
              HasSubstr("the names of 300 channels do not fit"));
}

TEST_F(Wav, ReadsOneSample) {
  const Recording record = read_wav(foreign("a.wav", SF_FORMAT_WAV | SF_FORMAT_DOUBLE, 1, {0.25}));
  EXPECT_THAT(record.channels[0].samples, ElementsAre(0.25));
}

TEST_F(Wav, IgnoresTheCommentsOfOthers) {
  for (const char* comment : {"take 3", "{\"modcal\":{}}", "{\"modcal\":[1]}", "[]",
                              "{\"modcal\":{\"full_scale\":-1,\"channels\":[[\"a\",\"N\"]]}}",
                              "{\"modcal\":{\"full_scale\":1,\"channels\":[[\"a\"]]}}"}) {
    {
      SndfileHandle file(path("a.wav").string(), SFM_WRITE, SF_FORMAT_WAV | SF_FORMAT_FLOAT, 1, 8);
      file.setString(SF_STR_COMMENT, comment);
      const double sample = 0.5;
      file.writef(&sample, 1);
    }
    EXPECT_EQ(read_wav(path("a.wav")).channels[0].name, "1") << comment;
  }
}

TEST_F(Wav, UsesTheRateOfTheUserWithAWarning) {
  const auto file = foreign("a.wav", SF_FORMAT_WAV | SF_FORMAT_PCM_16, 1, {0.25, 0.5});
  const Recording record = read_wav(file, {.channels = {}, .sample_rate = 51200.0});
  EXPECT_EQ(record.sample_rate, 51200.0);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("the file says 48000 Hz")));
}

TEST_F(Wav, WarnsOfFilesThatWereCutOff) {
  const auto file =
      foreign("a.wav", SF_FORMAT_WAV | SF_FORMAT_DOUBLE, 1, std::vector<double>(100, 0.5));
  EXPECT_THAT(read_wav(file).warnings, testing::IsEmpty());
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 400);
  const Recording record = read_wav(file);
  EXPECT_EQ(record.frames(), 50u);
  EXPECT_THAT(record.warnings,
              ElementsAre(HasSubstr("announces more samples than the 50 in the file")));
}

TEST_F(Wav, RefusesSamplesThatAreNoNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto file = foreign("a.wav", SF_FORMAT_WAV | SF_FORMAT_FLOAT, 2, {0, 0, 0, nan, inf, 0});
  const std::string message = refusal_of([&] { read_wav(file); });
  EXPECT_THAT(message, HasSubstr("sample 2 of channel 1 is inf; repair it, or keep only what"));
  EXPECT_THAT(message, HasSubstr("sample 1 of channel 2 is nan"));
  EXPECT_EQ(read_wav(file, {.channels = {}, .survey = true}).problem_count, 2u);
}

TEST_F(Wav, RefusesFilesThatHoldNoRecord) {
  EXPECT_THAT(refusal_of([&] { read_wav(write("a.wav", "")); }), HasSubstr("the file is empty"));
  EXPECT_THAT(refusal_of([&] { read_wav(write("a.wav", "t,R1\n0,1\n")); }),
              HasSubstr("cannot be read as an audio file"));
  EXPECT_THAT(refusal_of([&] { read_wav(path("missing.wav")); }),
              HasSubstr("there is no such file"));
  EXPECT_THAT(refusal_of([&] { read_wav(folder()); }), HasSubstr("this is a folder"));
  EXPECT_THAT(
      refusal_of([&] { read_wav(foreign("e.wav", SF_FORMAT_WAV | SF_FORMAT_FLOAT, 1, {})); }),
      HasSubstr("no samples"));
}

TEST_F(Wav, RefusesWhatTheFormatCannotHold) {
  const auto message = [&](Signal signal, WavWriteOptions options) {
    return refusal_of([&] { write_wav(path("a.wav"), std::vector{signal}, options); });
  };
  EXPECT_THAT(message({"R1", "N", 0.5, {1.0}}, {}),
              HasSubstr("cannot hold a sample rate of 0.5 Hz, only whole numbers of hertz; write "
                        "CSV"));
  EXPECT_THAT(message({"R1", "N", 8.0, {1.0, -2.0}}, {.samples = WavSamples::kPcm24}),
              HasSubstr("R1 reaches 2 N, beyond what full_scale = 1 can hold; choose a full_scale "
                        "above its peak"));
  EXPECT_THAT(message({"R1", "N", 8.0, {1e300}}, {}), HasSubstr("R1 reaches 1e+300 N"));
  EXPECT_THAT(message({"R1", "N", 8.0, {1.0}}, {.full_scale = 0.0}),
              HasSubstr("full_scale = 0 cannot be used: it must be > 0"));
  EXPECT_FALSE(std::filesystem::exists(path("a.wav")));
  EXPECT_THAT(refusal_of([&] { write_wav(path("no/a.wav"), noises(1, 2)); }),
              HasSubstr("cannot be written"));
}

TEST(Rf64, IsTakenWhereThirtyTwoBitSizesDoNotSuffice) {
  EXPECT_FALSE(needs_rf64(4'000'000'000));
  EXPECT_TRUE(needs_rf64(4'294'967'000));
}

}  // namespace
}  // namespace modcal::wav_test
