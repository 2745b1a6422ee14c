// What is certified: the first probe of a scene, and the place where it touches.
#pragma once

#include <functional>

#include "palpate/session/in_process.h"
#include "studies/report/progress.h"

namespace palpate::certify {

using report::KeepGoing;

/// Where the scene's own motion brings the probe to an organ first.
struct Place {
  std::size_t organ = 0;
  Pose pose;                   ///< of the probe as it touches, X_WP
  Vec3 tip = Vec3::Zero();     ///< the probe's point that touches [m]
  Vec3 into = -Vec3::UnitZ();  ///< unit, into the tissue
  double time = 0;             ///< when, in the scene's motion [s]
};

struct Subject {
  scene::Scene scene;  ///< of one probe
  session::Assets assets;
  Place place;
  scene::EmulatedDevice device;  ///< at the place, held by nobody: the scene's, else Touch-class
  double depth = 6e-3;           ///< of presses, below the place of touch [m]
  double speed = 0.04;           ///< of presses in the mean, of slides [m/s]
};

/// Loads the scene and finds the place, by playing it in one process until its first probe touches.
/// One that does not within its duration (or 30 s) goes straight to the nearest point of an organ.
/// @throws InputError as load_scene() and load_assets(), or if the probe cannot come to touch
Subject load_subject(const std::filesystem::path& scene, const KeepGoing& keep_going);

/// `below` the place of touch, along `into` [m].
Pose pose_below(const Place& place, double below);

}  // namespace palpate::certify
