#include "deformation/contact/contact_law.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

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

/// Nearer to its edge than this part of a triangle a contact is on the edge.
constexpr double kOnEdge = 1e-6;

/// The normal of a round probe turns as it slides over an edge or a node, not over a face.
double turning_radius(const CarriedContact& contact, double radius) {
  return contact.barycentric.minCoeff() > kOnEdge ? 0 : radius;
}

bool presses(const CondensedContact& contact) { return !contact.row.force.isZero(0); }

bool is_pushed(const CarriedContact& contact) {
  const double pushed = contact.pushed.norm();
  return pushed > 0 && std::isfinite(pushed);
}

CondensedContact one_of(const CarriedContact& contact, const Pose& probe, const Body& body,
                        const OrganState& state, double radius, double period) {
  CondensedContact one;
  one.organ = contact.organ;
  one.row.radius = turning_radius(contact, radius);
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
  if (is_pushed(contact)) {
    one.row.normal = contact.pushed / contact.pushed.norm();
    one.row.force = (contact.pushed + contact.dragged) / period;
    return one;
  }
  one.row.normal = (probe.rotation * contact.normal_P).stableNormalized();
  one.row.gap = std::max(0.0, one.row.normal.dot(probe.to_world(contact.point_P) - tissue));
  return one;
}

/// Triangles that share a node or an edge have one contact each where it is touched.
bool are_one_place(const CondensedContact& a, const CondensedContact& b) {
  constexpr double kSameWeight = 1e-9;
  if (a.organ != b.organ) return false;
  double apart = 0;
  for (const auto& [node, weight] : a.weights) {
    double other = 0;
    for (const auto& [at, own] : b.weights) other += at == node ? own : 0;
    apart = std::max(apart, std::abs(weight - other));
  }
  return apart < kSameWeight;
}

/// Appends contacts, each place once, until there are kMaxLawRows.
void fill_up(std::vector<CondensedContact>& contacts, std::vector<CondensedContact>& with) {
  const std::size_t before = contacts.size();
  for (CondensedContact& contact : with) {
    if (contacts.size() >= kMaxLawRows) return;
    const std::span others(contacts.begin() + static_cast<std::ptrdiff_t>(before), contacts.end());
    const bool told = std::ranges::any_of(
        others, [&](const CondensedContact& c) { return are_one_place(c, contact); });
    if (!told) contacts.push_back(std::move(contact));
  }
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
  Vec3 normal = Vec3::Zero();
  double total = 0, turning = 0, radius = 0;
  for (const CondensedContact* member : members) {
    const double share = member->row.normal.dot(member->row.force);
    total += share;
    normal += share * member->row.normal;
    sum.row.force += member->row.force;
    sum.row.point_P += share * member->row.point_P;
    sum.row.velocity += share * member->row.velocity;
    turning += member->row.radius > 0 ? share : 0;
    radius = std::max(radius, member->row.radius);
    for (const auto& [node, weight] : member->weights) {
      sum.weights.push_back({node, share * weight});
    }
  }
  sum.row.normal = normal.norm() > 0 ? normal.normalized() : members.front()->row.normal;
  sum.row.radius = turning > total / 2 ? radius : 0;
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
  const auto take = [&](const CarriedContact& contact) {
    CondensedContact one = one_of(contact, probe.pose(), *bodies[contact.organ],
                                  *states[contact.organ], probe.radius(), period);
    const bool held = std::ranges::all_of(one.weights, [&](const auto& w) {
      return bodies[contact.organ]->inverse_masses[w.first] == 0;
    });
    if (!is_unit(one.row.normal) || !std::isfinite(one.row.gap)) return;  // says nothing
    if (held && !presses(one)) return;
    (presses(one) ? pressing : near).push_back(std::move(one));
  };
  for (const CarriedContact& contact : probe.contacts()) {
    if (is_pushed(contact)) take(contact);
  }
  std::ranges::stable_sort(pressing, std::greater{},
                           [](const CondensedContact& c) { return c.row.force.dot(c.row.normal); });
  if (pressing.size() > kMaxLawRows) pressing = take_together(pressing);
  if (pressing.size() >= kMaxLawRows) return pressing;
  for (const CarriedContact& contact : probe.contacts()) {
    const bool says = contact.row != CarriedContact::kNoRow || !contact.pushed.isZero(0);
    if (says && !is_pushed(contact)) take(contact);
  }
  // Those first that would be the first to press if probe and tissue went on.
  const auto gap_ahead = [&](const CondensedContact& c) {
    return c.row.gap + c.row.normal.dot(probe.went() - period * c.row.velocity);
  };
  std::ranges::stable_sort(near, std::less{}, gap_ahead);
  fill_up(pressing, near);
  return pressing;
}

void append_compliance_rows(const CondensedContact& contact, std::size_t directions,
                            std::vector<ComplianceRow>& rows) {
  const Mat3 basis = contact_basis(contact.row.normal);
  for (std::size_t k = 0; k < directions; ++k) {
    const Vec3 axis = basis.col(static_cast<int>(k));
    rows.push_back({contact.weights, axis, axis.dot(contact.row.force)});
  }
}

namespace {

/// Rows on the same nodes depend on each other: what they share is counted once.
constexpr double kRegular = 1e-6;
/// Two ways to the same stiffness differ by less, where W is no more regular than that.
constexpr double kRounding = 1 + 1e-3;

/// A law's rows in the plain form of linear algebra.
struct LawMatrices {
  Eigen::MatrixXd compliance;           ///< W  (directions, directions)
  Eigen::MatrixXd axes;                 ///< how a row's place moves  (directions, 3)
  std::vector<Eigen::Index> pressing;   ///< directions of the rows that press
  std::vector<Eigen::Index> unlimited;  ///< of these, whose force the friction cone leaves free
  Eigen::MatrixXd forces;  ///< in all directions, of 1 N in an unlimited one  (directions, count)
};

LawMatrices matrices_of(const LocalLaw& law) {
  const std::size_t per_row = law.directions();
  const auto size = static_cast<Eigen::Index>(per_row * law.rows.size());
  LawMatrices m{Eigen::MatrixXd(size, size),
                Eigen::MatrixXd(size, 3),
                {},
                {},
                Eigen::MatrixXd::Zero(size, size)};
  for (Eigen::Index i = 0; i < size; ++i) {
    const LawRow& row = law.rows[static_cast<std::size_t>(i) / per_row];
    const Eigen::Index k = i % static_cast<Eigen::Index>(per_row);
    const Mat3 basis = contact_basis(row.normal);
    m.axes.row(i) = basis.col(k);
    for (Eigen::Index j = 0; j <= i; ++j) {
      m.compliance(i, j) = m.compliance(j, i) =
          law.compliance[static_cast<std::size_t>(i * (i + 1) / 2 + j)];
    }
    if (row.force.isZero(0)) continue;
    m.pressing.push_back(i);
    const bool sliding = slides(row, law.friction_coefficient);
    if (k > 0 && sliding) continue;
    const auto column = static_cast<Eigen::Index>(m.unlimited.size());
    m.forces(i, column) = 1;
    for (Eigen::Index t = 1; sliding && t < static_cast<Eigen::Index>(per_row); ++t) {
      m.forces(i + t, column) = basis.col(t).dot(row.force) / basis.col(0).dot(row.force);
    }
    m.unlimited.push_back(i);
  }
  m.forces.conservativeResize(size, static_cast<Eigen::Index>(m.unlimited.size()));
  return m;
}

/// With every row that presses held within its cone; zero where W is not regular.
Mat3 sticking_stiffness(const LawMatrices& m) {
  Eigen::MatrixXd own = m.compliance(m.pressing, m.pressing);
  own.diagonal() *= 1 + kRegular;
  const Eigen::MatrixXd motion = m.axes(m.pressing, Eigen::all);
  const Eigen::LLT<Eigen::MatrixXd> factor(own);
  if (factor.info() != Eigen::Success) return Mat3::Zero();
  return motion.transpose() * factor.solve(motion);
}

/// With those on their cone sliding; their friction makes it unsymmetric.
Mat3 sliding_stiffness(const LawMatrices& m) {
  Eigen::MatrixXd answers = (m.compliance * m.forces)(m.unlimited, Eigen::all);
  answers.diagonal() *= 1 + kRegular;
  const Eigen::MatrixXd motion = m.axes(m.unlimited, Eigen::all);
  return m.axes.transpose() * m.forces * answers.partialPivLu().solve(motion);
}

}  // namespace

// Pressed by d, a row that sticks answers with forces of W⁻¹. Does its friction need less than μ
// times what its normal force grows by, it sticks whatever friction it had; and only there would
// sliding, which adds all of μ, be the stiffer: one row gives 1/(W_nn + μ W_nd) against
// 1/(W_nn − W_nd²/W_dd). So no force along a normal grows faster than that of rows that stick, and
// none falls as it is pressed: a row alone gives a k n (n + μ d)ᵀ, no less than −μ k/2 either way.
RowStiffness stiffness_of(const LocalLaw& law) {
  const LawMatrices m = matrices_of(law);
  if (m.pressing.empty()) return {};
  const Mat3 sticking = sticking_stiffness(m);
  // Of a bad state's W.
  if (!sticking.allFinite() || sticking.isZero(0)) return {Mat3::Zero(), true};
  if (m.unlimited.size() == m.pressing.size()) return {sticking, false};
  Mat3 stiffness = sliding_stiffness(m);
  const double most = kRounding * std::hypot(1, law.friction_coefficient) * sticking.operatorNorm();
  if (!stiffness.allFinite() || stiffness.operatorNorm() > most) return {sticking, true};
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(0.5 * (stiffness + stiffness.transpose()),
                                                   Eigen::EigenvaluesOnly);
  if (solver.eigenvalues()[0] < -0.5 * law.friction_coefficient * most) return {sticking, true};
  // The forces on a round probe turn as it slides over the tissue.
  for (const LawRow& row : law.rows) {
    if (row.radius == 0 || !slides(row, law.friction_coefficient)) continue;
    const double force = row.normal.dot(row.force);
    stiffness -= force / row.radius * (Mat3::Identity() - row.normal * row.normal.transpose());
  }
  return {0.5 * (stiffness + stiffness.transpose()), false};
}

}  // namespace palpate::deformation
