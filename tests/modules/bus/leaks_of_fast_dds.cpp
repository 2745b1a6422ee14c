// What AddressSanitizer is told of Fast DDS 2.9.1: it keeps the certificate of each peer whose
// proof of identity it refuses, some kilobytes a time. Found by whole call stacks alone, for
// libraries that stand in between have no frame pointers.
extern "C" {

const char* __lsan_default_suppressions() {
  return "leak:security::PKIDH::begin_handshake_reply\n"
         "leak:security::PKIDH::process_handshake_request\n";
}

const char* __asan_default_options() { return "fast_unwind_on_malloc=0"; }
}
