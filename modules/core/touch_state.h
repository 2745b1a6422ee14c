// What a touch is made of, in a StateArchive.
#pragma once

#include "modules/core/state_archive.h"
#include "modules/core/touch.h"

namespace palpate {

inline void exchange_state(StateArchive& archive, Contact& contact) {
  archive(contact.organ, contact.triangle, contact.barycentric, contact.point_P, contact.normal_P,
          contact.gap);
}
inline void exchange_state(StateArchive& archive, LawRow& row) {
  archive(row.point_P, row.normal, row.gap, row.radius, row.force, row.velocity);
}
inline void exchange_state(StateArchive& archive, LocalLaw& law) {
  archive(law.anchor, law.anchor_age, law.period, law.growth, law.friction_coefficient,
          law.validity_radius, law.rows, law.compliance, law.stiffness);
}

}  // namespace palpate
