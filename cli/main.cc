#include "cli/commands.h"

int main(int argc, char** argv) { return hydroscope::RunCommandLine(argc, argv); }
