// The collision process: finds where probes touch or may touch organs.
#pragma once

#include "modules/runtime/module_options.h"

namespace palpate::collision {

runtime::ModuleProgram collision_program();

/// Every period: take the newest organs and probe poses, search each probe's way since the last
/// search, publish its contacts, none included. A probe not heard of for kInputStaleAfter touches
/// nothing.
/// @throws InputError for a scene or probe mesh that cannot be used
void run_collision(const runtime::ModuleOptions& options);

}  // namespace palpate::collision
