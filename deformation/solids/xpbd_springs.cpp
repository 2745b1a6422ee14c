#include "deformation/solids/xpbd_springs.h"

#include <algorithm>
#include <optional>

#include "deformation/contact_solve.h"
#include "deformation/spring_forces.h"

namespace palpate::deformation {

void free_flight(const OrganModel& model, double h, const OrganState& state,
                 std::vector<Vec3>& positions) {
  positions = state.positions;
  const double reach = h / (1 + h * model.drag);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (model.inverse_masses[i] == 0) continue;
    positions[i] += reach * (state.velocities[i] + h * model.gravity);
  }
}

XpbdSprings::XpbdSprings(const OrganModel& model, int iterations)
    : model_(model), iterations_(iterations), visits_(visits_of(model)) {}

/// The springs from node to node, so that memory is passed through once, but put off while one of
/// the last few visits moved a node of theirs: a processor works on several visits at a time unless
/// one needs what another has yet to find. Some four times as fast as family by family.
std::vector<XpbdSprings::Visit> XpbdSprings::visits_of(const OrganModel& model) {
  constexpr std::ptrdiff_t kApart = 6;
  constexpr std::size_t kPutOff = 256;
  const auto& springs = model.network.springs;
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const auto a = springs[s].node_a, b = springs[s].node_b;
    const bool moves = model.inverse_masses[a] + model.inverse_masses[b] > 0;
    if (moves && springs[s].stiffness > 0) order.push_back(s);
  }
  std::ranges::stable_sort(
      order, {}, [&](std::size_t s) { return std::min(springs[s].node_a, springs[s].node_b); });

  std::vector<Visit> visits;
  std::vector<std::ptrdiff_t> last_visit(model.node_count(), -kApart - 1);
  const auto is_apart = [&](std::size_t s) {
    const auto latest = std::max(last_visit[springs[s].node_a], last_visit[springs[s].node_b]);
    return static_cast<std::ptrdiff_t>(visits.size()) - latest > kApart;
  };
  std::vector<std::size_t> waiting;
  for (auto next = order.begin(); next != order.end() || !waiting.empty();) {
    while (next != order.end() && waiting.size() < kPutOff) waiting.push_back(*next++);
    auto chosen = std::ranges::find_if(waiting, is_apart);
    if (chosen == waiting.end()) chosen = waiting.begin();
    const Spring& spring = springs[*chosen];
    last_visit[spring.node_a] = last_visit[spring.node_b] = std::ssize(visits);
    visits.push_back({spring.node_a, spring.node_b, spring.rest_length, 1 / spring.stiffness,
                      model.spring_damping[*chosen] / spring.stiffness});
    waiting.erase(chosen);
  }
  return visits;
}

StepReport XpbdSprings::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. where all would fly alone; 2. springs
  free_flight(model_, h, state, positions_);
  for (int k = 0; k < iterations_; ++k) visit_springs(h, state.positions, k == 0);

  // 3. volume, as it would be there, and contacts
  const double per_h = 1 / h;
  velocities_.resize(positions_.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    velocities_[i] = per_h * (positions_[i] - state.positions[i]);
  }
  std::optional<VolumeRow> row;
  if (model_.preserve_volume) {
    evaluate_volume(model_, positions_, volume_);
    double rate = (volume_.volume - state.target_volume) / h;
    for (std::size_t i = 0; i < volume_.gradient.size(); ++i) {
      rate -= volume_.gradient[i].dot(velocities_[i]);
    }
    row.emplace(VolumeRow{volume_, rate});
  }
  const auto report = solve_contacts_and_volume(model_, row ? &*row : nullptr, h, rows, velocities_,
                                                StartImpulses::kToApply);

  // 4. the new state
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    state.velocities[i] = velocities_[i];
    state.positions[i] += h * velocities_[i];
  }
  state.pressure = -report.volume_impulse / h;
  return {report.volume_skipped};
}

void XpbdSprings::visit_springs(double h, const std::vector<Vec3>& start, bool first) {
  // One root and one division a visit. The tiny square lets a spring without length pull at
  // nothing.
  constexpr double kTinySquare = 1e-60;  // [m²]
  const double per_h = 1 / h;
  for (Visit& visit : visits_) {
    const auto a = visit.node_a, b = visit.node_b;
    const double w_a = model_.inverse_masses[a], w_b = model_.inverse_masses[b];
    const Vec3 arm = positions_[b] - positions_[a];
    const double square = arm.squaredNorm() + kTinySquare, length = std::sqrt(square);
    const double closing = square - arm.dot(start[b] - start[a]);  // times the length
    const double compliance = visit.flexibility * per_h * per_h;
    const double damping = visit.damping_time * per_h;
    const double carried = first ? 0 : visit.multiplier;
    const double pull =
        ((length - visit.rest_length + compliance * carried) * length + damping * closing) /
        (square * ((1 + damping) * (w_a + w_b) + compliance));
    visit.multiplier = carried - pull * length;
    positions_[a] += (w_a * pull) * arm;
    positions_[b] -= (w_b * pull) * arm;
  }
}

double XpbdSprings::elastic_energy(const OrganState& state) {
  return deformation::elastic_energy(model_, state.positions);
}

}  // namespace palpate::deformation
