// Which deformation process owns which organs: key `process` of an organ.
#pragma once

#include <cstddef>
#include <vector>

#include "modules/scene/models.h"
#include "modules/scene/scene.h"

namespace palpate::scene {

inline constexpr std::size_t kMaxProcesses = 16;

/// Of deformation: as many as the organs name.
std::size_t process_count(const Scene& scene);

/// The organs of a process, by their index in the scene. @param process  from 1
std::vector<std::size_t> organs_of(const Scene& scene, std::size_t process);

/// What that process simulates: the scene without the organs of others.
Scene part_of(const Scene& scene, std::size_t process);

/// The same organs in one process: of what is measured without others.
Scene in_one_process(Scene scene);

/// What of the assignment cannot be: a process without organs, or organs that may touch apart.
Misfit misfit_of_processes(const Scene& scene);

}  // namespace palpate::scene
