// Contact rows as forces on quadratic elements, for Newton's method.
//   P. Alart, A. Curnier, "A mixed formulation for frictional contact problems prone to Newton like
//   solution methods", Comput. Methods Appl. Mech. Eng. 92, 1991.
//
// A row's tissue point is y = Σ b_k x_k, its gap g = limit − n·y. With multipliers λ, λ_t and the
// penalty ε:
//   f = max(0, λ − ε g)                                 pressed apart along n [N]
//   t = λ_t + ε s, no longer than the bound             against the sliding s across n [N]
// on the tissue −(f n + t). ε is so stiff that one equilibrium hardly penetrates; the direct solver
// does not mind. The bound is the friction coefficient times f of the equilibrium before, as often
// as it takes to agree: with a given bound friction has a potential, and the tangent is symmetric.
#pragma once

#include <span>
#include <vector>

#include "deformation/contact/contact_solve.h"
#include "deformation/contact/element_contact.h"

namespace palpate::deformation {

class TaylorHoodContact : public ElementContact {
 public:
  /// The bound and friction · f differ by less than this part of the largest force there is.
  static constexpr double kFrictionTolerance = 1e-2;
  /// ε over the stiffness of the row's nodes with their neighbours held.
  static constexpr double kPenaltyFactor = 1e3;
  /// ε across n over ε along: softer, for Newton finds its way from sticking to sliding and back
  /// the worse the harder the kink. What sticks creeps back within a few steps, as λ_t takes over.
  static constexpr double kSlidingPenalty = 0.01;

  /// @param body, solid  outlive this; their nodes are the same
  TaylorHoodContact(const Body& body, const TaylorHoodElements& solid);

  /// Takes the rows of a step of h [s], which starts at these positions; the multipliers are their
  /// impulses / h.
  void take(std::span<const ContactRow> rows, double h, const std::vector<Vec3>& positions);
  /// Goes to the part of the step that ends at `time` and is `part` long [s].
  void begin_part(double time, double part, const std::vector<Vec3>& positions);
  /// Adds the part's impulses to the rows taken.
  void add_impulses(const SolidState& state, double part, std::span<ContactRow> rows) const;

  void add_residual(std::size_t element, const SolidState& state,
                    ElementVector& residual) const override;
  void add_tangent(std::size_t element, const SolidState& state, ElementMatrix& tangent,
                   bool positive) const override;
  double deepest(const SolidState& state) const override;
  bool is_settled(const SolidState& state) const override;
  void augment(const SolidState& state) override;

 private:
  struct Row {
    ContactRow given;
    std::size_t element = 0;
    std::array<Eigen::Index, 3> local{};  ///< its nodes in the element
    double penalty = 0;                   ///< ε [N/m]
    double start = 0;                     ///< n·y at the step's start [m]
    double limit = 0;                     ///< n·y at most [m]
    double full_limit = 0;      ///< … of one that yields, however slowly it may open [m]
    Vec3 stuck = Vec3::Zero();  ///< y if nothing slides [m]
    double multiplier = 0;      ///< λ [N]
    double bound = 0;           ///< of t [N]
    Vec3 friction_multiplier = Vec3::Zero();
  };
  struct Force {
    double gap = 0, normal = 0;  ///< g [m], f [N]
    double stiffness = 0;        ///< −df/dg; 0: it does not press [N/m]
    Vec3 trial = Vec3::Zero();   ///< λ_t + ε s [N]
  };

  void locate(Row& row) const;
  Vec3 point(const Row& row, const std::vector<Vec3>& positions) const;
  static void yield(const Row& row, double full_gap, Force& force);
  Force force(const Row& row, const std::vector<Vec3>& positions) const;

  const Body& body_;
  const TaylorHoodElements& solid_;
  std::vector<std::vector<std::size_t>> elements_of_node_;
  std::vector<Row> rows_;
  std::vector<std::vector<std::size_t>> rows_of_element_;
};

}  // namespace palpate::deformation
