#include "run.hpp"

int main(int argc, char** argv) { return underbrush::app::run_underbrush(argc, argv); }
