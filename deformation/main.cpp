#include "deformation/deformation_process.h"

int main(int argc, char** argv) {
  return palpate::runtime::run_module(argc, argv, palpate::deformation::deformation_program(),
                                      palpate::deformation::run_deformation);
}
