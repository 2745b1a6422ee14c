// Whether the streams that make a session's touch flow.
//
// DDS finds its peers in its own time: announcements come 50 ms apart in a process's first second,
// then every 250 ms. A session that began before would let a probe into tissue that does not feel
// it yet.
#pragma once

#include <string_view>

#include "modules/bus/bus.h"
#include "modules/scene/scene.h"

namespace palpate::runtime {

/// Of a module's streams from and to haptics, collision and deformation, as its own bus knows them:
/// all that write for it are known, what they say before a session runs (all but laws) was heard,
/// and as many read it as must. Onlookers count among these; who must hear something is itself not
/// ready before it did. True of other modules: nobody feels them.
bool are_streams_joined(const bus::Bus& bus, const scene::Scene& scene, std::string_view module);

}  // namespace palpate::runtime
