// A process of a lockstep session: follows the launcher's grants (SessionControl::until_ns) and
// says when it has used them up, so that nobody runs ahead of a stopped one without bound.
#pragma once

#include <functional>
#include <memory>

#include "modules/bus/bus.h"
#include "modules/runtime/module_options.h"
#include "modules/runtime/stage.h"
#include "modules/scene/scene.h"

namespace palpate::runtime {

using MakeStage = std::function<std::unique_ptr<Stage>(bus::Bus&)>;

/// Runs the stage until the session stops or a signal comes. Ready once it is matched with every
/// other participant (options.lockstep).
/// @throws what `make` and the bus throw; std::runtime_error if the session fails
void run_in_lockstep(const ModuleOptions& options, const scene::Scene& scene,
                     const std::string& module, const MakeStage& make);

}  // namespace palpate::runtime
