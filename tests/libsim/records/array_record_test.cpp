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
  void add_text(const std::vector<std::string>& path, const std::string& text) {
    arrays_.push_back(
        {.path = path, .dims = {1, 1}, .holds = NamedArray::Holds::kText, .place = arrays_.size()});
    texts_[arrays_.size() - 1] = text;
  }
  std::vector<double> column(const NamedArray& array, std::size_t) override {
    return values_.at(array.place);
  }
  std::string text(const NamedArray& array) override { return texts_.at(array.place); }

 private:
  std::map<std::size_t, std::vector<double>> values_;
  std::map<std::size_t, std::string> texts_;
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

}  // namespace
}  // namespace modcal::array_record_test
