// Work in chunks that may be done in any order or at once. The libraries know no threads: who has
// some hands them in as a ChunkRunner.
#pragma once

#include <cstddef>

namespace palpate {

/// A callable by reference: valid as long as what it refers to. No allocation.
class ChunkBody {
 public:
  template <class Body>
  ChunkBody(const Body& body)  // NOLINT(google-explicit-constructor): lambdas convert
      : context_(&body), call_([](const void* context, std::size_t chunk) {
          (*static_cast<const Body*>(context))(chunk);
        }) {}
  void operator()(std::size_t chunk) const { call_(context_, chunk); }

 private:
  const void* context_;
  void (*call_)(const void*, std::size_t);
};

class ChunkRunner {
 public:
  virtual ~ChunkRunner() = default;
  /// Calls body(0) … body(count − 1), each once, in any order or at once; returns after the last.
  virtual void run(std::size_t count, ChunkBody body) = 0;
};

/// One after the other on the calling thread.
class SerialRunner : public ChunkRunner {
 public:
  void run(std::size_t count, ChunkBody body) override {
    for (std::size_t chunk = 0; chunk < count; ++chunk) body(chunk);
  }
};

}  // namespace palpate
