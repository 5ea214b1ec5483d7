/// \file
/// The verb `dump-config VERB`.
#pragma once
#include "cli/program.hpp"

namespace underbrush::app {

/// Adds the verb `dump-config`.
void add_dump_config(Program& program);

}  // namespace underbrush::app
