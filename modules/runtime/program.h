// What is around the body of every program: --version, the command line, and what is thrown.
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace palpate::runtime {

/// What --version prints: "palpate 0.1.0, protocol 2". Programs with the same protocol can share a
/// session.
std::string version_text();

/// Adds --version, which prints version_text() and ends the program with kExitDone.
void add_version(CLI::App& app);

/// Parses the command line into what `app` was given, refuses NaN for a number, and runs `body`.
/// What is thrown on the way becomes one line on stderr, led by the app's name.
/// @return what `body` returns; kExitDone after --help or --version; kExitBadInput for an
/// InputError or a wrong command line, kExitFailed for any other exception
int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& body);

}  // namespace palpate::runtime
