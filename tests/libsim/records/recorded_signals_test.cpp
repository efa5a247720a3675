#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/records/formats.hpp"
#include "libsim/records/recording.hpp"
#include "libsim/signal/measurement.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::recorded_signals_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LoadRecord : public FolderTest {
 protected:
  RecordOptions csv(std::string_view content) const {
    write("r.csv", content);
    RecordOptions options;
    options.file = "r.csv";
    options.has_left = options.has_right = true;
    options.left.channel = "R1";
    options.right.channel = "R2";
    return options;
  }
  RecordedSignals load(const RecordOptions& options) const {
    return load_record(options, folder());
  }
  std::string error(const RecordOptions& options) const {
    return refusal_of([&] { load(options); });
  }
};

constexpr std::string_view kRecord =
    "t [s],R1 [N],R2 [mN],F [V],raw\n0,1,10,2,5\n0.5,2,20,4,6\n1,3,30,6,7\n1.5,5,50,8,9\n";

TEST_F(LoadRecord, ConvertsUnitsAndAppliesCalibrations) {
  RecordOptions options = csv(kRecord);
  options.has_reference = true;
  options.reference.channel = "F";
  options.reference.calibration = -0.25;
  const RecordedSignals signals = load(options);
  EXPECT_EQ(signals.sample_rate, 2.0);
  EXPECT_THAT(signals.left->samples, ElementsAre(1.0, 2.0, 3.0, 5.0));
  EXPECT_THAT(signals.right->samples, ElementsAre(0.01, 0.02, 0.03, 0.05));
  EXPECT_THAT(signals.reference->samples, ElementsAre(-0.5, -1.0, -1.5, -2.0));
  EXPECT_EQ(signals.left->quantity, "R1");
  EXPECT_EQ(signals.right->quantity, "R2");
  EXPECT_EQ(signals.reference->quantity, "f_c");
  EXPECT_EQ(signals.reference->unit, "N");
  EXPECT_EQ(signals.left->sample_rate, 2.0);
  EXPECT_THAT(signals.warnings, IsEmpty());
}

TEST_F(LoadRecord, TurnsTheSignOfAChannelInNewtons) {
  RecordOptions options = csv(kRecord);
  options.left.turned = true;
  EXPECT_THAT(load(options).left->samples, ElementsAre(-1.0, -2.0, -3.0, -5.0));
}

TEST_F(LoadRecord, ReadsTheMotionAtTheContact) {
  RecordOptions options =
      csv("t [s],R1 [N],R2 [N],v [mm/s],y [um]\n0,1,2,3,4\n1,2,3,4,8\n2,4,3,4,2\n");
  options.has_reference_velocity = options.has_reference_displacement = true;
  options.reference_velocity.channel = "v";
  options.reference_displacement.channel = "y";
  const RecordedSignals signals = load(options);
  EXPECT_THAT(signals.reference_velocity->samples, ElementsAre(3e-3, 4e-3, 4e-3));
  EXPECT_EQ(signals.reference_velocity->unit, "m/s");
  EXPECT_THAT(signals.reference_displacement->samples, ElementsAre(4e-6, 8e-6, 2e-6));
  options.reference_velocity.channel = "y";
  options.has_reference_displacement = false;
  EXPECT_THAT(error(options), HasSubstr("is in \"um\", which is no unit of velocity; state "
                                        "record.reference_velocity.calibration, the velocity per"));
}

TEST_F(LoadRecord, TakesOneReactionAlone) {
  RecordOptions options = csv(kRecord);
  options.has_left = false;
  options.right.channel = "3";  // columns count from 1, time included
  const RecordedSignals signals = load(options);
  EXPECT_FALSE(signals.left.has_value());
  EXPECT_THAT(signals.right->samples, ElementsAre(0.01, 0.02, 0.03, 0.05));
  EXPECT_EQ(signals.size(), 4u);
}

TEST_F(LoadRecord, CropsToTheWindow) {
  RecordOptions options = csv(kRecord);
  options.start = 0.5;
  options.stop = 1.5;
  EXPECT_THAT(load(options).left->samples, ElementsAre(2.0, 3.0));
  options.stop = 2.1;
  EXPECT_THAT(load(options).left->samples, ElementsAre(2.0, 3.0, 5.0));
}

TEST_F(LoadRecord, RefusesWindowsOutsideTheRecord) {
  RecordOptions options = csv(kRecord);
  options.stop = 3.0;
  EXPECT_THAT(error(options), HasSubstr("the part from start = 0 s to stop = 3 s is not in the "
                                        "record, which lasts 2 s"));
  options.start = 1.0;
  options.stop = 1.0;
  EXPECT_THAT(error(options), HasSubstr("start = 1 s to stop = 1 s"));
  options.stop = 1.1;
  EXPECT_THAT(error(options), HasSubstr("no sample lies between 1 s and 1.1 s"));
  options.start = -1.0;
  EXPECT_THAT(error(options), HasSubstr("start = -1 s"));
}

TEST_F(LoadRecord, ShiftsDelayedChannelsBack) {
  RecordOptions options = csv(kRecord);
  options.right.delay = 0.5;
  const RecordedSignals signals = load(options);
  EXPECT_THAT(signals.left->samples, ElementsAre(1.0, 2.0, 3.0, 5.0));
  EXPECT_THAT(signals.right->samples, ElementsAre(0.02, 0.03, 0.05, 0.05));
  options.right.delay = 2.0;
  EXPECT_THAT(error(options), HasSubstr("a delay of 2 s does not fit a record of 2 s"));
}

TEST_F(LoadRecord, RefusesChannelsThatAreNoForces) {
  RecordOptions options = csv(kRecord);
  options.left.channel = "F";
  EXPECT_THAT(error(options),
              HasSubstr("r.csv: channel F is in \"V\", which is no unit of force; state "
                        "record.left.calibration, the force per recorded 1"));
  options.left.channel = "raw";
  EXPECT_THAT(error(options), HasSubstr("channel raw has no unit; state record.left.calibration"));
  options = csv(kRecord);
  options.right.calibration = 2.0;
  EXPECT_THAT(error(options), HasSubstr("channel R2 is a force in mN already; leave out "
                                        "record.right.calibration, or the unit in the file"));
  options.left.channel = "raw";
  options.left.calibration = 0.0;
  EXPECT_THAT(error(options), HasSubstr("record.left.calibration = 0 N cannot be used"));
}

TEST_F(LoadRecord, RefusesIncompleteOptions) {
  RecordOptions options = csv(kRecord);
  options.left.channel = "R2";
  EXPECT_THAT(error(options), HasSubstr("channel \"R2\" is asked for twice"));
  options.left.channel = "";
  EXPECT_THAT(error(options), HasSubstr("record.left.channel is empty"));
  options.has_left = options.has_right = false;
  EXPECT_THAT(error(options), HasSubstr("names no reaction"));
  EXPECT_THAT(error({}), HasSubstr("record.file is empty"));
  options = csv(kRecord);
  options.format = "wav";
  EXPECT_THAT(error(options), HasSubstr("cannot be read as an audio file"));
}

TEST_F(LoadRecord, TellsTheFormatByTheExtension) {
  // Each reader has its own words for a file that is not there.
  const std::string csv_missing = "cannot be opened", wav_missing = "there is no such file";
  EXPECT_THAT(refusal_of([] { read_record("a/b.TSV", "auto"); }), HasSubstr(csv_missing));
  EXPECT_THAT(refusal_of([] { read_record("a/b.rf64", "auto"); }), HasSubstr(wav_missing));
  EXPECT_THAT(refusal_of([] { read_record("a/b.dat", "csv"); }), HasSubstr(csv_missing));
  EXPECT_EQ(
      refusal_of([] { read_record("b.dat", "auto"); }),
      "b.dat: the extension \".dat\" does not tell the format; state format: csv, wav, uff, mat, "
      "npy, npz, hdf5, lvm");
  EXPECT_THAT(refusal_of([] { read_record("b.csv", "tdms"); }),
              HasSubstr("unknown format \"tdms\""));
}

TEST_F(LoadRecord, ReadsWavWithAndWithoutItsOwnScale) {
  const std::vector<Signal> forces{{"R1", "mN", 8.0, {1000.0, -500.0}},
                                   {"R2", "", 8.0, {2.0, 4.0}}};
  write_wav(path("r.wav"), forces, {.samples = WavSamples::kDouble, .full_scale = 4096.0});
  RecordOptions options = csv(kRecord);
  options.file = "r.wav";
  EXPECT_THAT(error(options), HasSubstr("channel R2 has no unit; state record.right.calibration"));
  options.right.calibration = 1024.0;
  const RecordedSignals signals = load(options);
  EXPECT_THAT(signals.left->samples, ElementsAre(1.0, -0.5));
  EXPECT_THAT(signals.right->samples, ElementsAre(0.5, 1.0));  // 2/4096 of 1024 N
}

TEST_F(LoadRecord, CalibratesEveryChannelOfAForeignWav) {
  // Written by another program, so to speak: the unit "" keeps the file from stating forces.
  std::vector<Signal> channels;
  for (int c = 0; c < 8; ++c) {
    channels.push_back({fmt::format("ch{}", c), "", 8.0, {c / 16.0, -c / 16.0}});
  }
  write_wav(path("r.wav"), channels, {.samples = WavSamples::kPcm24});
  RecordOptions options = csv(kRecord);
  options.file = "r.wav";
  options.left = {.channel = "8", .calibration = 10.0};
  options.right = {.channel = "ch2", .calibration = 100.0};
  const RecordedSignals signals = load(options);
  EXPECT_THAT(signals.left->samples, ElementsAre(4.375, -4.375));
  EXPECT_THAT(signals.right->samples, ElementsAre(12.5, -12.5));
}

TEST_F(LoadRecord, WarnsOfClipping) {
  const RecordedSignals signals =
      load(csv("# sample_rate: 8 Hz\nR1 [N],R2 [N]\n0,0\n1,1\n1,2\n1,3\n0.5,2\n"));
  EXPECT_THAT(signals.warnings,
              ElementsAre(HasSubstr("channel R1: 3 samples in 1 run of 3 or more at the limits 0 "
                                    "and 1, first at sample 1")));
}

TEST_F(LoadRecord, RefusesSamplesThatTellAgainstTheirChannel) {
  RecordOptions options = csv("# sample_rate: 8 Hz\nR1 [N],R2 [N]\n0,3\n# note\n1,3\n2,3\n");
  EXPECT_THAT(error(options), HasSubstr("r.csv:3: channel R2, sample 0 (0 s): all 3 samples are 3: "
                                        "the channel is silent"));
  options = csv("# sample_rate: 8 Hz\nR1 [N],R2 [N]\n0,3\n# note\n1,1e200\n2,3\n");
  EXPECT_THAT(error(options), HasSubstr("r.csv:5: channel R2, sample 1 (0.125 s): 1e+200"));
  // Not in the part that is used, and not in what is for scoring only.
  options.start = 0.25;
  EXPECT_EQ(error(options), "accepted");
  options.start = 0.0;
  options.has_right = false;
  options.has_reference = true;
  options.reference.channel = "R2";
  EXPECT_EQ(error(options), "accepted");
}

TEST_F(LoadRecord, RefusesARateThatTheFileContradicts) {
  RecordOptions options = csv(kRecord);
  options.sample_rate = 2.1;
  EXPECT_THAT(error(options), testing::AllOf(HasSubstr("the file contradicts it"),
                                             HasSubstr("the file says 2 Hz, not the stated 2.1 Hz"),
                                             HasSubstr("leave record.sample_rate out")));
  options.sample_rate = 2.0004;
  EXPECT_EQ(error(options), "accepted");
  options = csv("t [s],R1 [N],R2 [N]\n0,1,2\n1,2,3\n2,3,4\n5,5,6\n6,6,7\n7,6,7\n");
  options.sample_rate = 1.0;
  EXPECT_THAT(error(options), HasSubstr("r.csv:5: sample 3: a gap of 3 s before 5 s"));
}

TEST_F(LoadRecord, ForeseesWhatReadingNeedsAndStopsWhenAsked) {
  std::string text = "a,b\n";
  for (int i = 0; i < 10000; ++i) text += "1,2\n";
  write("r.csv", "# sample_rate: 10 Hz\n# a comment\n" + text);
  const auto size = size_of_record(path("r.csv"), "auto");
  ASSERT_TRUE(size.has_value());
  EXPECT_EQ(size->frames, 10000);
  EXPECT_EQ(size->channels, 2);
  const auto read = [&](double memory) {
    return refusal_of([&] { read_record(path("r.csv"), "auto", {.memory = memory}); });
  };
  EXPECT_EQ(read(1e6), "accepted");
  EXPECT_THAT(read(1e5), HasSubstr("reading 1e+04 rows of 2 channels needs about 0.00032 GB"));
  const auto alone = [&](double memory) {
    return refusal_of([&] { read_csv(path("r.csv"), {.memory = memory}); });
  };
  EXPECT_EQ(alone(1e6), "accepted");
  EXPECT_EQ(alone(1e5), read(1e5));
  const Signal signal{"R1", "N", 1000.0, std::vector<double>(300, 0.5)};
  write_wav(path("s.wav"), std::span(&signal, 1));
  EXPECT_THAT(refusal_of([&] { read_wav(path("s.wav"), {.memory = 100.0}); }),
              HasSubstr("reading 300 rows of 1 channels needs about"));
  EXPECT_EQ(read_wav(path("s.wav"), {.memory = 1e5}).frames(), 300U);
  for (const RecordFormat& format : record_formats()) {
    const std::filesystem::path file = path(fmt::format("s{}", format.extensions.front()));
    format.write(file, std::span(&signal, 1), {"test"});
    EXPECT_NEAR(size_of_record(file, "auto")->frames, 300, 1) << file;
    const std::atomic<bool> stop{true};
    EXPECT_THROW(read_record(file, "auto", {.stop = StopToken(stop)}), Interrupted) << file;
  }
  EXPECT_FALSE(size_of_record(path("missing.csv"), "auto").has_value());
}

TEST(Advanced, ShiftsASineByAFractionOfAPeriod) {
  // A sine under a Hann window: smooth at the ends, so the mirror image adds no jump and the error
  // is the window's own tail beyond the Nyquist frequency, (f/f_N)^-3-like: far below 1e-9 here.
  constexpr std::size_t kSize = 4000;
  const double rate = 1000.0;
  const auto value = [&](double t) {
    const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * t * rate / kSize);
    return window * window * std::sin(2 * std::numbers::pi * 90.0 * t);
  };
  std::vector<double> samples(kSize);
  for (std::size_t i = 0; i < kSize; ++i) samples[i] = value(static_cast<double>(i) / rate);
  for (const double delay : {0.00025, -0.0036, 0.0124}) {
    const std::vector<double> shifted = advanced(samples, delay, rate);
    double largest = 0.0;
    for (std::size_t i = 20; i + 20 < kSize; ++i) {
      largest =
          std::max(largest, std::abs(shifted[i] - value(static_cast<double>(i) / rate + delay)));
    }
    EXPECT_LT(largest, 1e-9) << delay;
  }
}

TEST(Advanced, LeavesSamplesAloneWithoutDelay) {
  const std::vector<double> samples{1.0, 0.1, -3.0};
  EXPECT_EQ(advanced(samples, 0.0, 10.0), samples);
}

}  // namespace
}  // namespace modcal::recorded_signals_test
