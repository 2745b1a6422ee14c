// A program that links this counts its allocations.
#pragma once

#include <cstddef>

namespace palpate::testing {

/// Calls of operator new so far, of every form, in the calling thread.
std::size_t allocations();

}  // namespace palpate::testing
