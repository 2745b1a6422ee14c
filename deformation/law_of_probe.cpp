#include "deformation/law_of_probe.h"

#include <algorithm>
#include <utility>

#include "deformation/contact/closing_rows.h"
#include "deformation/contact/condensed_contacts.h"
#include "deformation/contact/contact_law.h"
#include "deformation/force_error.h"

namespace palpate::deformation {
namespace {

/// The law is believed within this part of the mean edge: the touched nodes stay the same.
constexpr double kValidityOfEdge = 0.5;
/// A copy that resists so many times as much, or as little, is not believed further.
constexpr double kMostScale = 100;
constexpr double kNoForce = 1e-6;   ///< of all rows: this part of it is rounding
constexpr double kTouching = 1e-9;  ///< a force that is none, for its direction [N]

/// Lower triangle, row by row.
std::vector<double> lower_of(const Eigen::MatrixXd& W) {
  std::vector<double> lower;
  for (Eigen::Index i = 0; i < W.rows(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) lower.push_back(W(i, j));
  }
  return lower;
}

/// Of the probes, the one whose law it is.
struct Pressed {
  std::span<const ProbeContacts> probes;
  std::size_t index;
  double period;
  const ProbeContacts& probe() const { return probes[index]; }
};

/// Which way a probe presses: where it goes, if that is against the force more than across it, else
/// straight against the force.
Vec3 press_direction(const Vec3& went, const Vec3& force) {
  const Vec3 against = -force.normalized();
  const double along = went.dot(against);
  return along > 0 && 2 * along * along > went.squaredNorm() ? went.normalized() : against;
}

/// What W of an organ's rows is to be multiplied by so that they resist a press as a copy of the
/// organ does; 1 where that tells nothing. Rows that close if probe and tissue go on press, too.
double press_scale(WorldOrgan& organ, std::uint32_t index, const Pressed& pressed, LocalLaw rows) {
  const Vec3& went = pressed.probe().went();
  const double least = kNoForce * rows.force().norm();
  for (LawRow& row : rows.rows) {
    if (row.force.norm() > least) continue;
    const double ahead = row.gap + row.normal.dot(went - pressed.period * row.velocity);
    row.force = ahead < 0 ? Vec3(kTouching * row.normal) : Vec3::Zero();
  }
  const Vec3 force = rows.force();
  if (force.isZero(0)) return 1;
  if (const auto kept = organ.copy->kept(pressed.index)) return *kept;
  const Vec3 into = press_direction(went, force);
  const double found = organ.copy->stiffness(organ.simulated, *organ.surface, index, pressed.probes,
                                             pressed.index, into, pressed.period);
  const double told = into.dot(stiffness_of(rows).matrix * into);
  if (!(found > 0 && told > 0)) return 1;
  const double scale = std::clamp(told / found, 1 / kMostScale, kMostScale);
  if (least > 0) organ.copy->keep(pressed.index, scale);  // as it closes is not as it presses
  return scale;
}

/// The contacts on one organ.
struct OwnRows {
  std::vector<ComplianceRow> directions;
  std::vector<std::size_t> places;     ///< of these, in W of all contacts
  std::vector<double> fixed_yielding;  ///< of these [m/N]
  LocalLaw law;                        ///< the rows alone
};

OwnRows rows_on(std::uint32_t organ, const std::vector<CondensedContact>& contacts,
                double friction) {
  OwnRows own;
  own.law.friction_coefficient = friction;
  const std::size_t directions = own.law.directions();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (contacts[c].organ != organ) continue;
    append_compliance_rows(contacts[c], directions, own.directions);
    own.law.rows.push_back(contacts[c].row);
    for (std::size_t k = 0; k < directions; ++k) {
      own.places.push_back(directions * c + k);
      own.fixed_yielding.push_back(contacts[c].fixed_yielding);
    }
  }
  return own;
}

Eigen::MatrixXd own_compliance(WorldOrgan& organ, std::uint32_t index, const Pressed& pressed,
                               OwnRows& own) {
  Eigen::MatrixXd W = organ.contact_compliance(own.directions, pressed.period);
  const int steps = organ.simulated.substeps(pressed.period);
  std::vector<double> stiffer;
  for (std::size_t r = 0; r < own.law.rows.size(); ++r) {
    const LawRow& row = own.law.rows[r];
    const bool fixed = own.fixed_yielding[r * own.law.directions()] > 0;
    stiffer.push_back(
        fixed ? 1 : stiffer_by_closing(row, pressed.probe().went(), pressed.period, steps));
  }
  const auto fixed = Eigen::VectorXd::Map(own.fixed_yielding.data(), W.rows());
  W.diagonal() += fixed;
  stiffen_closing_rows(stiffer, W);
  if (!organ.copy) return W;
  own.law.compliance = lower_of(W);
  const double scale = press_scale(organ, index, pressed, own.law);
  W *= scale;
  W.diagonal() += (1 - scale) * fixed;  // what is fixed is known
  return W;
}

/// W of the contacts, organ by organ; organs do not answer each other. Lower triangle.
std::vector<double> compliance_of(std::span<WorldOrgan> organs,
                                  const std::vector<CondensedContact>& contacts,
                                  std::size_t directions, const Pressed& pressed) {
  const std::size_t size = directions * contacts.size();
  std::vector<double> lower(size * (size + 1) / 2, 0.0);
  for (std::uint32_t i = 0; i < organs.size(); ++i) {
    OwnRows own = rows_on(i, contacts, pressed.probe().friction());
    if (own.directions.empty()) continue;
    const Eigen::MatrixXd W = own_compliance(organs[i], i, pressed, own);
    for (std::size_t a = 0; a < own.places.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const auto [low, high] = std::minmax(own.places[a], own.places[b]);
        lower[high * (high + 1) / 2 + low] =
            W(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
      }
    }
  }
  return lower;
}

/// Where tissue is pushed out gently its motion is not stopped, but brought to that of the push
/// within GentlePush::kRise: of the forces that would stop it, a period sees this part.
double stopped_in(double period) { return std::min(1.0, period / GentlePush::kRise); }

}  // namespace

LocalLaw law_of_probe(std::span<WorldOrgan> organs, std::span<const ProbeContacts> probes,
                      std::size_t index, double period, bool* bounded) {
  const Pressed pressed{probes, index, period};
  const ProbeContacts& probe = pressed.probe();
  LocalLaw law;
  law.anchor = probe.pose();
  law.period = period;
  law.friction_coefficient = probe.friction();
  if (!(period > 0)) return law;

  std::vector<const Body*> bodies;
  std::vector<const OrganState*> states;
  for (const WorldOrgan& organ : organs) {
    bodies.push_back(&organ.simulated.model());
    states.push_back(&organ.simulated.state());
  }
  const auto contacts = condense_contacts(probe, bodies, states, period);
  for (const CondensedContact& contact : contacts) {
    law.rows.push_back(contact.row);
    if (probe.is_gentle(contact.organ)) law.rows.back().velocity *= stopped_in(period);
    law.validity_radius = std::max(
        law.validity_radius, contact.row.gap + kValidityOfEdge * organs[contact.organ].mean_edge);
  }
  law.compliance = compliance_of(organs, contacts, law.directions(), pressed);
  const RowStiffness stiffness = stiffness_of(law);
  law.stiffness = stiffness.matrix;
  if (bounded != nullptr) *bounded = stiffness.bounded;
  return law;
}

double force_error_of_probe(std::span<const WorldOrgan> organs, const ProbeContacts& probe) {
  double worst = 0;
  for (std::uint32_t i = 0; i < organs.size(); ++i) {
    if (!organs[i].tells_mesh_error) continue;
    const SimulatedOrgan& organ = organs[i].simulated;
    const TouchedPart part = touched_part(probe, i, organ.model());
    if (!(part.reach > 0)) continue;
    worst = std::max(worst, estimated_force_error(organ.model(), organ.state().positions, part));
  }
  return worst;
}

LocalLaw without_rows(const LocalLaw& law) {
  LocalLaw bare;
  bare.anchor = law.anchor;
  bare.period = law.period;
  bare.friction_coefficient = law.friction_coefficient;
  return bare;
}

}  // namespace palpate::deformation
