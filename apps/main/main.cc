#include "apps/commands.hpp"

int main(int argc, char** argv) { return groundloop::apps::run_command_line(argc, argv); }
