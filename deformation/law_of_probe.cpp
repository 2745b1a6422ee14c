#include "deformation/law_of_probe.h"

#include <algorithm>
#include <utility>

#include "deformation/contact/contact_law.h"

namespace palpate::deformation {
namespace {

/// The law is believed within this part of the mean edge: the touched nodes stay the same.
constexpr double kValidityOfEdge = 0.5;

/// W of the contacts, organ by organ; organs do not answer each other. Lower triangle.
std::vector<double> compliance_of(std::span<WorldOrgan> organs,
                                  const std::vector<CondensedContact>& contacts,
                                  std::size_t directions, double period) {
  const std::size_t size = directions * contacts.size();
  std::vector<double> lower(size * (size + 1) / 2, 0.0);
  for (std::uint32_t i = 0; i < organs.size(); ++i) {
    std::vector<ComplianceRow> rows;
    std::vector<std::size_t> places;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if (contacts[c].organ != i) continue;
      append_compliance_rows(contacts[c], directions, rows);
      for (std::size_t k = 0; k < directions; ++k) places.push_back(directions * c + k);
    }
    if (rows.empty()) continue;
    const Eigen::MatrixXd W = organs[i].contact_compliance(rows, period);
    for (std::size_t a = 0; a < places.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const auto [low, high] = std::minmax(places[a], places[b]);
        lower[high * (high + 1) / 2 + low] =
            W(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
      }
    }
  }
  return lower;
}

}  // namespace

LocalLaw law_of_probe(std::span<WorldOrgan> organs, const ProbeContacts& probe, double period,
                      bool* bounded) {
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
    law.validity_radius = std::max(
        law.validity_radius, contact.row.gap + kValidityOfEdge * organs[contact.organ].mean_edge);
  }
  law.compliance = compliance_of(organs, contacts, law.directions(), period);
  const RowStiffness stiffness = stiffness_of(law);
  law.stiffness = stiffness.matrix;
  if (bounded != nullptr) *bounded = stiffness.bounded;
  return law;
}

}  // namespace palpate::deformation
