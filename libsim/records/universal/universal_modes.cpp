#include "libsim/records/universal/universal_modes.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/records/universal/columns.hpp"

namespace modcal {
namespace {

enum Analysis : int { kNormalMode = 2, kComplexMode = 3 };
enum ModeData : int { kNotTold = 0, kDisplacement = 8 };
enum DataType : int { kReal = 2, kComplex = 5 };
constexpr std::size_t kNumbersOnLine = 6, kNumberWidth = 13;

// One dataset 55 from behind its number on.
class ModeReader {
 public:
  ModeReader(LineFile& file, FilePlace place) : file_(file), begin_(place.line - 1) {
    file_.go_to(place);
  }

  // Nothing: a result of another kind, or the conjugate of a mode.
  std::optional<UniversalMode> read() {
    for (int i = 0; i < 5; ++i) line();
    const Columns form = line();
    const int analysis = form.small(10, 10);
    if (analysis != kNormalMode && analysis != kComplexMode) return std::nullopt;
    const int specific = form.small(30, 10), type = form.small(40, 10);
    MODCAL_REQUIRE(specific == kNotTold || specific == kDisplacement,
                   "{}: shapes of data type {} are not read: the scale of shapes other than of "
                   "displacements (8) is not told; write them as displacements",
                   where(), specific);
    MODCAL_REQUIRE(type == kReal || type == kComplex,
                   "{}: values of type {} are not read; 2 and 5 are possible", where(), type);
    const long long values = form.whole(50, 10);
    MODCAL_REQUIRE(values >= 1 && values <= 6,
                   "{}: {} values a node are announced, 1 to 6 possible", where(), values);
    UniversalMode mode{.is_normal = analysis == kNormalMode, .line = begin_};
    if (!read_pole(mode)) return std::nullopt;
    read_shapes(mode, static_cast<std::size_t>(values), type == kComplex);
    return mode;
  }

 private:
  std::string where() const {
    return fmt::format("{}:{}: dataset 55", file_.name(), file_.place().line - 1);
  }
  std::string raw() {
    std::string text;
    MODCAL_REQUIRE(file_.next(text), "{}: the file ends at byte {}; it was cut off", where(),
                   file_.size());
    return text;
  }
  Columns line() {
    const std::string text = raw();
    MODCAL_REQUIRE(!is_delimiter(text), "{}: it ends too early", where());
    return {text, where()};
  }
  std::vector<double> numbers(std::size_t count) {
    std::vector<double> result;
    while (result.size() < count) {
      const Columns own = line();
      for (std::size_t i = 0; i < kNumbersOnLine && result.size() < count; ++i) {
        result.push_back(own.stated_number(kNumberWidth * i, kNumberWidth));
      }
    }
    return result;
  }

  bool read_pole(UniversalMode& mode) {
    const Columns counts = line();
    const long long whole = counts.whole(0, 10), real = counts.whole(10, 10);
    const std::size_t least = mode.is_normal ? 4 : 6;
    MODCAL_REQUIRE(whole >= 0 && whole <= 6 && real >= static_cast<long long>(least) && real <= 100,
                   "{}: {} whole and {} real numbers are announced for a mode of {} real ones",
                   where(), whole, real, least);
    const std::vector<double> told = numbers(static_cast<std::size_t>(real));
    const Complex eigenvalue(told[0], told[1]);
    if (mode.is_normal) {
      // A loss factor η is 2 ζ at the resonance.
      mode.pole = {2.0 * std::numbers::pi * told[0], told[2] > 0.0 ? told[2] : 0.5 * told[3]};
      mode.scale = told[1];
    } else {
      mode.pole = {std::abs(eigenvalue), -eigenvalue.real() / std::abs(eigenvalue)};
      mode.scale = {told[2], told[3]};
      if (eigenvalue.imag() < 0.0) return false;
    }
    MODCAL_REQUIRE(mode.pole.omega > 0.0 && mode.pole.zeta >= 0.0 && mode.pole.zeta < 1.0,
                   "{}: a mode at {:g} Hz with damping ratio {:g} does not ring", where(),
                   mode.pole.omega / (2.0 * std::numbers::pi), mode.pole.zeta);
    MODCAL_REQUIRE(std::abs(mode.scale) > 0.0,
                   "{}: its modal {} is 0: shapes without a scale tell no force", where(),
                   mode.is_normal ? "mass" : "A");
    return true;
  }

  void read_shapes(UniversalMode& mode, std::size_t values, bool is_complex) {
    for (std::string text = raw(); !is_delimiter(text); text = raw()) {
      const int node = Columns(text, where()).small(0, 10);
      MODCAL_REQUIRE(node > 0, "{}: the number of a node is expected", where());
      const std::vector<double> told = numbers(values * (is_complex ? 2 : 1));
      std::vector<Complex> shape;
      for (std::size_t i = 0; i < values; ++i) {
        shape.push_back(is_complex ? Complex(told[2 * i], told[2 * i + 1]) : Complex(told[i]));
      }
      MODCAL_REQUIRE(mode.shapes.emplace(node, std::move(shape)).second,
                     "{}: node {} stands there twice", where(), node);
    }
  }

  LineFile& file_;
  std::size_t begin_;
};

Complex shape_at(const UniversalMode& mode, const UniversalPlace& place) {
  const auto found = mode.shapes.find(place.node);
  MODCAL_REQUIRE(found != mode.shapes.end(), "the mode at line {} has no node {}, of {} from {} on",
                 mode.line, place.node, mode.shapes.size(),
                 mode.shapes.empty() ? 0 : mode.shapes.begin()->first);
  const auto axis = static_cast<std::size_t>(std::abs(place.direction));
  MODCAL_REQUIRE(axis >= 1 && axis <= found->second.size(),
                 "the mode at line {} has {} values at node {}, none in direction {:+d}", mode.line,
                 found->second.size(), place.node, place.direction);
  return found->second[axis - 1] * (place.direction < 0 ? -1.0 : 1.0);
}

void require_motion(SensorKind kind) {
  MODCAL_REQUIRE(is_motion(kind), "shapes tell what sensors of {} read, no force and no strain",
                 "displacement, velocity and acceleration");
}

Complex upper_root(const ModalPole& pole) {
  return pole.omega * Complex(-pole.zeta, std::sqrt((1.0 - pole.zeta) * (1.0 + pole.zeta)));
}

// q(λ) of ModalModel.
Complex turned_at_root(SensorKind kind, const ModalPole& pole) {
  const Complex root = upper_root(pole);
  return power_of_s(kind) == 0 ? root / pole.omega : -pole.omega / root;
}

}  // namespace

bool is_motion(SensorKind kind) {
  return kind != SensorKind::kForce && kind != SensorKind::kStrain;
}

Complex UniversalMode::constant(const UniversalPlace& contact, const UniversalPlace& sensor,
                                SensorKind kind) const {
  require_motion(kind);
  const Complex product = shape_at(*this, contact) * shape_at(*this, sensor) / scale;
  if (is_normal) return product;
  // A general residue r: Re A + Im A q(λ) = r (λ − conj λ).
  const Complex numerator = product * Complex(0.0, 2.0 * upper_root(pole).imag());
  const Complex turned = turned_at_root(kind, pole);
  const double quadrature = numerator.imag() / turned.imag();
  return {numerator.real() - quadrature * turned.real(), quadrature};
}

UniversalModes read_universal_modes(const std::filesystem::path& path) {
  const UniversalFile headers = read_universal_headers(path);
  UniversalModes result;
  if (headers.units) result.per_newton = headers.units->factors[1] / headers.units->factors[0];
  LineFile file(path);
  for (const FilePlace& place : headers.shapes) {
    if (auto mode = ModeReader(file, place).read()) result.modes.push_back(*std::move(mode));
  }
  MODCAL_REQUIRE(!result.modes.empty(),
                 "{}: no modes (dataset 55 of normal or complex modes) stand in it, of {} datasets "
                 "55",
                 path.string(), headers.shapes.size());
  return result;
}

std::string universal_modes_text(const ModalModel& model, std::span<const std::string> names) {
  // SI.
  std::string text = fmt::format("    -1\n   164\n{:10}{:20}{:10}\n", 1, "m, N, s", 2);
  text += fmt::format("{0:25.17E}{0:25.17E}{0:25.17E}\n{1:25.17E}\n    -1\n", 1.0, 273.15);
  const std::size_t sensors = model.sensors.size(), modes = model.poles.size();
  std::string all = fmt::format("nodes from 1 on: {}", fmt::join(names, ", "));
  std::ranges::replace_if(
      all, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  for (std::size_t n = 0; n < modes; ++n) {
    const Complex root = upper_root(model.poles[n]);
    text += fmt::format("    -1\n    55\nmode {} of {}\n{:.80}\nforce at node {} +3\nNONE\nNONE\n",
                        n + 1, modes, all, sensors + 1);
    text += fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n", 1, static_cast<int>(kComplexMode), 2,
                        static_cast<int>(kDisplacement), static_cast<int>(kComplex), 3);
    text += fmt::format("{:10}{:10}{:10}{:10}\n", 2, 6, 1, n + 1);
    // Modal B = −λ A.
    text += fmt::format("{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n", root.real(),
                        root.imag(), 1.0, 0.0, -root.real(), -root.imag());
    for (std::size_t k = 0; k <= sensors; ++k) {
      Complex shape = 1.0;
      if (k < sensors) {
        require_motion(model.sensors[k]);
        const std::size_t i = k * modes + n;
        shape = (model.constants[i] + (model.quadrature.empty() ? 0.0 : model.quadrature[i]) *
                                          turned_at_root(model.sensors[k], model.poles[n])) /
                Complex(0.0, 2.0 * root.imag());
      }
      text += fmt::format("{:10}\n{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n", k + 1, 0.0,
                          0.0, 0.0, 0.0, shape.real(), shape.imag());
    }
    text += "    -1\n";
  }
  return text;
}

}  // namespace modcal
