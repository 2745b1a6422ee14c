// The loop people run: a hand holds an emulated device, haptics renders to it, collision and
// deformation answer; in lockstep, tick by tick.
#pragma once

#include "studies/certify/subject.h"

namespace palpate::certify {

/// What is touched.
struct Loop {
  scene::Scene scene;  ///< of one probe, whose device is replaced
  session::Assets assets;
  session::InProcessOptions options;
  Place place;
};
/// @param troubles  gets those of every session of the loop added; outlives it. None: not counted
Loop loop_on_organ(const Subject& subject, ContactTroubles* troubles = nullptr);
/// A lossless wall z ≤ 0 in the organ's place, its law told at the scene's rate of deformation.
Loop loop_on_wall(const scene::Scene& scene, double stiffness);

/// One tick of haptics, as the device's body has it.
struct Tick {
  double time = 0;
  double depth = 0;          ///< of the body below the place of touch, along `into` [m]
  Vec3 off = Vec3::Zero();   ///< of the body from the place of touch [m]
  double motor = 0;          ///< force of the motors in the tick that ends, against `into` [N]
  double work = 0;           ///< of the motors on the body so far [J]
  double force = 0;          ///< rendered, against `into` [N]
  double step = 0;           ///< of the rendered force, a vector, since the tick before [N]
  std::uint32_t limits = 0;  ///< what acted
};

/// Runs the loop until `end` [s] after the start, or until the body has left by 0.2 m.
std::vector<Tick> run_loop(const Loop& loop, const scene::EmulatedDevice& device, double end,
                           const KeepGoing& keep_going);

/// Largest less smallest depth in [from, to) [m]; infinity if the run ended before `to`.
double swing(const std::vector<Tick>& ticks, double from, double to);
/// Largest step of the force in [from, to).
const Tick& largest_step(const std::vector<Tick>& ticks, double from, double to);
/// First tick with a force; nullptr if there is none.
const Tick* first_force(const std::vector<Tick>& ticks);

}  // namespace palpate::certify
