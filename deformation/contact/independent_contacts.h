// Contacts that meet only through the volume: each without friction on one node of its own, as
// plates touch. Given σ each has its impulse at once,
//     j(σ) = max(0, (u − σ c)/m),   u = n·v̂ − allowed approach, c = n·W g, m = n·W n,
// and σ is the root of a falling, piecewise linear function of one unknown,
//     F(σ) = rate + g·v̂ − Σ c j(σ) − gᵀWg σ,
// found by Newton's method: the impulses and the volume together are exact, in no sweeps.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "deformation/contact/contact_inverse_mass.h"

namespace palpate::deformation {

template <class InverseMass>
class IndependentContacts {
 public:
  /// @returns none if the rows are not independent
  static std::optional<IndependentContacts> take(const InverseMass& inverse_mass,
                                                 const VolumeRow* volume, double h,
                                                 std::span<const ContactRow> rows,
                                                 const std::vector<Vec3>& velocities,
                                                 WarmStart start) {
    std::vector<std::uint8_t> seen(inverse_mass.node_count(), 0);
    for (const ContactRow& row : rows) {
      const int only = only_node(row);
      if (only < 0 || row.friction > 0 || seen[row.nodes[only]]++ > 0) return {};
    }
    IndependentContacts contacts;
    contacts.contacts_.reserve(rows.size());
    for (const ContactRow& row : rows)
      contacts.add(inverse_mass, volume, h, row, velocities, start);
    return contacts;
  }

  /// Finds σ. @param volume_velocity  g·v̂ [m³/s]
  /// @returns the σ that meets the volume exactly with the impulses apply() will set [Pa·s]
  double solve_volume(const VolumeRow& volume, double volume_velocity) {
    const double denominator = volume.at.denominator;
    const double total = volume.rate + volume_velocity + started_;
    double largest_coupling = 0;
    for (const Contact& c : contacts_) {
      largest_coupling = std::max(largest_coupling, std::abs(c.coupling));
    }
    sigma_ = total / denominator;
    for (steps_ = 1;; ++steps_) {
      double taken = 0, slope = denominator;
      for (const Contact& c : contacts_) {
        const double pressing = std::max(c.approach - sigma_ * c.coupling, 0.0);
        taken += c.impulse_coupling * pressing;
        slope -= pressing > 0 ? c.impulse_coupling * c.coupling : 0;
      }
      // After some steps the full slope, which is safe and slow.
      if (steps_ > kNewtonSteps) slope = denominator;
      const double exact = (total - taken) / denominator;
      const double change =
          denominator * (exact - sigma_) / std::max(slope, kLeastSlope * denominator);
      if (std::abs(change) * largest_coupling <= kContactVelocityTolerance || steps_ == kMaxSteps)
        return exact;
      sigma_ += change;
    }
  }

  /// Sets the rows' impulses, what is not finite among them too, and adds them to the velocities.
  void apply(const InverseMass& inverse_mass, WarmStart start, std::span<ContactRow> rows,
             std::vector<Vec3>& velocities) const {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Contact& c = contacts_[r];
      ContactRow& row = rows[r];
      const double last = start == WarmStart::kToApply ? 0 : row.normal_impulse;
      const double pressing = std::max(c.approach - sigma_ * c.coupling, 0.0);
      row.normal_impulse = c.inverse_mass > 0 ? pressing / c.inverse_mass : 0;
      row.tangential_impulse.setZero();
      if (row.normal_impulse == last) continue;
      velocities[c.node] += inverse_mass.apply(c.node, (last - row.normal_impulse) * row.normal);
    }
  }

  int steps() const { return steps_; }

 private:
  static constexpr int kMaxSteps = 60, kNewtonSteps = 10;
  static constexpr double kLeastSlope = 0.05;  ///< of gᵀWg: contacts that hold nearly all of it

  struct Contact {
    double approach = 0;          ///< u, without the impulses brought [m/s]
    double coupling = 0;          ///< c [m²/kg]
    double impulse_coupling = 0;  ///< c/m [m²]
    double inverse_mass = 0;      ///< m, effective [1/kg]
    std::uint32_t node = 0;
  };

  void add(const InverseMass& inverse_mass, const VolumeRow* volume, double h,
           const ContactRow& row, const std::vector<Vec3>& velocities, WarmStart start) {
    Contact contact;
    contact.node = row.nodes[only_node(row)];
    const Vec3 answer = inverse_mass.apply(contact.node, row.normal);
    contact.inverse_mass = row.normal.dot(answer);
    contact.approach =
        row.normal.dot(velocities[contact.node] - row.probe_velocity) - allowed_approach(row, h);
    if (volume != nullptr) contact.coupling = answer.dot(volume->at.gradient[contact.node]);
    if (contact.inverse_mass > 0)
      contact.impulse_coupling = contact.coupling / contact.inverse_mass;
    if (start != WarmStart::kToApply) {
      contact.approach += contact.inverse_mass * row.normal_impulse;
      started_ += contact.coupling * row.normal_impulse;
    }
    contacts_.push_back(contact);
  }

  std::vector<Contact> contacts_;
  double sigma_ = 0;    ///< [Pa·s]
  double started_ = 0;  ///< what the impulses brought took from g·v̂ [m³/s]
  int steps_ = 0;
};

}  // namespace palpate::deformation
