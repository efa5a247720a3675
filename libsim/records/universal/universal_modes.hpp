// Modes in universal files: shapes at nodes, datasets 55.
#pragma once

#include <map>

#include "libsim/model/modal_model.hpp"
#include "libsim/records/universal/universal_file.hpp"

namespace modcal {

/// Whether a sensor reads what shapes tell.
bool is_motion(SensorKind kind);

/// A translation of a node: direction ±1, ±2, ±3 for x, y, z.
struct UniversalPlace {
  int node = 0, direction = 0;
};

/// A normal mode, H = Σ φ_k φ_c/(m D), or a complex one, H = Σ φ_k φ_c/(a (s − λ)) and its
/// conjugate, H the displacement over the force in the units of the file.
struct UniversalMode {
  ModalPole pole;  ///< ζ = 0: not stated
  bool is_normal = true;
  Complex scale = 1.0;                         ///< modal mass m, or modal A
  std::map<int, std::vector<Complex>> shapes;  ///< values of every node, in the order of directions
  std::size_t line = 0;                        ///< where its dataset begins

  /// The modal constant (ModalModel) from a contact to a sensor. Throws InvalidInput for a node or
  /// a direction that it has not, and a sensor that does not read a motion.
  Complex constant(const UniversalPlace& contact, const UniversalPlace& sensor,
                   SensorKind kind) const;
};

struct UniversalModes {
  std::vector<UniversalMode> modes;
  double per_newton = 1.0;  ///< SI displacement over force for one in the units of the file
};

/// Its normal and complex modes; of a conjugate pair the pole above the real axis, other results at
/// nodes are passed over. Throws InvalidInput with line and dataset, and for a file without modes.
UniversalModes read_universal_modes(const std::filesystem::path& path);

/// Complex modes of displacements in SI units, one dataset 55 each: sensor k stands at node k + 1,
/// the contact at node K + 1, all in direction +3. Six digits of each number; static terms and
/// deviations have no place there. Throws InvalidInput for a sensor that does not read a motion.
std::string universal_modes_text(const ModalModel& model, std::span<const std::string> names);

}  // namespace modcal
