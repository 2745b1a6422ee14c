// The tissue's force on a probe at tick rate: the small contact problem that a local law poses
// (LocalLaw, modules/core/touch.h), solved at the device's own pose by projected Gauss–Seidel on
// its rows, from the forces of the tick before. Rows open and close, stick and slide between two
// laws as they would in deformation; their wrench is that of the rows' own places on the probe.
#pragma once

#include <array>

#include "haptics/wrench.h"
#include "modules/core/state_archive.h"
#include "modules/core/touch.h"

namespace palpate::haptics {

/// Every number finite and within its bounds; of W each diagonal entry > 0 and no entry larger than
/// its two diagonal ones allow, which projected Gauss–Seidel needs to be bounded.
bool is_usable(const LocalLaw& law);

struct LawForce {
  Wrench wrench;
  Vec3 pressing = Vec3::Zero();  ///< what of the force is along the rows' normals [N]
  bool beyond_validity = false;  ///< evaluated at the validity radius instead of at the probe
  int sweeps = 0;                ///< of Gauss–Seidel
};

/// One law, and the forces of its rows where it was evaluated last. Never allocates.
class LawSolver {
 public:
  static constexpr int kMaxSweeps = 40;
  static constexpr double kForceTolerance = 1e-6;  ///< largest change in the last sweep [N]

  /// Starts from the law's own forces.
  /// @param law        is_usable()
  /// @param softening  what every row gives way by beside W, to the change of the force since the
  ///                   anchor, ≥ 0 [m/N]: the force at the anchor stays the tissue's own
  void take(const LocalLaw& law, double softening = 0);
  void clear() { directions_ = 0; }  ///< no law: no force

  /// @param pose          of the device, finite
  /// @param since_anchor  time since the anchor's pose, ≥ 0 [s]
  LawForce evaluate(const Pose& pose, double since_anchor);

  /// ½ λᵀW λ at the last evaluation: what the rows' springs could return [J].
  double stored_energy() const;

  void exchange(StateArchive& archive);

 private:
  static constexpr int kMost = 3 * static_cast<int>(kMaxLawRows);
  using Numbers = std::array<double, kMost>;

  struct Row {
    Vec3 point_P;  ///< of the surface; of a round probe of its core
    Vec3 tissue;   ///< at the anchor [m]
    Vec3 velocity;
    double radius;
    Mat3 basis;  ///< n, t, s now
    void exchange(StateArchive& archive) { archive(point_P, tissue, velocity, radius, basis); }
  };

  void soften(double by);
  void place_rows(const Pose& pose, double time, bool& beyond_validity);
  Vec3 axis(int direction) const;
  double sweep();
  double relax_friction(int first);
  void change(int direction, double by);

  Pose anchor_;
  double longest_ = 0, growth_ = 0, half_period_ = 0, friction_ = 0, validity_radius_ = 0;
  int directions_ = 0, per_row_ = 1;  ///< of all rows, of one
  std::array<Row, kMaxLawRows> rows_;
  std::array<Numbers, kMost> compliance_;       ///< W, softened
  Numbers anchor_forces_, forces_, distances_;  ///< λ⁰, λ, s
};

}  // namespace palpate::haptics
