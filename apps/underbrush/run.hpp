/// \file
/// The program underbrush.
#pragma once

namespace underbrush::app {

/// Runs the program with the words of its command line; returns the exit code (`Program::run`).
int run_underbrush(int argc, char** argv);

}  // namespace underbrush::app
