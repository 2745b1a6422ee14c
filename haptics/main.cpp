#include "haptics/haptics_process.h"

int main(int argc, char** argv) {
  return palpate::runtime::run_module(argc, argv, palpate::haptics::haptics_program(),
                                      palpate::haptics::run_haptics);
}
