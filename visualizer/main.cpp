#include "visualizer/visualizer_process.h"

int main(int argc, char** argv) {
  palpate::visualizer::VisualizerOptions options;
  return palpate::runtime::run_module(argc, argv, palpate::visualizer::visualizer_program(options),
                                      [&](const palpate::runtime::ModuleOptions& common) {
                                        palpate::visualizer::run_visualizer(common, options);
                                      });
}
