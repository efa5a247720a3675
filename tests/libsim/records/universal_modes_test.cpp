// Modes of universal files (datasets 55) against sums written down here, as other programs write
// them.
#include "libsim/records/universal/universal_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "libsim/base/turn.hpp"
#include "libsim/records/formats.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::universal_modes_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// The dataset of a normal mode (f, m, ζ, η) with real translations of the nodes 3 and 7.
std::string normal_mode(double frequency, double mass, double viscous, double hysteretic,
                        const std::array<double, 6>& shape) {
  std::string text = "    -1\n    55\nbracket\nNONE\nNONE\nNONE\nNONE\n";
  text += "         1         2         2         8         2         3\n";
  text += "         2         4         1         1\n";
  text += fmt::format("{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n", frequency, mass, viscous, hysteretic);
  for (std::size_t i = 0; i < 2; ++i) {
    text += fmt::format("{:10}\n{:13.5E}{:13.5E}{:13.5E}\n", i == 0 ? 3 : 7, shape[3 * i],
                        shape[3 * i + 1], shape[3 * i + 2]);
  }
  return text + "    -1\n";
}

std::string complex_mode(Complex root, Complex a, Complex at_3, Complex at_7) {
  std::string text = "    -1\n    55\nbracket\nNONE\nNONE\nNONE\nNONE\n";
  text += "         1         3         2         8         5         3\n";
  text += "         2         6         1         1\n";
  text += fmt::format("{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n", root.real(),
                      root.imag(), a.real(), a.imag(), 0.0, 0.0);
  for (const auto& [node, z] : {std::pair(3, at_3), std::pair(7, at_7)}) {
    text += fmt::format("{:10}\n{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n", node, 0.0, 0.0,
                        0.0, 0.0, z.real(), z.imag());
  }
  return text + "    -1\n";
}

const std::string kUnits =
    "    -1\n   164\n         5mm (milli-newton)           2\n"
    "  1.00000000000000000D+03  1.00000000000000000D+03  1.00000000000000000D+00\n"
    "  2.73149999999999977D+02\n    -1\n";

// H at s of modes as they are read, sensor 3 −z and contact 7 +x.
Complex response(const UniversalModes& read, SensorKind kind, const UniversalPlace& contact,
                 const UniversalPlace& sensor, Complex s) {
  Complex sum;
  const Complex own = std::pow(s, power_of_s(kind));
  for (const UniversalMode& mode : read.modes) {
    const Complex a = mode.constant(contact, sensor, kind);
    const Complex q = power_of_s(kind) == 0 ? s / mode.pole.omega : -mode.pole.omega / s;
    sum += own * (a.real() + a.imag() * q) / mode.pole.denominator(s);
  }
  return read.per_newton * sum;
}

class UniversalModesOf : public FolderTest {
 protected:
  std::string said_of(const std::string& content) const {
    return refusal_of([&] { read_universal_modes(write("a.unv", content)); });
  }
};

TEST_F(UniversalModesOf, NormalModesAreSumsOverShapesAndMasses) {
  const std::array<double, 6> one{0.5, 0.0, 2.0, -1.5, 0.0, 0.25}, two{1.0, 0.5, -3.0, 0.75, 1, 1};
  const auto file = write("a.unv", kUnits + normal_mode(60.0, 2.5, 0.01, 0.0, one) +
                                       normal_mode(130.0, 0.5, 0.0, 0.03, two));
  const UniversalModes read = read_universal_modes(file);
  ASSERT_EQ(read.modes.size(), 2u);
  for (const double frequency : {10.0, 60.0, 100.0, 131.0}) {
    const Complex s(0.0, kTurn * frequency);
    const auto mode = [&](double f, double m, double z, double product) {
      const double w = kTurn * f;
      return product / (m * (w * w + s * s + 2.0 * z * w * s));
    };
    // Sensor at node 3 against z, contact at node 7 along x; millimeters over millinewtons are SI.
    const Complex truth =
        s * s * (mode(60.0, 2.5, 0.01, -2.0 * -1.5) + mode(130.0, 0.5, 0.015, 3.0 * 0.75));
    const Complex found = response(read, SensorKind::kAcceleration, {.node = 7, .direction = 1},
                                   {.node = 3, .direction = -3}, s);
    EXPECT_LT(std::abs(found - truth), 1e-12 * std::abs(truth)) << frequency;
  }
}

TEST_F(UniversalModesOf, ComplexModesAreResidues) {
  const Complex root(-4.0, 375.0), a(0.0, 12.5), at_3(0.5, 0.125), at_7(-2.0, 0.75);
  // The conjugate says the same again.
  const auto file = write(
      "a.unv", complex_mode(root, a, at_3, at_7) +
                   complex_mode(std::conj(root), std::conj(a), std::conj(at_3), std::conj(at_7)));
  const UniversalModes read = read_universal_modes(file);
  ASSERT_EQ(read.modes.size(), 1u);
  EXPECT_EQ(read.per_newton, 1.0);
  const Complex r = at_3 * at_7 / a;
  const UniversalPlace contact{.node = 7, .direction = 3}, sensor{.node = 3, .direction = 3};
  for (const double omega : {50.0, 370.0, 375.0, 900.0}) {
    const Complex s(0.0, omega);
    const Complex truth = r / (s - root) + std::conj(r) / (s - std::conj(root));
    const Complex found = response(read, SensorKind::kDisplacement, contact, sensor, s);
    EXPECT_LT(std::abs(found - truth), 1e-12 * std::abs(truth)) << omega;
  }
  // Of a velocity and an acceleration the residues are λ and λ² times that.
  for (const SensorKind kind : {SensorKind::kVelocity, SensorKind::kAcceleration}) {
    const Complex near = root * (1.0 + 1e-9);
    const Complex residue = response(read, kind, contact, sensor, near) * (near - root);
    const Complex truth = r * std::pow(root, power_of_s(kind));
    EXPECT_LT(std::abs(residue - truth), 1e-5 * std::abs(truth));
  }
}

TEST_F(UniversalModesOf, WhatIsWrittenIsReadBackToItsSixDigits) {
  const ModalModel model{.poles = {{kTurn * 60.0, 0.01}, {kTurn * 130.0, 0.02}},
                         .sensors = {SensorKind::kAcceleration, SensorKind::kDisplacement},
                         .constants = {2.0, -1.5, 0.25, 0.125},
                         .quadrature = {0.3, 0.1, -0.2, 0.0}};
  const std::vector<std::string> names{"far\nend", "b"};
  const auto file = write("a.unv", universal_modes_text(model, names));
  const UniversalModes read = read_universal_modes(file);
  ASSERT_EQ(read.modes.size(), 2u);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_NEAR(read.modes[n].pole.omega, model.poles[n].omega, 1e-5 * model.poles[n].omega);
    EXPECT_NEAR(read.modes[n].pole.zeta, model.poles[n].zeta, 1e-5 * model.poles[n].zeta);
    for (int k = 0; k < 2; ++k) {
      const Complex a =
          read.modes[n].constant({.node = 3, .direction = 3}, {.node = k + 1, .direction = 3},
                                 model.sensors[static_cast<std::size_t>(k)]);
      const std::size_t i = 2 * static_cast<std::size_t>(k) + n;
      EXPECT_NEAR(a.real(), model.constants[i], 3e-5 * std::abs(a));
      EXPECT_NEAR(a.imag(), model.quadrature[i], 3e-5 * std::abs(a));
    }
  }
  // A record is read beside such datasets, which are none of it.
  EXPECT_THAT(refusal_of([&] { read_record(file, "auto"); }),
              HasSubstr("only datasets 55; a table of modes reads its shapes"));
}

TEST_F(UniversalModesOf, MistakesAreToldWithTheirPlace) {
  const std::array<double, 6> shape{0.5, 0.0, 2.0, -1.5, 0.0, 0.25};
  const std::string right = normal_mode(60.0, 2.5, 0.01, 0.0, shape);
  const std::string place = path("a.unv").string() + ":";
  const auto changed = [&](std::string_view from, std::string_view to) {
    std::string text = right;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return said_of(text.replace(at, from.size(), to));
  };
  EXPECT_EQ(said_of(right), "accepted");
  EXPECT_THAT(changed("         8         2", "        12         2"),
              StartsWith(place + "8: dataset 55: shapes of data type 12 are not read"));
  EXPECT_THAT(changed("  2.50000E+00", "  0.00000E+00"), HasSubstr("its modal mass is 0"));
  EXPECT_THAT(changed("  6.00000E+01", " -6.00000E+01"), HasSubstr("does not ring"));
  EXPECT_THAT(changed("         7\n", "         3\n"), HasSubstr("node 3 stands there twice"));
  EXPECT_THAT(changed("  2.50000E-01\n", "\n"),
              StartsWith(place + "14: dataset 55: a number is expected in column 27"));
  EXPECT_THAT(changed("         3\n  5", "         x\n  5"), HasSubstr("\"x\" in column 1"));
  EXPECT_THAT(changed("         1         2         2", "         1         1         2"),
              HasSubstr("no modes (dataset 55 of normal or complex modes) stand in it"));
  const UniversalMode mode = read_universal_modes(write("a.unv", right)).modes[0];
  const auto asked = [&](UniversalPlace contact, SensorKind kind) {
    return refusal_of([&] { mode.constant(contact, {.node = 3, .direction = 1}, kind); });
  };
  EXPECT_THAT(asked({.node = 4, .direction = 1}, SensorKind::kVelocity), HasSubstr("no node 4"));
  EXPECT_THAT(asked({.node = 3, .direction = 5}, SensorKind::kVelocity),
              HasSubstr("none in direction +5"));
  EXPECT_THAT(asked({.node = 3, .direction = 1}, SensorKind::kStrain), HasSubstr("no strain"));
}

TEST_F(UniversalModesOf, FilesCutOffAnywhereAreRefusedWithTheirPlace) {
  const std::string whole = kUnits + complex_mode({-4.0, 375.0}, {0.0, 12.5}, 1.0, -1.0);
  int accepted = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string said = said_of(whole.substr(0, size));
    accepted += said == "accepted" ? 1 : 0;
    EXPECT_TRUE(said == "accepted" || said.starts_with(path("a.unv").string())) << said;
  }
  // The line end behind the last -1.
  EXPECT_EQ(accepted, 1);
}

TEST_F(UniversalModesOf, ChangedBytesAreReadOrRefused) {
  const std::string whole = kUnits + complex_mode({-4.0, 375.0}, {0.0, 12.5}, 1.0, -1.0);
  std::mt19937 random(3);
  int refused = 0;
  for (int i = 0; i < 500; ++i) {
    std::string changed = whole;
    for (int k = 0; k < 3; ++k) changed[random() % whole.size()] = static_cast<char>(random());
    refused += said_of(changed) != "accepted" ? 1 : 0;
  }
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace modcal::universal_modes_test
