#include "palpate/command_line.h"

int main(int argc, char** argv) { return palpate::launcher::palpate_command(argc, argv); }
