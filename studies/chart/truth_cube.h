// The Harvard Truth Cube: beads in a silicone cube of 80 mm, measured at rest and compressed.
//   A. Kerdok, S. Cotin, M. Ottensmeyer, A. Galea, R. Howe, S. Dawson, "Truth cube: establishing
//   physical standards for soft tissue simulation", Med. Image Anal. 7, 2003.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "modules/core/types.h"

namespace palpate::chart {

/// In the frame of the block case: the cube stands on z = 0, the plate comes down from z = 0.08.
struct TruthCube {
  std::vector<Vec3> rest;                      ///< [m]
  std::map<double, std::vector<Vec3>> states;  ///< by compression [m]
};

/// $PALPATE_DATA/truthcube, where the measurements are kept (docs/accuracy.md); empty if they are
/// not there. They may not be shipped.
std::optional<std::filesystem::path> truth_cube_folder();

/// The scanner's z points against the block's, and its origin is not the cube's: the centre of all
/// beads is the cube's.
/// @throws InputError naming file and line
TruthCube read_truth_cube(const std::filesystem::path& folder);

/// RMS distance between points after the rigid motion that brings `moved` nearest to `measured`
/// (W. Kabsch, Acta Cryst. A 32, 1976): the cube was put into the scanner anew for each state.
double distance_after_fit(const std::vector<Vec3>& moved, const std::vector<Vec3>& measured);

/// How well a bead was found: what a polynomial of the fifth degree in the rest position leaves of
/// the measured displacements, RMS of the distance [m].
double tracking_noise(const TruthCube& cube, double compression);

}  // namespace palpate::chart
