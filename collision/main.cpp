#include "collision/collision_process.h"

int main(int argc, char** argv) {
  return palpate::runtime::run_module(argc, argv, palpate::collision::collision_program(),
                                      palpate::collision::run_collision);
}
