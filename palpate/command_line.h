// The command line of `palpate`.
#pragma once

namespace palpate::launcher {

/// Parses and carries out one command. Errors go to stderr in one line.
/// @return an exit code of core/error.h
int palpate_command(int argc, char** argv);

}  // namespace palpate::launcher
