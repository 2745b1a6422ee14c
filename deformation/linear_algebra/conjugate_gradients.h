// Preconditioned conjugate gradients for a symmetric positive definite A x = b, whatever its
// vectors and the constraints it is solved under.
//   M. Hestenes, E. Stiefel, J. Res. Natl. Bur. Stand. 49, 1952.
#pragma once

#include <algorithm>

namespace palpate::deformation {

struct ConjugateGradientsReport {
  int iterations = 0;
  bool converged = false;
};

/// Stops when r·z ≤ negligible, with z = P r the preconditioned residual, or at `enough` of what it
/// was, or after `most` iterations, or where A is not positive along the direction d.
/// @param system  keeps x, r, z and d:
///   double begin()            z = P r, d = z; returns r·z
///   double curvature()        q = A d; returns d·q
///   double descend(double a)  x += a d, r −= a q, z = P r; returns r·z
///   void turn(double b)       d = z + b d
template <class System>
ConjugateGradientsReport conjugate_gradients(System& system, int most, double negligible,
                                             double enough = 0) {
  ConjugateGradientsReport report;
  double descent = system.begin();
  negligible = std::max(negligible, enough * descent);
  while (report.iterations < most && descent > negligible) {
    ++report.iterations;
    const double curvature = system.curvature();
    if (!(curvature > 0)) break;
    const double last = descent;
    descent = system.descend(descent / curvature);
    if (report.iterations < most) system.turn(descent / last);
  }
  report.converged = descent <= negligible;
  return report;
}

}  // namespace palpate::deformation
