#include "deformation/contact/condensed_contacts.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "modules/core/tolerances.h"

namespace palpate::deformation {
namespace {

/// Nearer to its edge than this part of a triangle a contact is on the edge.
constexpr double kOnEdge = 1e-6;

/// The normal of a round probe turns as it slides over an edge or a node, not over a face.
double turning_radius(const CarriedContact& contact, double radius) {
  return contact.barycentric.minCoeff() > kOnEdge ? 0 : radius;
}

bool is_pushed(const CarriedContact& contact) {
  const double pushed = contact.pushed.norm();
  return pushed > 0 && std::isfinite(pushed);
}

/// A contact by itself. Thousands press on a plate: none has memory of its own.
struct SingleContact {
  const CarriedContact* from = nullptr;
  LawRow row;
  double order = 0;           ///< the least first
  double fixed_yielding = 0;  ///< as of a CondensedContact
  bool presses() const { return !row.force.isZero(0); }
};

using Bodies = std::vector<const Body*>;

/// Of a sum of pushes; where these cancel each other so far that friction outweighs them, that of
/// the force: no row pulls.
Vec3 normal_of(const Vec3& pushes, const Vec3& force) {
  const Vec3 normal = pushes.normalized();
  return normal.dot(force) < 0 ? force.normalized() : normal;
}

template <class F>
void for_each_weight(const CarriedContact& contact, const Body& body, const F& f) {
  for (int k = 0; k < 3; ++k) {
    const double weight = contact.barycentric[k];
    if (weight != 0) f(body.triangles[contact.triangle][static_cast<std::size_t>(k)], weight);
  }
}

SingleContact single_of(const CarriedContact& contact, const ProbeContacts& probe, const Body& body,
                        const OrganState& state, double period) {
  const double yielding = fixed_yielding(body, contact.triangle, contact.barycentric);
  SingleContact one{&contact, {}, 0, yielding / contact.fixed_share};
  one.row.radius = turning_radius(contact, probe.radius());
  Vec3 tissue = Vec3::Zero();
  for_each_weight(contact, body, [&](std::uint32_t node, double weight) {
    one.row.velocity += weight * state.velocities[node];
    tissue += weight * state.positions[node];
  });
  one.row.point_P = contact.point_P;
  if (is_pushed(contact)) {
    one.row.force = (contact.pushed + contact.dragged) / period;
    one.row.normal = normal_of(contact.pushed, one.row.force);
    return one;
  }
  one.row.normal = (probe.pose().rotation * contact.normal_P).stableNormalized();
  const Vec3 apart = probe.pose().to_world(contact.point_P) - tissue;
  one.row.gap = std::max(0.0, one.row.normal.dot(apart));
  return one;
}

CondensedContact condensed(const SingleContact& one, const Bodies& bodies) {
  CondensedContact contact{one.from->organ, one.row, {}, one.fixed_yielding};
  for_each_weight(*one.from, *bodies[one.from->organ], [&](std::uint32_t node, double weight) {
    contact.weights.push_back({node, weight});
  });
  return contact;
}

/// In their order(); of equal ones as they stand.
std::vector<std::uint32_t> sorted(const std::vector<SingleContact>& contacts) {
  std::vector<std::uint32_t> order(contacts.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return contacts[i].order; });
  return order;
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
void fill_up(std::vector<CondensedContact>& contacts, const std::vector<SingleContact>& with,
             const Bodies& bodies) {
  const std::size_t before = contacts.size();
  for (const std::uint32_t i : sorted(with)) {
    if (contacts.size() >= kMaxLawRows) return;
    CondensedContact contact = condensed(with[i], bodies);
    const std::span others(contacts.begin() + static_cast<std::ptrdiff_t>(before), contacts.end());
    const bool told = std::ranges::any_of(
        others, [&](const CondensedContact& c) { return are_one_place(c, contact); });
    if (!told) contacts.push_back(std::move(contact));
  }
}

/// Neighbours about places that are far from each other: the first, then always the one furthest
/// from those chosen.
class Groups {
 public:
  explicit Groups(Eigen::Index size)
      : x_(size),
        y_(size),
        z_(size),
        apart_(Numbers::Constant(size, std::numeric_limits<double>::infinity())),
        nearest_(apart_),
        organ_(size),
        group_(Eigen::ArrayXi::Constant(size, -1)) {}

  void put(Eigen::Index i, const Vec3& place, std::uint32_t organ) {
    x_[i] = place.x();
    y_[i] = place.y();
    z_[i] = place.z();
    organ_[i] = static_cast<int>(organ);
  }
  void find(int count) {
    Eigen::Index furthest = 0;
    for (int group = 0; group < count; ++group) {
      begin(group, furthest);
      const double most = apart_.maxCoeff();
      if (!(most > 0)) return;
      furthest = std::find(apart_.begin(), apart_.end(), most) - apart_.begin();
    }
  }
  /// Below 0: none is of its organ.
  int of(std::size_t i) const { return group_[static_cast<Eigen::Index>(i)]; }

 private:
  using Numbers = Eigen::ArrayXd;  // of one kind: what is done with them vectorizes

  void begin(int group, Eigen::Index at) {
    const double x = x_[at], y = y_[at], z = z_[at];
    squared_ = (x_ - x).square() + ((y_ - y).square() + (z_ - z).square());
    apart_ = apart_.min(squared_);
    for (Eigen::Index i = 0; i < squared_.size(); ++i) {
      if (!(squared_[i] < nearest_[i]) || organ_[i] != organ_[at]) continue;
      nearest_[i] = squared_[i];
      group_[i] = group;
    }
  }

  Numbers x_, y_, z_, squared_;
  Numbers apart_, nearest_;  ///< from any place chosen, and from those on the same organ [m²]
  Eigen::ArrayXi organ_, group_;
};

/// Several as one, weighted by their force along the normals.
class Merged {
 public:
  void add(const SingleContact& member, const Body& body) {
    const LawRow& row = member.row;
    if (weights_.empty()) first_ = row.normal;
    const double share = row.normal.dot(row.force);
    total_ += share;
    normal_ += share * row.normal;
    sum_.force += row.force;
    sum_.point_P += share * row.point_P;
    sum_.velocity += share * row.velocity;
    fixed_yielding_ += share * share * member.fixed_yielding;
    turning_ += row.radius > 0 ? share : 0;
    sum_.radius = std::max(sum_.radius, row.radius);
    for_each_weight(*member.from, body, [&](std::uint32_t node, double weight) {
      weights_.push_back({node, share * weight});
    });
    organ_ = member.from->organ;
  }
  bool empty() const { return weights_.empty(); }
  CondensedContact take() {
    sum_.normal = normal_of(normal_.norm() > 0 ? normal_ : first_, sum_.force);
    if (!(turning_ > total_ / 2)) sum_.radius = 0;
    sum_.point_P /= total_;
    sum_.velocity /= total_;
    for (auto& [node, weight] : weights_) weight /= total_;
    return {organ_, sum_, std::move(weights_), fixed_yielding_ / (total_ * total_)};
  }

 private:
  LawRow sum_;
  Vec3 normal_ = Vec3::Zero(), first_ = Vec3::Zero();
  double total_ = 0, turning_ = 0, fixed_yielding_ = 0;
  std::uint32_t organ_ = 0;
  std::vector<std::pair<std::uint32_t, double>> weights_;
};

std::vector<CondensedContact> take_together(const std::vector<SingleContact>& pressing,
                                            const std::vector<std::uint32_t>& order,
                                            const Bodies& bodies) {
  Groups groups(std::ssize(order));
  for (std::size_t k = 0; k < order.size(); ++k) {
    const SingleContact& one = pressing[order[k]];
    groups.put(static_cast<Eigen::Index>(k), one.row.point_P, one.from->organ);
  }
  groups.find(kMaxLawRows);
  std::array<Merged, kMaxLawRows> sums;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const SingleContact& member = pressing[order[k]];
    const int group = groups.of(k);
    if (group >= 0) sums[static_cast<std::size_t>(group)].add(member, *bodies[member.from->organ]);
  }
  std::vector<CondensedContact> result;
  for (Merged& sum : sums) {
    if (!sum.empty()) result.push_back(sum.take());
  }
  return result;
}

}  // namespace

std::vector<CondensedContact> condense_contacts(const ProbeContacts& probe, const Bodies& bodies,
                                                const std::vector<const OrganState*>& states,
                                                double period) {
  std::vector<SingleContact> pressing, near;
  // Of those near, those first that would be the first to press if probe and tissue went on.
  const auto take = [&](const CarriedContact& contact) {
    const Body& body = *bodies[contact.organ];
    SingleContact one = single_of(contact, probe, body, *states[contact.organ], period);
    const bool says = is_unit(one.row.normal) && std::isfinite(one.row.gap + one.fixed_yielding);
    if (!says) return;
    if (one.presses()) {
      one.order = -one.row.force.dot(one.row.normal);
      pressing.push_back(one);
    } else {
      one.order = one.row.gap + one.row.normal.dot(probe.went() - period * one.row.velocity);
      near.push_back(one);
    }
  };
  for (const CarriedContact& contact : probe.contacts()) {
    if (is_pushed(contact)) take(contact);
  }
  const std::vector<std::uint32_t> strongest = sorted(pressing);
  std::vector<CondensedContact> rows;
  if (pressing.size() > kMaxLawRows) {
    rows = take_together(pressing, strongest, bodies);
  } else {
    for (const std::uint32_t i : strongest) rows.push_back(condensed(pressing[i], bodies));
  }
  if (rows.size() >= kMaxLawRows) return rows;
  for (const CarriedContact& contact : probe.contacts()) {
    const bool says =
        contact.row != CarriedContact::kNoRow || contact.on_fixed || !contact.pushed.isZero(0);
    if (says && !is_pushed(contact)) take(contact);
  }
  fill_up(rows, near, bodies);
  return rows;
}

void append_compliance_rows(const CondensedContact& contact, std::size_t directions,
                            std::vector<ComplianceRow>& rows) {
  const Mat3 basis = contact_basis(contact.row.normal);
  for (std::size_t k = 0; k < directions; ++k) {
    const Vec3 axis = basis.col(static_cast<int>(k));
    rows.push_back({contact.weights, axis, axis.dot(contact.row.force)});
  }
}

}  // namespace palpate::deformation
