// For work that nobody ends.
#pragma once

#include "studies/report/progress.h"

namespace palpate::report {

inline const KeepGoing kKeepOn = [] {};

}  // namespace palpate::report
