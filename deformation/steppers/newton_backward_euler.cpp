#include "deformation/steppers/newton_backward_euler.h"

#include "modules/core/error.h"

namespace palpate::deformation {
std::vector<char> dirichlet_dofs(const Body& body) {
  std::vector<char> constrained;
  for (const double inverse : body.inverse_masses)
    constrained.insert(constrained.end(), 3, inverse == 0);
  return constrained;
}

Eigen::VectorXd corner_volumes(const QuadraticMesh& mesh) {
  Eigen::VectorXd volumes = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.corner_count));
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto& t = mesh.elements[e];
    const double volume = geometry::tetrahedron_volume(mesh.nodes[t[0]], mesh.nodes[t[1]],
                                                       mesh.nodes[t[2]], mesh.nodes[t[3]]);
    for (const auto corner : mesh.corners[e]) volumes[corner] += volume / 4;
  }
  return volumes;
}

TaylorHoodElements quadratic_solid(const OrganModel& model) {
  const TetMesh& solid = model.mesh();
  PALPATE_DEMAND(!solid.edge_nodes.empty());
  return {make_quadratic(model.rest_positions, solid.tetrahedra, solid.edge_nodes), solid.elastic(),
          solid.density};
}

NewtonBackwardEuler::NewtonBackwardEuler(const OrganModel& model)
    : model_(model),
      solid_(quadratic_solid(model)),
      contact_(model, solid_),
      solver_(solid_, dirichlet_dofs(model), &contact_),
      end_(solid_.rest_state()),
      corner_volumes_(corner_volumes(solid_.mesh())),
      predicted_(model.node_count()) {}

StepReport NewtonBackwardEuler::step(double h, std::span<ContactRow> rows, OrganState& state) {
  iterations_used_ = 0;
  InternalState& internal = state.internal;
  if (internal.positions == state.positions) {
    end_.pressures = internal.pressures;
  } else {
    end_.pressures.setZero(corner_volumes_.size());
  }
  contact_.take(rows, h, state.positions);
  for (int parts = 1; parts <= kMostParts && !gives_up(); parts *= 2) {
    if (advance(h, parts, rows, state)) return {};
  }
  for (ContactRow& row : rows) {
    row.normal_impulse = 0;
    row.tangential_impulse.setZero();
  }
  state.velocities.assign(model_.node_count(), Vec3::Zero());
  state.pressure = 0;
  internal = {};
  return {.volume_skipped = true};
}

/// @returns false, and leaves the state, if Newton fails in a part
bool NewtonBackwardEuler::advance(double h, int parts, std::span<ContactRow> rows,
                                  OrganState& state) {
  const double part = h / parts, slowing = 1 / (1 + part * model_.drag);
  for (ContactRow& row : rows) {
    row.normal_impulse = 0;
    row.tangential_impulse.setZero();
  }
  trial_.positions = state.positions;
  trial_.velocities = state.velocities;
  for (int k = 1; k <= parts; ++k) {
    contact_.begin_part(k * part, part, trial_.positions);
    for (std::size_t i = 0; i < predicted_.size(); ++i) {
      const bool constrained = model_.inverse_masses[i] == 0;
      const Vec3 velocity = trial_.velocities[i] + part * model_.gravity;
      predicted_[i] = trial_.positions[i];
      if (!constrained) predicted_[i] += part * slowing * velocity;
    }
    if (!solve({1 / (slowing * part * part), predicted_}, trial_.velocities, part)) return false;
    contact_.add_impulses(end_, part, rows);
    for (std::size_t i = 0; i < predicted_.size(); ++i) {
      trial_.velocities[i] = (end_.positions[i] - trial_.positions[i]) / part;
    }
    trial_.positions = end_.positions;
  }
  state.positions = trial_.positions;
  state.velocities = trial_.velocities;
  state.pressure = mean_pressure();
  state.internal.pressures = end_.pressures;
  state.internal.positions = state.positions;
  state.internal.velocities = state.velocities;
  return true;
}

/// From where the organ is, else from its free flight, else, as where it is inside out, from rest.
bool NewtonBackwardEuler::solve(const Inertia& inertia, const std::vector<Vec3>& velocities,
                                double h) {
  const Eigen::VectorXd pressures = end_.pressures;
  for (const int from : {0, 1, 2}) {
    if (gives_up()) break;
    end_ = from == 2 ? solid_.rest_state() : SolidState{trial_.positions, pressures};
    for (std::size_t i = 0; from == 1 && i < velocities.size(); ++i) {
      end_.positions[i] += h * velocities[i];
    }
    const auto report = solver_.solve(end_, inertia);
    iterations_used_ += report.iterations;
    if (report.converged) return true;
  }
  end_.pressures.setZero();
  return false;
}

/// Of the contents, positive under compression [Pa].
double NewtonBackwardEuler::mean_pressure() const {
  return -corner_volumes_.dot(end_.pressures) / corner_volumes_.sum();
}

double NewtonBackwardEuler::elastic_energy(const OrganState& state) {
  if (state.internal.positions == state.positions) {
    return solid_.energy({state.positions, state.internal.pressures});
  }
  return solid_.energy({state.positions, Eigen::VectorXd::Zero(corner_volumes_.size())});
}

}  // namespace palpate::deformation
