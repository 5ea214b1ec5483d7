/// \file
/// The records of a log that are left out when it is read.
#pragma once
#include <cstddef>
#include <map>
#include <string>

namespace underbrush::pipeline {

/// The numbers of records that were left out, by reason.
using SkippedRows = std::map<std::string, size_t>;

}  // namespace underbrush::pipeline
