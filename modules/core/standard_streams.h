// Standard input, output and error as a program is given them: perhaps closed, perhaps on a full
// disk.
#pragma once

#include <string>

namespace palpate {

/// Opens on /dev/null what of descriptors 0 to 2 is closed: else the next file that is opened, a
/// recording, gets such a number, and what is meant for people is written into it. First thing in a
/// program.
void open_standard_descriptors();

/// Of a program that holds a session: a reader of what it prints that goes away (`| head`) does not
/// end it; what it says from then on is lost. Other programs end by SIGPIPE, as ever.
void outlive_readers();

/// Writes what standard output still holds back.
/// @returns the reason if not all of it could be written; empty if it could, and where nobody reads
/// any more (`| head`), who wanted no more
std::string why_output_is_lost();

}  // namespace palpate
