/// \file
/// The program underbrush-study.
#pragma once

namespace underbrush::studies {

/// Runs the program with its arguments and returns its exit code: 1 where a study falls short.
int run_program(int argc, char** argv);

}  // namespace underbrush::studies
