#include "deformation/contact/contact_law.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/core/tolerances.h"

namespace palpate::deformation {
namespace {

/// A row whose friction is nearer to its cone than this slides.
constexpr double kSlidingFraction = 0.99;

bool slides(const LawRow& row, double friction) {
  const double pressing = row.normal.dot(row.force);
  const Vec3 dragging = row.force - pressing * row.normal;
  return dragging.norm() >= kSlidingFraction * friction * pressing;
}

bool presses(const CondensedContact& contact) { return !contact.row.force.isZero(0); }

CondensedContact one_of(const CarriedContact& contact, const Pose& probe, const Body& body,
                        const OrganState& state, double radius, double period) {
  CondensedContact one;
  one.organ = contact.organ;
  one.row.radius = radius;
  Vec3 tissue = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const double weight = contact.barycentric[k];
    if (weight == 0) continue;
    const std::uint32_t node = body.triangles[contact.triangle][static_cast<std::size_t>(k)];
    one.weights.push_back({node, weight});
    one.row.velocity += weight * state.velocities[node];
    tissue += weight * state.positions[node];
  }
  one.row.point_P = contact.point_P;
  const double pushed = contact.pushed.norm();
  if (pushed > 0 && std::isfinite(pushed)) {
    one.row.normal = contact.pushed / pushed;
    one.row.force = (contact.pushed + contact.dragged) / period;
    return one;
  }
  one.row.normal = (probe.rotation * contact.normal_P).stableNormalized();
  one.row.gap = std::max(0.0, one.row.normal.dot(probe.to_world(contact.point_P) - tissue));
  return one;
}

/// Places of contacts that are far from each other: the one that presses most, then always the one
/// furthest from those chosen.
std::vector<std::size_t> spread(const std::vector<CondensedContact>& contacts, std::size_t count) {
  std::vector<std::size_t> chosen{0};
  std::vector<double> distances(contacts.size(), std::numeric_limits<double>::infinity());
  while (chosen.size() < count) {
    std::size_t furthest = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Vec3 apart = contacts[i].row.point_P - contacts[chosen.back()].row.point_P;
      distances[i] = std::min(distances[i], apart.squaredNorm());
      if (distances[i] > distances[furthest]) furthest = i;
    }
    if (!(distances[furthest] > 0)) break;
    chosen.push_back(furthest);
  }
  return chosen;
}

/// Weighted by their force along the normals.
CondensedContact merged(const std::vector<const CondensedContact*>& members) {
  CondensedContact sum;
  sum.organ = members.front()->organ;
  sum.row.radius = members.front()->row.radius;
  Vec3 normal = Vec3::Zero();
  double total = 0;
  for (const CondensedContact* member : members) {
    const double share = member->row.normal.dot(member->row.force);
    total += share;
    normal += share * member->row.normal;
    sum.row.force += member->row.force;
    sum.row.point_P += share * member->row.point_P;
    sum.row.velocity += share * member->row.velocity;
    for (const auto& [node, weight] : member->weights) {
      sum.weights.push_back({node, share * weight});
    }
  }
  sum.row.normal = normal.norm() > 0 ? normal.normalized() : members.front()->row.normal;
  sum.row.point_P /= total;
  sum.row.velocity /= total;
  for (auto& [node, weight] : sum.weights) weight /= total;
  return sum;
}

std::vector<CondensedContact> take_together(const std::vector<CondensedContact>& pressing) {
  const std::vector<std::size_t> seeds = spread(pressing, kMaxLawRows);
  std::vector<std::vector<const CondensedContact*>> groups(seeds.size());
  for (const CondensedContact& contact : pressing) {
    std::size_t nearest = seeds.size();
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < seeds.size(); ++s) {
      const CondensedContact& seed = pressing[seeds[s]];
      const double distance = (contact.row.point_P - seed.row.point_P).squaredNorm();
      if (seed.organ != contact.organ || distance >= best) continue;
      nearest = s;
      best = distance;
    }
    if (nearest < seeds.size()) groups[nearest].push_back(&contact);
  }
  std::vector<CondensedContact> result;
  for (const auto& group : groups) {
    if (!group.empty()) result.push_back(merged(group));
  }
  return result;
}

}  // namespace

std::vector<CondensedContact> condense_contacts(const ProbeContacts& probe,
                                                const std::vector<const Body*>& bodies,
                                                const std::vector<const OrganState*>& states,
                                                double period) {
  std::vector<CondensedContact> pressing, near;
  for (const CarriedContact& contact : probe.contacts()) {
    if (contact.row == CarriedContact::kNoRow && contact.pushed.isZero(0)) continue;
    CondensedContact one = one_of(contact, probe.pose(), *bodies[contact.organ],
                                  *states[contact.organ], probe.radius(), period);
    const bool held = std::ranges::all_of(one.weights, [&](const auto& w) {
      return bodies[contact.organ]->inverse_masses[w.first] == 0;
    });
    if (!is_unit(one.row.normal) || !std::isfinite(one.row.gap)) continue;  // says nothing
    if (held && !presses(one)) continue;
    (presses(one) ? pressing : near).push_back(std::move(one));
  }
  std::ranges::stable_sort(pressing, std::greater{},
                           [](const CondensedContact& c) { return c.row.force.dot(c.row.normal); });
  std::ranges::stable_sort(near, std::less{}, [](const CondensedContact& c) { return c.row.gap; });
  if (pressing.size() > kMaxLawRows) pressing = take_together(pressing);
  for (std::size_t i = 0; i < near.size() && pressing.size() < kMaxLawRows; ++i) {
    pressing.push_back(std::move(near[i]));
  }
  return pressing;
}

void append_compliance_rows(const CondensedContact& contact, std::size_t directions,
                            std::vector<ComplianceRow>& rows) {
  const Mat3 basis = contact_basis(contact.row.normal);
  for (std::size_t k = 0; k < directions; ++k) {
    rows.push_back({contact.weights, basis.col(static_cast<int>(k))});
  }
}

Mat3 stiffness_of(const LocalLaw& law) {
  const std::size_t per_row = law.directions();
  const auto size = static_cast<Eigen::Index>(per_row * law.rows.size());
  // W; a row's place moves along axes; a force of 1 along a free direction, in all directions.
  Eigen::MatrixXd W(size, size), axes(size, 3), forces = Eigen::MatrixXd::Zero(size, size);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < size; ++i) {
    const LawRow& row = law.rows[static_cast<std::size_t>(i) / per_row];
    const Eigen::Index k = i % static_cast<Eigen::Index>(per_row);
    const Mat3 basis = contact_basis(row.normal);
    axes.row(i) = basis.col(k);
    for (Eigen::Index j = 0; j <= i; ++j) {
      W(i, j) = W(j, i) = law.compliance[static_cast<std::size_t>(i * (i + 1) / 2 + j)];
    }
    const bool sliding = slides(row, law.friction_coefficient);
    if (row.force.isZero(0) || (k > 0 && sliding)) continue;
    const auto column = static_cast<Eigen::Index>(free.size());
    forces(i, column) = 1;
    for (Eigen::Index t = 1; sliding && t < static_cast<Eigen::Index>(per_row); ++t) {
      forces(i + t, column) = basis.col(t).dot(row.force) / basis.col(0).dot(row.force);
    }
    free.push_back(i);
  }
  if (free.empty()) return Mat3::Zero();
  forces.conservativeResize(size, static_cast<Eigen::Index>(free.size()));
  // Rows on the same nodes depend on each other: what they share is counted once.
  constexpr double kRegular = 1e-6;
  Eigen::MatrixXd answers = (W * forces)(free, Eigen::all);
  answers.diagonal() *= 1 + kRegular;
  const Eigen::MatrixXd motion = axes(free, Eigen::all);
  Mat3 stiffness = axes.transpose() * forces * answers.partialPivLu().solve(motion);
  // The forces on a round probe turn as it slides over the tissue.
  for (const LawRow& row : law.rows) {
    if (row.radius == 0 || !slides(row, law.friction_coefficient)) continue;
    const double force = row.normal.dot(row.force);
    stiffness -= force / row.radius * (Mat3::Identity() - row.normal * row.normal.transpose());
  }
  if (!stiffness.allFinite()) return Mat3::Zero();  // of a bad state's W
  return 0.5 * (stiffness + stiffness.transpose());
}

}  // namespace palpate::deformation
