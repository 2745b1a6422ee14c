// Preloaded into a program built with -finstrument-functions, keeps which functions the newest
// cycle of its stage called, and writes them down at the end: a line "offset" for a call, "-" for a
// return. Set by scripts/trace/trace_cycles.py: PALPATE_TRACE_ROOTS ("program=offset …"),
// PALPATE_TRACE_FOLDER.
#include <dlfcn.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace {

constexpr std::uintptr_t kReturn = 0;

struct Tracer {
  std::uintptr_t base = 0;  ///< where the program lies in memory
  std::uintptr_t root = 0;
  std::string file;
  std::vector<std::uintptr_t> now, newest;

  Tracer() {
    const std::string program = program_invocation_short_name;
    const std::string roots = std::string(" ") + std::getenv("PALPATE_TRACE_ROOTS");
    const auto place = roots.find(" " + program + "=");
    if (place == std::string::npos) return;
    root = std::strtoull(roots.c_str() + place + program.size() + 2, nullptr, 16);
    file = std::string(std::getenv("PALPATE_TRACE_FOLDER")) + "/" + program;
  }
  ~Tracer() {
    if (newest.empty()) return;
    std::ofstream out(file);
    for (const std::uintptr_t call : newest) {
      if (call == kReturn)
        out << "-\n";
      else
        out << std::hex << call << "\n";
    }
  }
};

Tracer tracer;
thread_local std::size_t depth = 0;  // below the root; 0: not in a cycle

}  // namespace

extern "C" {

__attribute__((no_instrument_function)) void __cyg_profile_func_enter(void* function, void*) {
  if (tracer.root == 0) return;
  if (tracer.base == 0) {
    Dl_info info;
    if (dladdr(function, &info) == 0) return;
    tracer.base = reinterpret_cast<std::uintptr_t>(info.dli_fbase);
  }
  const auto offset = reinterpret_cast<std::uintptr_t>(function) - tracer.base;
  if (depth == 0 && offset != tracer.root) return;
  if (depth++ == 0) tracer.now.clear();
  tracer.now.push_back(offset);
}

__attribute__((no_instrument_function)) void __cyg_profile_func_exit(void*, void*) {
  if (depth == 0) return;
  tracer.now.push_back(kReturn);
  if (--depth == 0) std::swap(tracer.now, tracer.newest);
}

}  // extern "C"
