// What names, units and numbers beside an array tell of a record.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "libsim/records/arrays/array_file.hpp"
#include "tests/refusal.hpp"

namespace modcal::array_record_test {
namespace {

class Arrays : public ArrayFile {
 public:
  void add(const std::vector<std::string>& path, std::vector<double> values,
           const std::string& unit = "") {
    arrays_.push_back({.path = path,
                       .dims = {values.size(), 1},
                       .holds = NamedArray::Holds::kReal,
                       .unit = unit,
                       .place = arrays_.size()});
    values_[arrays_.size() - 1] = std::move(values);
  }
  void add_integers(const std::vector<std::string>& path, std::vector<double> values) {
    add(path, std::move(values));
    arrays_.back().is_integer = true;
  }
  // Of two columns.
  void add_table(const std::vector<std::string>& path, std::vector<double> values) {
    add(path, std::move(values));
    arrays_.back().dims = {arrays_.back().dims[0] / 2, 2};
  }
  void add_text(const std::vector<std::string>& path, const std::string& text) {
    add_texts(path, {text});
  }
  void add_texts(const std::vector<std::string>& path, const std::vector<std::string>& texts) {
    arrays_.push_back({.path = path,
                       .dims = {texts.size(), 1},
                       .holds = NamedArray::Holds::kText,
                       .place = arrays_.size()});
    texts_[arrays_.size() - 1] = texts;
  }
  std::vector<double> column(const NamedArray& array, std::size_t j) override {
    const std::vector<double>& all = values_.at(array.place);
    std::vector<double> column;
    const std::size_t step = array.size() == 1 ? 1 : array.columns();
    for (std::size_t i = j; i < all.size(); i += step) column.push_back(all[i]);
    return column;
  }
  std::vector<std::string> texts(const NamedArray& array) override {
    return texts_.at(array.place);
  }

 private:
  std::map<std::size_t, std::vector<double>> values_;
  std::map<std::size_t, std::vector<std::string>> texts_;
};

const std::vector<double> kSamples = {1.0, 2.0, 3.0, 4.0}, kInstants = {0.0, 0.5, 1.0, 1.5};

// Of an array `a` beside what is added.
class ArrayRecord : public testing::Test {
 protected:
  ArrayRecord() { arrays_->add({"a"}, kSamples, "N"); }
  Recording read(const ReadOptions& options = {}) {
    return recording_of(arrays_, "test file", "a.x", options);
  }
  std::string refusal() {
    return refusal_of([&] { read(); });
  }
  std::shared_ptr<Arrays> arrays_ = std::make_shared<Arrays>();
};

TEST_F(ArrayRecord, HasTheUnitOfItsTime) {
  arrays_->add({"t"}, kInstants, "ms");
  EXPECT_DOUBLE_EQ(read().sample_rate, 2000.0);
}

TEST_F(ArrayRecord, HasTheUnitOfARateOrAPeriod) {
  arrays_->add({"fs"}, {2.0});
  arrays_->add_text({"fs", "unit"}, "kHz");
  EXPECT_DOUBLE_EQ(read().sample_rate, 2000.0);
  arrays_ = std::make_shared<Arrays>();
  arrays_->add({"a"}, kSamples, "N");
  arrays_->add({"dt"}, {0.5});
  arrays_->add_text({"dt_unit"}, "ms");
  EXPECT_DOUBLE_EQ(read().sample_rate, 2000.0);
}

TEST_F(ArrayRecord, IsNotReadByAUnitOfAnotherDimension) {
  arrays_->add({"fs"}, {2.0}, "m");
  EXPECT_THAT(refusal(), testing::HasSubstr("the sample rate is not known; state sample_rate"));
  EXPECT_EQ(read({.sample_rate = 7.0}).sample_rate, 7.0);
}

TEST_F(ArrayRecord, IsRefusedWhereRateAndTimeContradictEachOther) {
  arrays_->add({"t"}, kInstants);
  arrays_->add({"fs"}, {2.02});
  EXPECT_THAT(refusal(), testing::HasSubstr("fs = 2.02 says 2.02 Hz, the instants of \"a\" say 2 "
                                            "Hz; correct one of them or state sample_rate"));
  EXPECT_EQ(read({.sample_rate = 2.0}).sample_rate, 2.0);
}

TEST_F(ArrayRecord, IsRefusedWhereTwoRatesContradictEachOther) {
  arrays_->add({"dt"}, {0.5});
  arrays_->add({"sample_rate"}, {4.0});
  EXPECT_THAT(refusal(), testing::HasSubstr("dt = 0.5 says 2 Hz, sample_rate = 4 says 4 Hz"));
  arrays_ = std::make_shared<Arrays>();
  arrays_->add({"a"}, kSamples, "N");
  arrays_->add({"t"}, kInstants);
  arrays_->add({"dt"}, {0.5000001});  // six digits
  EXPECT_NEAR(read().sample_rate, 2.0, 1e-6);
}

TEST_F(ArrayRecord, HasTheRateThatStandsNearest) {
  arrays_->add({"fs"}, {7.0});
  arrays_->add({"b", "a"}, kSamples, "N");
  arrays_->add({"b", "t"}, kInstants);
  EXPECT_EQ(read({.channels = {"a"}}).sample_rate, 7.0);
  EXPECT_EQ(read({.channels = {"b.a"}}).sample_rate, 2.0);
}

TEST_F(ArrayRecord, IsUnpacked) {
  arrays_->add({"fs"}, {2.0});
  arrays_->add({"a", "scale_factor"}, {0.5});
  arrays_->add({"a", "add_offset"}, {10.0});
  EXPECT_EQ(read().channels[0].samples, (std::vector<double>{10.5, 11.0, 11.5, 12.0}));
}

TEST_F(ArrayRecord, IsUnpackedByWhatStandsBesideIt) {
  arrays_ = std::make_shared<Arrays>();
  arrays_->add({"fs"}, {2.0});
  arrays_->add({"x", "data"}, kSamples, "N");
  arrays_->add({"x", "scale_factor"}, {0.5});
  arrays_->add({"y"}, kSamples);
  arrays_->add({"y_add_offset"}, {1.0});
  arrays_->add({"z"}, kSamples);
  arrays_->add_text({"z", "scale_factor"}, "2");
  const Recording found = read();
  EXPECT_EQ(found.channels[0].samples, (std::vector<double>{0.5, 1.0, 1.5, 2.0}));
  EXPECT_EQ(found.channels[1].samples, (std::vector<double>{2.0, 3.0, 4.0, 5.0}));
  EXPECT_EQ(found.channels[2].samples, (std::vector<double>{2.0, 4.0, 6.0, 8.0}));
}

// What stands beside numbers that are not stored as integers may be of anything.
TEST_F(ArrayRecord, AScaleBesideItIsOfIntegersAlone) {
  arrays_->add({"fs"}, {2.0});
  arrays_->add({"scale_factor"}, {0.01});
  const Recording found = read();
  EXPECT_EQ(found.channels[0].samples, kSamples);
  EXPECT_THAT(found.warnings,
              testing::ElementsAre(testing::HasSubstr(
                  "scale_factor stands beside a: it is not applied to numbers that are not "
                  "integers; where it is meant, call it a_scale_factor")));
  arrays_ = std::make_shared<Arrays>();
  arrays_->add_integers({"a"}, kSamples);
  arrays_->add({"fs"}, {2.0});
  arrays_->add({"scale_factor"}, {0.5});
  EXPECT_EQ(read().channels[0].samples, (std::vector<double>{0.5, 1.0, 1.5, 2.0}));
}

TEST_F(ArrayRecord, IsUnpackedColumnByColumn) {
  arrays_ = std::make_shared<Arrays>();
  arrays_->add({"fs"}, {2.0});
  arrays_->add_table({"d"}, {1.0, 10.0, 2.0, 20.0, 3.0, 30.0});
  arrays_->add({"d", "scale_factor"}, {2.0, 0.1});
  arrays_->add({"d", "add_offset"}, {0.0, 1.0});
  const Recording found = read();
  EXPECT_EQ(found.channels.at(0).samples, (std::vector<double>{2.0, 4.0, 6.0}));
  EXPECT_EQ(found.channels.at(1).samples, (std::vector<double>{2.0, 3.0, 4.0}));
}

// Numbers as they are stored would be wrong without a word.
TEST_F(ArrayRecord, IsLeftOutWhereItsScaleCannotBeTold) {
  const auto said_of = [this](const auto& add) {
    arrays_ = std::make_shared<Arrays>();
    arrays_->add({"fs"}, {2.0});
    arrays_->add({"a"}, kSamples, "N");
    arrays_->add({"g", "b"}, kSamples);
    add();
    const Recording found = read();
    EXPECT_EQ(found.channels.size(), 1u);
    return found.warnings.empty() ? std::string() : found.warnings.front();
  };
  EXPECT_THAT(
      said_of([this] {
        arrays_->add({"g", "b", "scale_factor"}, {0.0});
      }),
      testing::HasSubstr("\"g.b\" [] is left out: channel whose g.b.scale_factor = 0 cannot "
                         "be applied"));
  EXPECT_THAT(said_of([this] {
                arrays_->add_text({"g", "b", "scale_factor"}, "two");
              }),
              testing::HasSubstr("g.b.scale_factor = two cannot be applied"));
  EXPECT_THAT(said_of([this] {
                arrays_->add({"g", "b", "scale_factor"}, {1.0, 2.0, 3.0});
              }),
              testing::HasSubstr("3 values of g.b.scale_factor"));
  arrays_ = std::make_shared<Arrays>();
  arrays_->add({"fs"}, {2.0});
  arrays_->add_integers({"a"}, kSamples);
  arrays_->add_integers({"b"}, kSamples);
  arrays_->add({"scale_factor"}, {2.0});
  EXPECT_THAT(refusal(), testing::HasSubstr("no channel of it is a record in time: \"a\" is a "
                                            "channel beside others and one scale_factor"));
}

TEST_F(ArrayRecord, HasTheUnitOfAStructureThatItStandsInAlone) {
  arrays_->add({"fs"}, {2.0});
  arrays_->add({"F", "Data"}, kSamples);
  arrays_->add_text({"F", "Units"}, "mN");
  arrays_->add({"F", "dt"}, {0.5});
  arrays_->add_table({"d"}, {1.0, 10.0, 2.0, 20.0, 3.0, 30.0, 4.0, 40.0});
  arrays_->add_texts({"d", "units"}, {"N", "g "});
  const Recording found = read();
  ASSERT_EQ(found.channels.size(), 4u);
  EXPECT_EQ(found.channels[1].unit, "mN");
  EXPECT_EQ(found.channels[2].unit, "N");
  EXPECT_EQ(found.channels[3].unit, "g");
  EXPECT_THAT(found.warnings, testing::IsEmpty());
}

TEST_F(ArrayRecord, SaysWhichUnitsAreOfNobody) {
  arrays_->add({"fs"}, {2.0});
  arrays_->add({"b"}, kSamples);
  arrays_->add_texts({"units"}, {"mN", "g"});
  const Recording found = read();
  EXPECT_EQ(found.channels.at(1).unit, "");
  EXPECT_THAT(found.warnings,
              testing::ElementsAre(testing::HasSubstr("a.x: units (\"mN, g\") is not read")));
}

// The second of two channels begins later: it is left out, and refused where it is asked for.
TEST_F(ArrayRecord, BeginsAtOneInstant) {
  const auto expect_two_records = [this](const std::string& second) {
    const Recording found = read();
    EXPECT_EQ(found.channels.size(), 1u) << second;
    ASSERT_EQ(found.warnings.size(), 1u) << second;
    EXPECT_THAT(found.warnings[0],
                testing::HasSubstr("is left out: 4 samples at 2 Hz from 7.5 s on"));
    EXPECT_THAT(refusal_of([&] {
                  read({.channels = {found.channels[0].name, second}});
                }),
                testing::HasSubstr("one record needs one rate, one length and one beginning"));
    EXPECT_EQ(read({.channels = {second}}).start, 7.5) << second;
  };
  arrays_ = std::make_shared<Arrays>();
  for (const auto& [name, start] : {std::pair("A", 0.0), {"B", 7.5}}) {
    arrays_->add({name, "y"}, kSamples);
    arrays_->add({name, "time"}, {start, start + 0.5, start + 1.0, start + 1.5});
  }
  expect_two_records("B.y");
  for (const char* const word : {"t0", "X0", "start_time", "wf_start_offset"}) {
    arrays_ = std::make_shared<Arrays>();
    for (const auto& [name, start] : {std::pair("A", 0.0), {"B", 7.5}}) {
      arrays_->add({name}, kSamples);
      arrays_->add({name, "dt"}, {0.5});
      arrays_->add({name, word}, {start});
    }
    expect_two_records("B");
  }
  arrays_ = std::make_shared<Arrays>();
  for (const auto& [name, start] : {std::pair("A", 0.0), {"B", 7.5}}) {
    arrays_->add({name, "y"}, kSamples);
    arrays_->add({name, "x_values", "increment"}, {0.5});
    arrays_->add({name, "x_values", "start_value"}, {start});
  }
  expect_two_records("B.y");
}

TEST_F(ArrayRecord, IsRefusedWhereTwoTimesContradictEachOther) {
  arrays_->add({"t"}, kInstants);
  arrays_->add({"T"}, {0.0, 1.0, 2.0, 3.0});
  EXPECT_THAT(refusal(),
              testing::HasSubstr("sample 1 is at 0.5 s by t and at 1 s by T; correct one "
                                 "of them or state sample_rate"));
  EXPECT_EQ(read({.sample_rate = 2.0}).sample_rate, 2.0);
}

// T is a temperature or a tension where its unit says so.
TEST_F(ArrayRecord, AnotherQuantityCalledTIsNoTime) {
  for (const char* const unit : {"degC", "N"}) {
    arrays_ = std::make_shared<Arrays>();
    arrays_->add({"T"}, kSamples);
    arrays_->add_text({"T_unit"}, unit);
    arrays_->add({"t"}, kInstants);
    arrays_->add({"a"}, kSamples);
    const Recording found = read();
    EXPECT_EQ(found.sample_rate, 2.0) << unit;
    ASSERT_EQ(found.channels.size(), 2u) << unit;
    EXPECT_EQ(found.channels[0].unit, unit);
  }
}

TEST_F(ArrayRecord, HasATimeInCapitals) {
  arrays_->add({"TIME_S"}, kInstants);
  EXPECT_EQ(read().sample_rate, 2.0);
  arrays_ = std::make_shared<Arrays>();
  arrays_->add({"a"}, kSamples);
  arrays_->add({"T_MS"}, kInstants);
  EXPECT_DOUBLE_EQ(read().sample_rate, 2000.0);
}

TEST_F(ArrayRecord, BeginsAtOneInstantByARateThatIsStated) {
  arrays_ = std::make_shared<Arrays>();
  for (const auto& [name, start] : {std::pair("A", 0.0), {"B", 7.5}}) {
    arrays_->add({name, "y"}, kSamples);
    arrays_->add({name, "t0"}, {start});
  }
  EXPECT_EQ(read({.sample_rate = 2.0}).channels.size(), 1u);
  EXPECT_THAT(refusal(), testing::HasSubstr("the sample rate is not known"));
  EXPECT_EQ(read({.survey = true}).channels.size(), 1u);
}

TEST_F(ArrayRecord, BeginsAtNoPlaceAndNoDate) {
  arrays_->add({"fs"}, {2.0});
  arrays_->add({"x0"}, {0.35});
  EXPECT_EQ(read().start, 0.0);
  arrays_ = std::make_shared<Arrays>();
  for (const auto& [name, start] : {std::pair("A", 1.7e9), {"B", 1.7e9 + 7.5}}) {
    arrays_->add({name}, kSamples);
    arrays_->add({name, "dt"}, {0.5});
    arrays_->add({name, "t0"}, {start});
  }
  EXPECT_EQ(read().start, 0.0);
  EXPECT_EQ(read().channels.size(), 1u);
}

TEST_F(ArrayRecord, HasNoUnitOfAnotherThing) {
  for (const char* const text : {"s", "see the notes"}) {
    arrays_ = std::make_shared<Arrays>();
    arrays_->add({"y"}, kSamples);
    arrays_->add({"dt"}, {0.5});
    arrays_->add_text({"unit"}, text);
    const Recording found = read();
    EXPECT_EQ(found.channels[0].unit, "");
    EXPECT_THAT(found.warnings, testing::ElementsAre(testing::HasSubstr("is not read")));
  }
}

TEST_F(ArrayRecord, HasARateThatIsWrittenAsText) {
  arrays_->add_text({"fs"}, "2");
  EXPECT_EQ(read().sample_rate, 2.0);
  arrays_ = std::make_shared<Arrays>();
  arrays_->add({"a"}, kSamples);
  arrays_->add({"t_ms"}, kInstants);
  arrays_->add_text({"fs"}, "two");
  EXPECT_DOUBLE_EQ(read().sample_rate, 2000.0);
}

}  // namespace
}  // namespace modcal::array_record_test
