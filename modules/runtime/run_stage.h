// The body of a module's main: a stage, its name, and how it shares the processor.
#pragma once

#include "modules/runtime/lockstep_module.h"
#include "modules/runtime/module.h"

namespace palpate::runtime {

/// Runs the stage that `make` builds on the session's bus, in real time or, with
/// options.lockstep, in lockstep, until the session stops, a signal comes or the stage has
/// finished. The module's rate is the scene's (rate_of()).
/// @throws what `make` throws; InputError, std::runtime_error as bus::DdsBus does
void run_stage(const ModuleOptions& options, const scene::Scene& scene, const std::string& module,
               Priority priority, const MakeStage& make);

}  // namespace palpate::runtime
