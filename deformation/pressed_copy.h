// What an organ resists to a probe that goes on, found by stepping a copy of both for one period:
// of models whose step no matrix tells.
//
// The other probes go on as they went. Forces at two ways of the probe, ± kOff beside where it
// goes, give the stiffness along the press. Nothing of the organ or of its steps is changed.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "deformation/contact/probe_contacts.h"
#include "deformation/contact/surface_walk.h"
#include "deformation/simulated_organ.h"
#include "modules/core/state_archive.h"

namespace palpate::deformation {

class PressedCopy {
 public:
  static constexpr double kOff = 2e-5;  ///< [m]

  /// @param every  advances between two measurements for a probe, ≥ 1
  explicit PressedCopy(int every) : every_(every) {}

  /// What was found for a probe in the last advances; none: it is to be measured.
  std::optional<double> kept(std::size_t probe) const;
  void keep(std::size_t probe, double scale);
  void note_advance() { ++advances_; }
  void forget() { kept_.clear(); }
  void exchange(StateArchive& archive) { archive(advances_, kept_); }

  /// @param organ   which of those that the probes touch
  /// @param into    unit, which way is pressed
  /// @param period  of an advance, above 0 [s]
  /// @returns −d(force)/dx along it, of the mean force over a period [N/m]; 0: it takes no contacts
  double stiffness(const SimulatedOrgan& simulated, SurfaceWalk& surface, std::uint32_t organ,
                   std::span<const ProbeContacts> probes, std::size_t pressed, const Vec3& into,
                   double period);

 private:
  /// Steps the copies, with the pressed probe further by this way.
  /// @returns the mean force on it [N]
  Vec3 force_after(const SimulatedOrgan& simulated, SurfaceWalk& surface, std::uint32_t organ,
                   std::span<const ProbeContacts> probes, std::size_t pressed, const Vec3& further,
                   double period);

  struct Kept {
    double scale = 1;
    int at = 0;  ///< advances there had been
    void exchange(StateArchive& archive) { archive(scale, at); }
  };
  int every_, advances_ = 0;
  std::vector<std::optional<Kept>> kept_;  ///< by probe, as far as there were any
  OrganState state_;
  std::vector<ProbeContacts> probes_;
  std::vector<ContactRow> rows_;
};

}  // namespace palpate::deformation
