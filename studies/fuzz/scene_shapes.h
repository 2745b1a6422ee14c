// What a random scene's organs and probes are made of, in the forms the processes take.
#pragma once

#include "collision/contact_finder.h"
#include "studies/fuzz/random_scene.h"
#include "studies/fuzz/shape_store.h"

namespace palpate::fuzz {

/// One per organ, in W [m].
std::vector<geometry::OrganShape> shapes_in_world(const RandomScene& scene,
                                                  const ShapeStore& store);

/// One per probe.
std::vector<collision::ProbeGeometry> probe_geometry(const RandomScene& scene,
                                                     const ShapeStore& store);

}  // namespace palpate::fuzz
