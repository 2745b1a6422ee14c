// The touched patch of one organ condensed to the rows of a local law (LocalLaw, core/touch.h).
#pragma once

#include <utility>
#include <vector>

#include "deformation/contact/compliance_row.h"
#include "deformation/contact/probe_contacts.h"

namespace palpate::deformation {

/// A contact, or several as one: their forces keep their proportions.
struct CondensedContact {
  std::uint32_t organ = 0;
  LawRow row;
  std::vector<std::pair<std::uint32_t, double>> weights;  ///< of the organ's nodes
  double fixed_yielding = 0;  ///< how far what is fixed gives way to 1 N any way [m/N]
};

/// All contacts of a probe at the end of an advance, at most kMaxLawRows: those that press, then
/// the nearest others. Where more than that press, neighbours are taken together about places far
/// from each other, each group with the sum of its forces at their middle. The radius of a row is 0
/// for a flat probe, and for a round one on a triangle's face: sliding there, it finds the same
/// normal. Of several taken together it is that of most of the force.
/// @param bodies, states  by organ
std::vector<CondensedContact> condense_contacts(const ProbeContacts& probe,
                                                const std::vector<const Body*>& bodies,
                                                const std::vector<const OrganState*>& states,
                                                double period);

/// Appends the compliance rows of a condensed contact: along its normal, or the columns of
/// contact_basis().
void append_compliance_rows(const CondensedContact& contact, std::size_t directions,
                            std::vector<ComplianceRow>& rows);

}  // namespace palpate::deformation
