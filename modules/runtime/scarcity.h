// What is said, and the exit code, where the system gives no more memory or threads (ulimit -v,
// ulimit -u).
#pragma once

#include <string>
#include <system_error>

namespace palpate::runtime {

inline constexpr const char* kNoMemory = "not enough memory";

/// What the system says of a thread it does not give names no cause; of others its own words.
std::string why(const std::system_error& error);

/// From now on what is thrown where nobody can catch it, for want of memory or threads, ends the
/// process with kExitFailed and a line led by `program`: Fast DDS allocates in threads of its own,
/// and joins threads that it could not start. What else is thrown there is a fault of ours, and
/// aborts.
void end_in_words(const std::string& program);

}  // namespace palpate::runtime
