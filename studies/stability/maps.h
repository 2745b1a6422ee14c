// The maps of the atlas.
//   step_stiffness   free ball set swinging               Young's modulus × step
//   squeeze          ball between plates                  squeeze × step
//   probe_speed      a sphere driven in and out           speed × step
//   mesh_quality     free ball with a sliver              edge over height × step
//   haptic_loop      device on a virtual wall             delay × stiffness
#pragma once

#include "studies/stability/atlas.h"

namespace palpate::stability {

/// @param quick  fewer series and values, frontiers to 5 % instead of 1 %
std::vector<Map> maps(bool quick);

}  // namespace palpate::stability
