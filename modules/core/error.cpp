#include "modules/core/error.h"

#include <cstdio>
#include <cstdlib>

namespace palpate {

void demand_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: broken assumption: %s\n", file, line, condition);
  std::abort();
}

}  // namespace palpate
