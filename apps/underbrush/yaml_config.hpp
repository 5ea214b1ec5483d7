/// `--config FILE.yaml` for every verb, and `dump-config VERB`.
#pragma once
#include <CLI/CLI.hpp>

namespace underbrush::app {

/// Gives each verb `--config FILE.yaml` (flags override it) and adds the verb `dump-config`.
void add_config(CLI::App& root);

}  // namespace underbrush::app
