// A firm hand presses the organ and lets go: the step of first contact, and the energy it got back.
#pragma once

#include "studies/certify/line.h"
#include "studies/certify/loop.h"

namespace palpate::certify {

/// What a hand does not feel as a step: 5 % of the force, or this [N].
inline constexpr double kFeltStep = 0.05, kFeltShare = 0.05;

/// Down to subject.depth at subject.speed in the mean, a rest of 0.3 s, and out again.
std::vector<Tick> press_and_release(const Loop& loop, const Subject& subject,
                                    const KeepGoing& keep_going);

/// Largest step within 20 ms of the first force.
Line first_contact_line(const std::string& group, const std::string& name,
                        const std::vector<Tick>& ticks);
/// Largest step of the whole press over what a hand feels as one.
Line largest_step_line(const std::string& group, const std::string& name,
                       const std::vector<Tick>& ticks);
/// Work of the motors from touch to touch, against K v D (T + 2 t_d), with K D the largest force
/// and v the largest speed while they pushed.
Line energy_line(const std::string& group, const std::string& name, const std::vector<Tick>& ticks,
                 const Subject& subject);

}  // namespace palpate::certify
