// Does a device that somebody holds come to rest? On walls of known stiffness, and on the organ.
#pragma once

#include <optional>

#include "studies/certify/line.h"
#include "studies/certify/loop.h"

namespace palpate::certify {

/// b/(T/2 + t_d), b the damping that the scene claims for the device [N/m].
double formula_stiffness(const Subject& subject);

/// The stiffest wall on which the device, pushed with a constant force and its encoders exact,
/// comes to rest, and on all softer ones that are tried from 0.05 times the formula on: to 2 %.
/// Nothing if it does on none; about 4 times the formula if it does on all.
std::optional<double> critical_stiffness(const Subject& subject, const KeepGoing& keep_going);
Line critical_line(const Subject& subject, const KeepGoing& keep_going);

/// On a wall ten times as stiff as the formula, which haptics is to soften: it swings no more than
/// an undamped device on a wall of the formula's stiffness.
Line stiff_wall_line(const Subject& subject, const KeepGoing& keep_going);

/// With a constant push from the place of touch on, five seconds.
/// @param push  what the organ holds at subject.depth [N]
std::vector<Tick> hold(const Loop& loop, const Subject& subject, double push,
                       const KeepGoing& keep_going);
/// Swing of the device after the first two of these; and in the last: what never ends.
std::vector<Line> held_lines(const std::string& group, const std::vector<Tick>& ticks);

}  // namespace palpate::certify
