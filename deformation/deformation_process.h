// The deformation process: owns the organs of a scene and advances them in real time.
#pragma once

#include "modules/runtime/module_options.h"

namespace palpate::deformation {

runtime::ModuleProgram deformation_program();

/// Every period: take the newest probes and contacts, advance all organs by one period, publish
/// their nodes and the contact model of every probe. If a period of simulated time costs more than
/// a period, less of it is simulated per cycle: simulated time falls behind (real-time factor) and
/// never catches up in a burst, while nodes and contact models stay as fresh as can be. A probe of
/// which, or of whose contacts, nothing was heard for kInputStaleAfter no longer touches.
/// @throws InputError for a scene or mesh that cannot be simulated
void run_deformation(const runtime::ModuleOptions& options);

}  // namespace palpate::deformation
