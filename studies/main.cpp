#include "studies/program.hpp"

int main(int argc, char** argv) { return underbrush::studies::run_program(argc, argv); }
