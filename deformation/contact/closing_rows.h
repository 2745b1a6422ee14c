// What rows that close within the next period give way by, of a law over several steps.
//
// A place that a probe moving by d in a period T meets after a way g is carried along at the
// probe's speed from then on: met in one of the first n − 1 steps, its mass m takes the mean force
// m d/T², which a change of d changes as if it had pressed all along; met in the last one m n (d −
// g)/T², for it has that step alone to give way in: n times as stiff. Which it will be the hand
// decides: with d anywhere within kWay of where probe and tissue are going, the row is
//     1 + (n − 1) p
// times as stiff, p the part of these ways in which the last step meets it. That is of what the row
// gives way by itself; with rows that press it goes along as it does.
#pragma once

#include <Eigen/Core>
#include <span>

#include "modules/core/touch.h"

namespace palpate::deformation {

/// How far a probe's way may be from that of the period before, as a part of it.
inline constexpr double kWay = 0.25;

/// What a row that does not press yet is to be stiffer by, ≥ 1.
/// @param went   of the probe in the last period [m]
/// @param steps  n ≥ 1, of a period
double stiffer_by_closing(const LawRow& row, const Vec3& went, double period, int steps);

/// Divides by `stiffer` what each row gives way by while those before it are held; W's diagonal
/// then has kRegular of itself more. A W that is not regular even so is left as it is: it is no
/// compliance.
/// @param stiffer  a number for each row; 1 for those that press
/// @param W        of the rows, several directions of each
void stiffen_closing_rows(std::span<const double> stiffer, Eigen::MatrixXd& W);

}  // namespace palpate::deformation
