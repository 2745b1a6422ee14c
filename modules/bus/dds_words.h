// What Fast DDS itself has to say: its errors, in plain lines.
#pragma once

namespace palpate::bus {

/// From now on they go to stderr as "DDS: SECURITY: surface topic not found in allow rule": each
/// once, without colours or places in its source, and no more than twenty in a process.
void tell_plainly();

}  // namespace palpate::bus
