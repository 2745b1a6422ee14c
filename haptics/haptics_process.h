// The haptics process: devices in, forces out, never waiting for anyone.
#pragma once

#include "modules/runtime/module_options.h"

namespace palpate::haptics {

runtime::ModuleProgram haptics_program();

/// Every period, for every probe: read its device, render the force, publish both.
/// @throws InputError for a scene or recording that cannot be used
void run_haptics(const runtime::ModuleOptions& options);

}  // namespace palpate::haptics
